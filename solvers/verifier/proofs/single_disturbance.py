r"""One disturbance of all that a task names, and the motion that it makes of a planned one.

Errors that are constant within each step make the closed loop another one of the same kind: where
the controller misreads the state by :math:`\nu_k` and each input is off by a part :math:`a_k` of
itself and by :math:`b_k`,

.. math:: u_k + a_k u_k + b_k = (1 + a_k) u^*_k + b_k - (1 + a_k) K_k (x - (x^*_k - \nu_k)).

So it has an exact law, and its motion is enclosed like any planned one.
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
"""Of a motion that goes on for ever, so many rounds are followed."""

WITHIN = 1 - Fraction(1, 10**9)
"""Radii in degrees are irrational in radians, and were rounded upwards for proofs."""

Signs = tuple[int, ...]


@dataclass(frozen=True, slots=True)
class ErrorSizes:
    """How large errors are at most, in SI units.

    Attributes:
        start: of coordinates, then of rates of the joints, (2n,).
        masses: of the factors of uncertain masses, (p,).
        noise: of what is measured, (2n,).
        part: of inputs, as a part of what is commanded, (m,).
        most: of inputs besides, (m,).
    """

    start: tuple[Fraction, ...]
    masses: tuple[Fraction, ...]
    noise: tuple[Fraction, ...]
    part: tuple[Fraction, ...]
    most: tuple[Fraction, ...]


def error_sizes(scene: Scene) -> ErrorSizes:
    """What the task of a scene names, or hardly less."""
    task, model = scene.task, scene.model
    parts, most = input_errors(task, model)
    return ErrorSizes(
        tuple(WITHIN * radius for radius in disturbance_radii(task, model)),
        tuple(item.part for item in uncertain_masses(task, model)),
        tuple(WITHIN * radius for radius in measurement_radii(task, model)),
        # Less than all of it: what is commanded follows from what is delivered.
        tuple(min(part, Fraction(99, 100)) for part in parts),
        most,
    )


@dataclass(frozen=True, slots=True)
class Disturbance:
    """At which end each error is, -1, 0 or 1.

    Attributes:
        start: per coordinate and rate, (2n,).
        masses: per factor, (p,).
        misread: per step, coordinate and rate, (k, 2n).
        scaled: per step and input, of the part of what is commanded, (k, m).
        pushed: per step and input, of what comes besides, (k, m).
    """

    start: Signs
    masses: Signs
    misread: tuple[Signs, ...]
    scaled: tuple[Signs, ...]
    pushed: tuple[Signs, ...]


def undisturbed(sizes: ErrorSizes, steps: int) -> Disturbance:
    """No error at all, for so many steps."""
    still = (0,) * len(sizes.most)
    return Disturbance(
        (0,) * len(sizes.start), (0,) * len(sizes.masses), ((0,) * len(sizes.noise),) * steps,
        (still,) * steps, (still,) * steps,
    )  # fmt: skip


def law_of(motion: Motion) -> ControlLaw:
    """The law of a motion; that of an open loop reads nothing."""
    return motion.law or open_loop(motion.inputs, len(motion.state))


def unrolled(motion: Motion) -> Motion:
    """The planned motion with a law, as long as it is followed: some rounds of a loop."""
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
    """The motion that an unrolled one becomes, and the factors of its masses (p,).

    Its law is what delivers the inputs; what is commanded is (u - ``added``) / ``factor``, both
    (k, m).
    """

    signs: Disturbance
    motion: Motion
    masses: tuple[Fraction, ...]
    factor: tuple[tuple[Fraction, ...], ...]
    added: tuple[tuple[Fraction, ...], ...]


def disturbed(motion: Motion, sizes: ErrorSizes, signs: Disturbance) -> DisturbedMotion:
    """An unrolled motion with errors, exactly."""
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
