r"""One of the disturbances that a task names, and the motion that results from a planned one.

With errors that are constant within each step, the closed loop is another closed loop of the same
kind: if the controller misreads the state by :math:`\nu_k` and each input is off by a part
:math:`a_k` of itself and by :math:`b_k`,

.. math:: u_k + a_k u_k + b_k = (1 + a_k) u^*_k + b_k - (1 + a_k) K_k (x - (x^*_k - \nu_k)).

So it has an exact law, and its motion is enclosed like a planned one.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from compiler.tasks.specification import (
    disturbance_radii,
    input_errors,
    measurement_radii,
    uncertain_masses,
)
from solvers.verifier.proofs.control_law import ControlLaw, open_loop
from solvers.verifier.proofs.scene import Motion, Scene

MOST_ROUNDS = 3
"""The number of rounds that are followed of a motion that goes on for ever."""

WITHIN = 1 - Fraction(1, 10**9)
"""Radii in degrees are irrational in radians, and proofs use them rounded upwards."""

Signs = tuple[int, ...]


@dataclass(frozen=True, slots=True)
class ErrorSizes:
    """The largest sizes of errors, in SI units.

    Attributes:
        start: for coordinates, then for rates of the joints, (2n,).
        masses: for the factors of uncertain masses, (p,).
        noise: for measured values, (2n,).
        part: for inputs, as a fraction of the commanded ones, (m,).
        most: for inputs, in addition, (m,).
    """

    start: tuple[Fraction, ...]
    masses: tuple[Fraction, ...]
    noise: tuple[Fraction, ...]
    part: tuple[Fraction, ...]
    most: tuple[Fraction, ...]


def error_sizes(scene: Scene) -> ErrorSizes:
    """The sizes that the task of a scene names, or slightly less."""
    task, model = scene.task, scene.model
    parts, most = input_errors(task, model)
    return ErrorSizes(
        tuple(WITHIN * radius for radius in disturbance_radii(task, model)),
        tuple(item.part for item in uncertain_masses(task, model)),
        tuple(WITHIN * radius for radius in measurement_radii(task, model)),
        # Less than 1, since the commanded input is computed back from the delivered one.
        tuple(min(part, Fraction(99, 100)) for part in parts),
        most,
    )


@dataclass(frozen=True, slots=True)
class Disturbance:
    """The end of its range at which each error is: -1, 0 or 1.

    Attributes:
        start: per coordinate and rate, (2n,).
        masses: per factor, (p,).
        misread: per step, coordinate and rate, (k, 2n).
        scaled: per step and input, for the fraction of the commanded input, (k, m).
        pushed: per step and input, for the additional error, (k, m).
    """

    start: Signs
    masses: Signs
    misread: tuple[Signs, ...]
    scaled: tuple[Signs, ...]
    pushed: tuple[Signs, ...]


def undisturbed(sizes: ErrorSizes, steps: int) -> Disturbance:
    """No error at all, for the given number of steps."""
    still = (0,) * len(sizes.most)
    return Disturbance(
        (0,) * len(sizes.start), (0,) * len(sizes.masses), ((0,) * len(sizes.noise),) * steps,
        (still,) * steps, (still,) * steps,
    )  # fmt: skip


def law_of(motion: Motion) -> ControlLaw:
    """The law of a motion; the law of an open loop ignores measurements."""
    return motion.law or open_loop(motion.inputs, len(motion.state))


def unrolled(motion: Motion) -> Motion:
    """The planned motion with a law, for as long as it is followed: several rounds of a loop."""
    law, loop = law_of(motion), motion.loop
    steps = list(range(len(motion.inputs)))
    turns = list[tuple[int, ...]]()
    if loop is not None:
        again = steps[loop.first :]
        steps += (MOST_ROUNDS - 1) * again
        if loop.turns:
            turns = [(0,) * len(loop.turns)] * loop.first
            turns += [
                tuple(rounds * turn for turn in loop.turns)
                for rounds in range(MOST_ROUNDS)
                for _ in again
            ]
    unrolled_law = ControlLaw(
        tuple(law.reference[k] for k in steps),
        tuple(law.gains[k] for k in steps),
        turns=tuple(turns),
    )
    inputs = tuple(motion.inputs[k] for k in steps)
    return replace(motion, inputs=inputs, law=unrolled_law, loop=None)


@dataclass(frozen=True, slots=True)
class DisturbedMotion:
    """The motion that results from an unrolled one, and the factors of its masses (p,).

    Its law gives the delivered inputs; the commanded ones are (u - ``added``) / ``factor``, both
    (k, m).
    """

    signs: Disturbance
    motion: Motion
    masses: tuple[Fraction, ...]
    factor: tuple[tuple[Fraction, ...], ...]
    added: tuple[tuple[Fraction, ...], ...]


def disturbed(motion: Motion, sizes: ErrorSizes, signs: Disturbance) -> DisturbedMotion:
    """An unrolled motion with exact errors."""
    law = law_of(motion)
    factor = tuple(tuple(1 + e for e in _times(row, sizes.part)) for row in signs.scaled)
    added = tuple(_times(row, sizes.most) for row in signs.pushed)
    inputs = tuple(
        tuple(f * u + b for f, u, b in zip(*rows, strict=True))
        for rows in zip(factor, motion.inputs, added, strict=True)
    )
    gains = tuple(
        tuple(tuple(f * k for k in row) for f, row in zip(factors, gain, strict=True))
        for factors, gain in zip(factor, law.gains, strict=True)
    )
    reference = tuple(
        tuple(x - e for x, e in zip(row, _times(misread, sizes.noise), strict=True))
        for row, misread in zip(law.reference, signs.misread, strict=True)
    )
    state = zip(motion.state, _times(signs.start, sizes.start), strict=True)
    moved = replace(
        motion,
        state=tuple(x + e for x, e in state),
        inputs=inputs,
        law=replace(law, reference=reference, gains=gains),
    )
    masses = tuple(1 + e for e in _times(signs.masses, sizes.masses))
    return DisturbedMotion(signs, moved, masses, factor, added)


def _times(signs: Signs, sizes: Sequence[Fraction]) -> tuple[Fraction, ...]:
    return tuple(sign * size for sign, size in zip(signs, sizes, strict=True))
