r"""Validated integration: an enclosure of the continuous-time solutions at every instant.

Each segment has a polynomial path p from the midpoint of the set of states, with a bound of its
defect (``vector_field.py``); a box that no deviation from it leaves (``a_priori.py``); a matrix
polynomial P near the fundamental matrix of the deviations (``deviation_flow.py``). Then every state
is

.. math::
    x(t) \in p(t) + \bigl(P(t) \pm Z(t)\bigr)\,(x(0) - p(0)) \pm y(t), \qquad 0 \le t \le h,

with y the bound of what the defect and the disturbance of the inputs add. The set at the end is a
zonotope (``zonotope.py``).

Sources: Lohner (1987); Nedialkov, Jackson & Corliss, *Validated solutions of initial value problems
for ordinary differential equations* (1999); Kapela & Zgliczynski (2009) for disturbed inputs.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction

from flint import arb

from compiler.expressions.evaluators.balls import SIGNS, ball
from solvers.verifier.proofs.a_priori import Drive
from solvers.verifier.proofs.control_law import HoldingLaw, InputError
from solvers.verifier.proofs.dry_friction import RubbingRobot
from solvers.verifier.proofs.friction_modes import Signs
from solvers.verifier.proofs.linearisation import Coefficients
from solvers.verifier.proofs.moved_set import Spread, pulled
from solvers.verifier.proofs.passage import Accuracy, Passage
from solvers.verifier.proofs.step_control import StepControl
from solvers.verifier.proofs.sticking_field import StickingFields
from solvers.verifier.proofs.vector_field import VectorField
from solvers.verifier.proofs.zonotope import InitialSet, Zonotope, box, zonotope

__all__ = ["Accuracy", "EnclosureFailure", "TubeSegment", "polynomial", "tube"]


MOST_RUBBING = 256
"""The most segments of a step: dry friction sets no shortest segment, and each change of a joint's
mode takes about a dozen."""


class EnclosureFailure(ArithmeticError):
    """No enclosure could be validated beyond a time, in seconds."""

    def __init__(self, time: float) -> None:
        super().__init__(f"no enclosure of the motion beyond {time:.4g} s")
        self.time = time


@dataclass(frozen=True, slots=True)
class TubeSegment:
    """The solutions on [start, start + length] as polynomials with ball coefficients.

    ``states[i]`` holds the coefficients of entry i of the state (coordinates, rates, modules' own
    states) in the time since ``start``, ``accelerations[i]`` those of the second derivative of
    coordinate i. ``steps`` holds the exact ends of the segment in units of the step. ``last`` is
    the set of states at the end, and ``end`` its hull; without states, ``last`` is None except at
    the end of a tube. ``spread`` is the set over the whole segment, for a wide tube.
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
        """The number of the step whose input acts, from 0."""
        return int(self.steps[0])

    def at(self, tau: arb) -> list[arb]:
        """The states ``tau`` after the start; a ball of times gives an enclosure over it."""
        return [polynomial(coefficients, tau) for coefficients in self.states]


def polynomial(coefficients: Sequence[arb], tau: arb) -> arb:
    """The value of a polynomial, by Horner's rule."""
    value = arb(0)
    for coefficient in reversed(coefficients):
        value = value * tau + coefficient
    return value


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

    A robot that cannot move has one segment per step.

    Args:
        field: the equations of motion.
        initial: the states at time 0; a sequence of balls stands for their box.
        inputs: the stated inputs, a row of balls per step.
        dt: the length of a step in seconds.
        accuracy: order, bits, and how much a segment may add.
        error: how far inputs may be from the commanded ones, in any measurable way over time;
            default: they are equal.
        law: sets the inputs that the states hold at each sample; the inputs of the field are then
            added to them. Default: the inputs of the field are the stated ones.
        steps: the numbers of the steps in order; default: all.
        accelerations: whether segments also enclose the accelerations.

    Raises:
        EnclosureFailure: a segment has no validated enclosure, however short it is.
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
    start, fields = dt * numbers.start, StickingFields(field)
    signs: Signs = {}
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
        robot = RubbingRobot(fields, drive, dt, accuracy, control)
        parts = 0
        while first < last:
            found, parts = robot.next(states, last - first, signs), parts + 1
            if found is None or (field.friction and parts > MOST_RUBBING):
                raise EnclosureFailure(float(start.mid()))
            passage, drive, signs = found.passage, found.drive, found.signs
            seconds = dt * ball(found.length)
            ends = first, first + found.length
            yield TubeSegment(
                start, seconds, ends, _states(passage), tuple(passage.end.hull()),
                tuple(drive.all), tuple(commanded), passage.end, passage.moved.spread,
                _accelerations(passage, field.dofs) if accelerations else (),
            )  # fmt: skip
            states, first, start = passage.end, ends[1], dt * ball(ends[1])


def _states(passage: Passage) -> tuple[Coefficients, ...]:
    """The polynomials of a segment: the path's, with the deviations in the constant terms."""
    found = []
    for item, radius in zip(passage.path.polynomials, passage.moved.radii, strict=True):
        coefficients = item.coeffs() or [arb(0)]
        found.append([coefficients[0] + SIGNS * radius, *coefficients[1:]])
    return tuple(found)


def _accelerations(passage: Passage, dofs: int) -> tuple[Coefficients, ...]:
    """The accelerations: the derivatives of the path, plus the most that deviations add."""
    found, own = [], slice(dofs, 2 * dofs)
    pulls = pulled(passage.deviation, passage.moved, passage.path.length)[:dofs]
    for item, pull in zip(passage.path.polynomials[own], pulls, strict=True):
        coefficients = item.derivative().coeffs() or [arb(0)]
        found.append([coefficients[0] + SIGNS * pull, *coefficients[1:]])
    return tuple(found)
