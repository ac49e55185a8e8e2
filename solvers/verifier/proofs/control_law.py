r"""The law that holds inputs from sample to sample, and its effect on a set of states.

At sample k the controller reads :math:`\hat x = x(t_k) + \nu`, coordinates and rates of the joints
with a bounded error, and holds

.. math:: u_k = u^*_k - K_k (\hat x - x^*_k)

until the next sample, up to the rounding of a computer. Between samples the inputs are constant, so
the set of (x, u) at a sample is an affine image of the set of x and the errors: a zonotope is
mapped to a zonotope.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Protocol

from flint import arb, arb_mat

from compiler.expressions.evaluators.balls import ball, identity
from solvers.verifier.proofs.zonotope import Zonotope


@dataclass(frozen=True, slots=True)
class ControlLaw:
    """What a controller does at each sample, exactly.

    Attributes:
        reference: the planned coordinates and rates of the joints, (k, 2n), in SI units.
        gains: how much the inputs decrease per deviation from the reference, (k, m, 2n), in SI
            units.
        rounding: the tolerance of the held inputs around the law, (m,), in SI units; empty: none.
        turns: the full turns to add to the coordinates of ``reference``, (k, n); empty: none.
    """

    reference: tuple[tuple[Fraction, ...], ...]
    gains: tuple[tuple[tuple[Fraction, ...], ...], ...]
    rounding: tuple[Fraction, ...] = ()
    turns: tuple[tuple[int, ...], ...] = ()

    def turned(self, step: int) -> tuple[int, ...]:
        """The full turns of a step, (n,), or an empty tuple."""
        return self.turns[step] if self.turns else ()


def open_loop(inputs: Sequence[Sequence[Fraction]], size: int) -> ControlLaw:
    """The law that holds the stated inputs (k, m), whatever the ``size`` measured entries are."""
    none = (Fraction(0),) * size
    return ControlLaw(tuple(none for _ in inputs), tuple((none,) * len(row) for row in inputs))


@dataclass(frozen=True, slots=True)
class InputError:
    """How far inputs may be from the commanded ones at every instant: |d| <= part |u| + most.

    Both have one value per input (m,), ``most`` in its unit.
    """

    part: tuple[arb, ...]
    most: tuple[arb, ...]

    def about(self, commanded: Sequence[arb]) -> list[arb]:
        """Bounds of |d| for commanded inputs (m,) given as balls."""
        return [
            (abs(u).upper() * part + most).upper()
            for u, part, most in zip(commanded, self.part, self.most, strict=True)
        ]


class HoldingLaw(Protocol):
    """Sets the inputs that are held between samples, in balls, as entries of the state."""

    @property
    def place(self) -> int:
        """The index of the first held input, after the robot's own states."""
        ...

    def held(self, step: int, states: Zonotope) -> Zonotope:
        """The states at a sample with the inputs that the law then holds."""
        ...


@dataclass(frozen=True, slots=True)
class SampledLaw:
    """A law in balls, for states in the coordinates of a graph, followed by the held inputs.

    Attributes:
        inputs: the planned inputs u*, (k, m).
        gains: K in the coordinates of the graph, (m, 2n) each.
        offsets: K x*, (m,) each.
        noise: the columns of a set, per step: K times each measurement error at its bound, and the
            rounding of each input.
        place: the number of states before the held inputs.
    """

    inputs: tuple[tuple[arb, ...], ...]
    gains: tuple[arb_mat, ...]
    offsets: tuple[tuple[arb, ...], ...]
    noise: tuple[tuple[tuple[arb, ...], ...], ...]
    place: int

    def held(self, step: int, states: Zonotope) -> Zonotope:
        """The states at a sample with the inputs that the law then holds."""
        gain, size = self.gains[step], len(states.middle)
        m, width = gain.nrows(), gain.ncols()
        taken = (gain * arb_mat([[x] for x in states.middle[:width]])).entries()
        to, matrix, own = list(states.middle), identity(size), -gain
        pairs = zip(self.inputs[step], self.offsets[step], taken, strict=True)
        for i, (u, offset, item) in enumerate(pairs):
            to[self.place + i] = u + offset - item
            for j in range(size):
                matrix[self.place + i, j] = own[i, j] if j < width else arb(0)
        noise = [
            [0] * self.place + list(e) + [0] * (size - self.place - m) for e in self.noise[step]
        ]
        steady = arb_mat(noise).transpose() if noise else None
        return states.moved(to, matrix, [arb(0)] * size, steady)


def sampled_law(
    law: ControlLaw,
    inputs: Sequence[Sequence[Fraction]],
    rows: Sequence[Sequence[int]],
    noise: Sequence[Fraction],
    rounding: Sequence[Fraction],
    own: int,
) -> SampledLaw:
    """A law in the working precision.

    Args:
        law: reference and gains, for the joints' own coordinates.
        inputs: the planned inputs, (k, m).
        rows: D of q = D y, from the graph's coordinates y to those of the joints.
        noise: bounds of the measurement errors, (2n,); empty: no errors.
        rounding: the tolerance of the held inputs around the law, (m,); empty: none.
        own: the number of the modules' own states.
    """
    n = len(rows)
    gains, offsets, errors = [], [], []
    rounded = tuple(
        tuple(ball(bound) if i == number else arb(0) for i in range(len(rounding)))
        for number, bound in enumerate(rounding)
        if bound
    )
    for step, (reference, gain) in enumerate(zip(law.reference, law.gains, strict=True)):
        turned = [
            [
                ball(sum((row[part + i] * rows[i][j] for i in range(n)), Fraction(0)))
                for part in (0, n)
                for j in range(n)
            ]
            for row in gain
        ]
        gains.append(arb_mat(len(gain), 2 * n, [item for row in turned for item in row]))
        offsets.append(tuple(_product(row, reference, law.turned(step)) for row in gain))
        errors.append(
            tuple(
                tuple(ball(row[i] * bound) for row in gain)
                for i, bound in enumerate(noise)
                if bound
            )
            + rounded
        )
    planned = tuple(tuple(ball(value) for value in row) for row in inputs)
    return SampledLaw(planned, tuple(gains), tuple(offsets), tuple(errors), 2 * n + own)


def _product(row: Sequence[Fraction], reference: Sequence[Fraction], turns: Sequence[int]) -> arb:
    """A row of K times x*, with the full turns added to the first entries of x*."""
    planned = sum((k * x for k, x in zip(row, reference, strict=True)), Fraction(0))
    farther = sum((k * turn for k, turn in zip(row, turns, strict=False)), Fraction(0))
    return ball(planned) + 2 * arb.pi() * ball(farther) if farther else ball(planned)
