r"""Validated integration: an enclosure of the continuous-time solutions at every instant.

Per segment: a polynomial path p from the midpoint of the set of states, with a bound of its defect
(``vector_field.py``); a box that no deviation from it leaves (``a_priori.py``); a matrix polynomial
P near the fundamental matrix of the deviations (``deviation_flow.py``).  Then every state is

.. math::
    x(t) \in p(t) + \bigl(P(t) \pm Z(t)\bigr)\,(x(0) - p(0)) \pm y(t), \qquad 0 \le t \le h,

with y the bound of what the defect and the disturbance of the inputs add, and the set at the end
is a zonotope (there, too).

Sources: Lohner (1987); Nedialkov, Jackson & Corliss, *Validated solutions of initial value problems
for ordinary differential equations* (1999); Kapela & Zgliczynski (2009) for disturbed inputs.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb, arb_poly

from compiler.expressions.evaluators.balls import (
    SIGNS,
    UncertainSignError,
    ball,
    working_precision,
)
from solvers.verifier.proofs.a_priori import Deviation, Drive, NearPath, deviation
from solvers.verifier.proofs.control_law import HoldingLaw, InputError
from solvers.verifier.proofs.linearisation import Coefficients
from solvers.verifier.proofs.moved_set import MovedSet, Spread, moved_set, pulled
from solvers.verifier.proofs.path import Path, defect, path_on, taylor_polynomials
from solvers.verifier.proofs.step_control import (
    LEAST_PARTS,
    LEAST_ROUGH_PARTS,
    OrderChoice,
    StepControl,
    good_length,
)
from solvers.verifier.proofs.vector_field import VectorField
from solvers.verifier.proofs.zonotope import InitialSet, Zonotope, box, zonotope

KINK_REMAINDER = 3e-7
"""Where an absolute value has a kink, shorter segments of order two may be less accurate."""
REMAINDER_OF_RADIUS = 2.0**-16
"""What a segment may add to a wide set, as a part of its radius."""
LINEAR_BITS = 53
KINK_LENGTH = Fraction(1, 64)
"""The part of a step below which no smooth segment is tried on the way to a kink."""

ROUGH_ORDER = 2
INFLATION = 1.25
"""A path is made for so much more time than it is needed for."""
UNKNOWN = float("inf")


class EnclosureFailure(ArithmeticError):
    """No enclosure could be validated beyond a time, in seconds."""

    def __init__(self, time: float) -> None:
        super().__init__(f"no enclosure of the motion beyond {time:.4g} s")
        self.time = time


@dataclass(frozen=True, slots=True)
class TubeSegment:
    """The solutions on [start, start + length] as polynomials with ball coefficients.

    ``states[i]`` holds the coefficients of entry i of the state (coordinates, rates, modules' own
    states) in the time since ``start``, ``accelerations[i]`` those of coordinate i's second
    derivative.  ``steps`` holds the exact ends of the segment in units of
    the step.  ``last`` is the set of states at the end, of which ``end`` is the hull; None without
    states but at the end of a tube.  ``spread`` is the set all along, of a wide tube.
    """

    start: arb
    length: arb
    steps: tuple[Fraction, Fraction]
    states: tuple[Coefficients, ...]
    end: tuple[arb, ...]
    inputs: tuple[arb, ...] = ()
    commanded: tuple[arb, ...] = ()
    last: Zonotope | None = None
    spread: Spread | None = None
    accelerations: tuple[Coefficients, ...] = ()

    @property
    def number(self) -> int:
        """The number of the input in force, from 0."""
        return int(self.steps[0])

    def at(self, tau: arb) -> list[arb]:
        """The states ``tau`` after the start; a ball of times gives an enclosure over it."""
        return [polynomial(coefficients, tau) for coefficients in self.states]


def polynomial(coefficients: Sequence[arb], tau: arb) -> arb:
    """Horner's rule."""
    value = arb(0)
    for coefficient in reversed(coefficients):
        value = value * tau + coefficient
    return value


@dataclass(frozen=True, slots=True)
class Accuracy:
    """Taylor order, working bits, and the remainder a segment may add to a coordinate or rate."""

    order: int
    bits: int
    remainder: float


@dataclass(frozen=True, slots=True)
class _Trial:
    """What is tried on a segment: a path's polynomials of an order, and the tolerance.

    ``degree`` is that of the matrix polynomial P.
    """

    polynomials: tuple[arb_poly, ...]
    order: int
    degree: int
    rough: bool
    tolerance: float


@dataclass(frozen=True, slots=True)
class _Passage:
    """A validated segment: its path, how solutions deviate, how the set moves, and its end."""

    path: Path
    deviation: Deviation
    moved: MovedSet
    end: Zonotope


def _attempt(
    field: VectorField, states: Zonotope, drive: Drive, trial: _Trial, length: arb
) -> tuple[float, _Passage | None]:
    """The error of a segment over its tolerance, and the segment if it is valid.

    Raises:
        UncertainSignError: an absolute value has its kink there.
    """
    path = path_on(trial.polynomials, length.upper())
    try:
        error = defect(field, path, drive.stated, 1 if trial.rough else trial.order)
        # How deviations develop need not be known to more digits than floats have.
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
        # A denominator's ball contains zero: the box is too wide, not the robot at fault.
        return UNKNOWN, None
    if not all(item.is_finite() for item in (*moved.radii, *end.radii)):
        return UNKNOWN, None
    return excess, _Passage(path, found, moved, end)


def tube(
    field: VectorField,
    initial: InitialSet | Sequence[arb],
    inputs: Sequence[Sequence[arb]],
    dt: arb,
    accuracy: Accuracy,
    error: InputError | None = None,
    law: HoldingLaw | None = None,
    steps: range | None = None,
    *,
    accelerations: bool = False,
) -> Iterator[TubeSegment]:
    """The validated solutions under inputs held for ``dt`` each, segment by segment.

    A robot that cannot move has a segment per step.

    Args:
        field: the equations of motion.
        initial: the states at time 0; a sequence of balls stands for their box.
        inputs: the stated inputs, a row of balls per step.
        dt: the length of a step in seconds.
        accuracy: order, bits, and what a segment may add.
        error: how far inputs may be from those commanded, however that varies in time (measurably);
            default not at all.
        law: what sets the inputs that the states hold at each sample, those of the field being
            what is added to them; default the field's inputs are those stated.
        steps: the numbers of the steps in turn; default all.
        accelerations: whether segments enclose these, too.

    Raises:
        EnclosureFailure: a segment has no validated enclosure however short.
        ValueError: inputs are disturbed, but the field has no slopes in its inputs.
    """
    if error is not None and field.input_slopes is None:
        raise ValueError("disturbed inputs need the slopes of the field in its inputs")
    numbers = range(len(inputs)) if steps is None else steps
    if not field.size:
        for k in numbers:
            ends, held = (Fraction(k), Fraction(k + 1)), tuple(inputs[k])
            point = Zonotope.point([]) if k == numbers[-1] else None
            yield TubeSegment(dt * k, dt, ends, (), (), held, held, point)
        return
    states = zonotope(initial if isinstance(initial, InitialSet) else box(initial))
    control = StepControl(float(dt))
    control.learn_degree(states.radii, [arb(0)] * field.size, accuracy.order)
    start = dt * numbers.start
    for number in numbers:
        u = inputs[number]
        if law is None:
            commanded, stated = list(u), list(u)
        else:
            states = law.held(number, states)
            commanded = states.hull()[law.place : law.place + len(u)]
            stated = [arb(0)] * len(u)
        added = [arb(0)] * len(u) if error is None else error.about(commanded)
        drive = Drive(stated, added)
        first, last = Fraction(number), Fraction(number + 1)
        while first < last:
            found = _next(field, states, drive, dt, last - first, accuracy, control)
            if found is None:
                raise EnclosureFailure(float(start.mid()))
            length, passage = found
            seconds = dt * ball(length)
            ends = first, first + length
            yield TubeSegment(
                start, seconds, ends, _states(passage), tuple(passage.end.hull()),
                tuple(drive.all), tuple(commanded), passage.end, passage.moved.spread,
                _accelerations(passage, field.dofs) if accelerations else (),
            )  # fmt: skip
            states, first, start = passage.end, ends[1], dt * ball(ends[1])


def _states(passage: _Passage) -> tuple[Coefficients, ...]:
    """The polynomials of a segment: the path's, with the deviations in the constant terms."""
    found = []
    for item, radius in zip(passage.path.polynomials, passage.moved.radii, strict=True):
        coefficients = item.coeffs() or [arb(0)]
        found.append([coefficients[0] + SIGNS * radius, *coefficients[1:]])
    return tuple(found)


def _accelerations(passage: _Passage, dofs: int) -> tuple[Coefficients, ...]:
    """Those of a segment: the path's derivatives, with what deviations add to them at most."""
    found, own = [], slice(dofs, 2 * dofs)
    pulls = pulled(passage.deviation, passage.moved, passage.path.length)[:dofs]
    for item, pull in zip(passage.path.polynomials[own], pulls, strict=True):
        coefficients = item.derivative().coeffs() or [arb(0)]
        found.append([coefficients[0] + SIGNS * pull, *coefficients[1:]])
    return tuple(found)


def _next(
    field: VectorField,
    states: Zonotope,
    drive: Drive,
    dt: arb,
    rest: Fraction,
    accuracy: Accuracy,
    control: StepControl,
) -> tuple[Fraction, _Passage] | None:
    """The next segment, ``rest`` of the step being left: its length in steps; None for failure."""
    for rough in (False, True):
        try:
            wanted = INFLATION * float(rest) * control.dt / control.caution
            trial = _trial(field, states, drive, accuracy, wanted, control, rough=rough)
            return (
                None if trial is None else _longest(field, states, drive, dt, rest, trial, control)
            )
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
    # Not the degree: of an order that is exact the last coefficients may be zero.
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
) -> tuple[Fraction, _Passage] | None:
    """The first length that is valid, from a good guess downwards."""
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
