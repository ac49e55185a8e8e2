r"""A validated segment of a tube: as long as its path, its deviations and its set allow.

The path is a polynomial from the midpoint of the set of states. If validation fails, a shorter
segment is tried, or one of order two if an absolute value has its kink there (``step_control.py``).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from math import inf

from flint import arb, arb_poly

from compiler.expressions.evaluators.balls import UncertainSignError, ball, working_precision
from solvers.verifier.proofs.a_priori import Deviation, Drive, NearPath, deviation
from solvers.verifier.proofs.moved_set import MovedSet, moved_set
from solvers.verifier.proofs.path import Path, defect, path_on, taylor_polynomials
from solvers.verifier.proofs.step_control import (
    LEAST_PARTS,
    LEAST_ROUGH_PARTS,
    OrderChoice,
    StepControl,
    good_length,
)
from solvers.verifier.proofs.vector_field import VectorField
from solvers.verifier.proofs.zonotope import Zonotope

KINK_REMAINDER = 3e-7
"""At a kink of an absolute value, segments are short and of order two, and may be less accurate."""
REMAINDER_OF_RADIUS = 2.0**-16
"""The most that a segment may add to a wide set, relative to its radius."""
LINEAR_BITS = 53
KINK_LENGTH = Fraction(1, 64)
"""The fraction of a step below which no smooth segment is tried near a kink."""

ROUGH_ORDER = 2
INFLATION = 1.25
"""A path is computed for a time longer than needed by this factor."""
UNKNOWN = inf


@dataclass(frozen=True, slots=True)
class Accuracy:
    """Taylor order, working bits, and the most that a segment may add to a coordinate or rate."""

    order: int
    bits: int
    remainder: float


@dataclass(frozen=True, slots=True)
class _Trial:
    """A candidate for a segment: the polynomials of a path, their order, and the tolerance.

    ``degree`` is the degree of the matrix polynomial P.
    """

    polynomials: tuple[arb_poly, ...]
    order: int
    degree: int
    rough: bool
    tolerance: float


@dataclass(frozen=True, slots=True)
class Passage:
    """A validated segment: its path, how solutions deviate, how the set moves, and its end."""

    path: Path
    deviation: Deviation
    moved: MovedSet
    end: Zonotope


def longest_passage(
    field: VectorField,
    states: Zonotope,
    drive: Drive,
    dt: arb,
    rest: Fraction,
    accuracy: Accuracy,
    control: StepControl,
) -> tuple[Fraction, Passage] | None:
    """The longest valid segment, at most ``rest`` of a step of ``dt`` s; None if there is none.

    Its length is in steps.
    """
    for rough in (False, True):
        try:
            wanted = INFLATION * float(rest) * control.dt / control.caution
            # An order that seems sufficient for such a short time may not be.
            for seconds in (wanted,) if rough else (wanted, inf):
                trial = _trial(field, states, drive, accuracy, seconds, control, rough=rough)
                if trial is None:
                    return None
                found = _longest(field, states, drive, dt, rest, trial, control)
                if found is not None:
                    return found
            return None
        except UncertainSignError:
            continue
    return None


def _trial(
    field: VectorField,
    states: Zonotope,
    drive: Drive,
    accuracy: Accuracy,
    wanted: float,
    control: StepControl,
    *,
    rough: bool,
) -> _Trial | None:
    """The path from the middle of a set, of an order that suits ``wanted`` seconds."""
    widest = max(map(float, states.radii), default=0.0)
    tolerance = max(accuracy.remainder, KINK_REMAINDER) if rough else accuracy.remainder
    tolerance = max(tolerance, REMAINDER_OF_RADIUS * widest)
    choice = None if rough else OrderChoice(field.dofs, tolerance, wanted)
    try:
        if choice is None:
            polynomials = taylor_polynomials(field, states.middle, drive.stated, ROUGH_ORDER)
        else:
            polynomials = taylor_polynomials(
                field, states.middle, drive.stated, accuracy.order, choice
            )
    except UncertainSignError:
        raise
    except (ZeroDivisionError, ValueError):
        return None
    # The degree may be lower than the order, since the last coefficients may be zero.
    order = ROUGH_ORDER if choice is None else choice.order
    return _Trial(polynomials, order, 0 if rough else control.degree, rough, tolerance)


def _longest(
    field: VectorField,
    states: Zonotope,
    drive: Drive,
    dt: arb,
    rest: Fraction,
    trial: _Trial,
    control: StepControl,
) -> tuple[Fraction, Passage] | None:
    """The first valid length, starting from a good guess and decreasing."""
    order = 1 if trial.rough else trial.order
    rates = [item.coeffs() for item in trial.polynomials[field.dofs :]]
    guess = good_length(rates, trial.tolerance)
    length: Fraction | None = control.first(rest, guess)
    while length is not None:
        try:
            excess, passage = _attempt(field, states, drive, trial, dt * ball(length))
        except UncertainSignError:
            if trial.rough or length < KINK_LENGTH:
                raise
            length = length / 4
            continue
        share = control.learn(length, guess, excess, order)
        if passage is not None:
            if not control.close_enough(length, passage.moved.growth, passage.moved.second):
                length = control.first(length, guess)
                continue
            if not trial.rough:
                control.learn_degree(states.radii, passage.moved.added.box, trial.order)
            return length, passage
        least = LEAST_ROUGH_PARTS if field.has_kinks else LEAST_PARTS
        length = control.shorter(length, share, least)
    return None


def _attempt(
    field: VectorField, states: Zonotope, drive: Drive, trial: _Trial, length: arb
) -> tuple[float, Passage | None]:
    """The error of a segment over its tolerance, and the segment if it is valid.

    Raises:
        UncertainSignError: an absolute value has its kink there.
    """
    path = path_on(trial.polynomials, length.upper())
    try:
        error = defect(field, path, drive.stated, 1 if trial.rough else trial.order)
        # The evolution of deviations need not be more precise than floats.
        with working_precision(LINEAR_BITS):
            near = NearPath(path, error.bounds, states.radii, drive)
            found = deviation(field, near, trial.degree)
            if found is None:
                return UNKNOWN, None
            added = max(map(float, found.residue)) * float(length) * error.avoidable
            excess = added / trial.tolerance
            if not excess <= 1:
                return excess, None
            moved = moved_set(field, states, near, found, trial.degree)
            turn = moved.flow.at(length)
        to = [x + s for x, s in zip(path.at(length), moved.added.shift, strict=True)]
        end = states.moved(to, turn, moved.added.box, moved.added.steady)
    except UncertainSignError:
        raise
    except (ZeroDivisionError, ValueError):
        # A denominator's ball contains zero: the box is too wide, which says nothing about the
        # robot.
        return UNKNOWN, None
    if not all(item.is_finite() for item in (*moved.radii, *end.radii)):
        return UNKNOWN, None
    return excess, Passage(path, found, moved, end)
