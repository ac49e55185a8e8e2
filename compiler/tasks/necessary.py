"""Properties of every motion that fulfils a task: visits, avoidance, rest."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from typing import TypeAlias

from compiler.robots.effector_counts import several_effectors
from compiler.robots.effectors_on_bodies import effectors_are_on_bodies
from grammar_lang import ir

# --- Where the effectors must be at some instant, whatever the robot ------------------------------


@dataclass(frozen=True, slots=True)
class Stop:
    """A region in which an effector must be at some instant.

    ``effector`` is its number, from 1, or None for the recorded one if the task names none.
    """

    region: str
    effector: int | None
    role: str


def stops(program: ir.Program, task: ir.Task) -> tuple[Stop, ...]:
    """Where effectors must be whatever the robot: start, target, visits of the formulas."""
    found = [*_ends(task)]
    found += [Stop(p.region, p.effector, "region") for p in task_visits(task)]
    if any(stop.effector is None for stop in found) and _single(program, task):
        found = [Stop(stop.region, stop.effector or 1, stop.role) for stop in found]
    return tuple(found)


def _single(program: ir.Program, task: ir.Task) -> bool:
    """Whether every robot of the family is known to have at most one effector."""
    return several_effectors(program, program.grammars[task.grammar]) is False


def _ends(task: ir.Task) -> Iterator[Stop]:
    """Start and target; if the start names no effector, the one that reaches also starts."""
    reaching = None if task.reach is None else task.reach.effector
    if isinstance(task.start, ir.StartIn):
        yield Stop(task.start.region, task.start.effector or reaching, "start")
    if task.reach is not None:
        yield Stop(task.reach.region, reaching, "target")


# --- What every motion that satisfies a formula does, read off the formula alone ------------------
#
# *Necessary visits*: an effector is in a region at some instant of [0, T], not after a deadline.
# *Permanent avoidance*: it is there at no instant of [0, T]. Both are sound and incomplete: a
# formula may entail more, and earlier. Visits also hold for motions that go on for ever, as
# ignoring what comes after T demands less. Negations are pushed inwards on the way.


@dataclass(frozen=True, slots=True, order=True)
class Place:
    """A region, and the number (from 1) of the effector that visits or never visits it."""

    region: str
    effector: int


Places: TypeAlias = frozenset[Place]
Visits: TypeAlias = Mapping[Place, Fraction]
"""Places that are visited, each with its deadline: a time (s) not after which it is."""

NOWHERE: Places = frozenset()
NO_VISITS: Visits = {}


def necessary_visits(formula: ir.Formula, horizon: Fraction, step: Fraction) -> Visits:
    """The places that are visited in [0, T] whenever a formula holds at time 0, by when (s).

    Args:
        formula: the formula.
        horizon: T, in seconds.
        step: the length of a step, in seconds.
    """
    return _Visits(horizon, step).of(formula, Fraction(0))


def permanently_avoided(formula: ir.Formula, horizon: Fraction | None) -> Places:
    """The places that are never entered in [0, T] whenever a formula holds at time 0.

    Without a ``horizon``, motions go on for ever.
    """
    return _Avoided(horizon).at_first(formula)


def task_visits(task: ir.Task) -> Visits:
    """The places that the formulas and loads of a task together make necessary, sorted.

    If a motion may end at several times, they are necessary for each of these: what holds for the
    shortest motion holds for all, as a later end leaves more of every window. Deadlines are those
    of the longest motion, the latest for the same reason; those of endless motions are T, within
    which every pose of theirs is taken.
    """
    shortest, longest = (
        _earliest(necessary_visits(each.formula, steps * task.step, task.step)
                  for each in task.demanded)
        for steps in (task.fewest_steps, task.steps)
    )  # fmt: skip
    end = task.steps * task.step
    return {p: end if task.repeat else longest[p] for p in sorted(shortest)}


def task_avoidance(task: ir.Task, effector: int | None) -> tuple[str, ...]:
    """The regions that an effector never enters, sorted: from ``avoid`` and from formulas.

    Args:
        task: the task.
        effector: its number, from 1; None for an effector without a number.
    """
    regions = {name for a in task.avoid if a.subject == "effector" for name in a.regions}
    # A place that is never entered in the longest motion is never entered in a shorter one: a
    # window that covers the longer motion covers the shorter one.
    end = None if task.repeat else task.steps * task.step
    for clause in task.satisfy:
        found = permanently_avoided(clause.formula, end)
        regions.update(place.region for place in found if place.effector == effector)
    return tuple(sorted(regions))


def family_avoidance(program: ir.Program, task: ir.Task, effector: int | None) -> tuple[str, ...]:
    """The regions that an effector of no robot of the family enters, sorted.

    They are those of ``task_avoidance``, and what bodies avoid if all effectors are on bodies.
    """
    avoided = set(task_avoidance(task, effector))
    bodies = {name for a in task.avoid if a.subject == "body" for name in a.regions}
    if not bodies <= avoided and effectors_are_on_bodies(program, program.grammars[task.grammar]):
        avoided |= bodies
    return tuple(sorted(avoided))


def _union(parts: Iterable[Places]) -> Places:
    return frozenset[Place]().union(*parts)


def _common(parts: Iterable[Places]) -> Places:
    return reduce(frozenset[Place].intersection, parts)


def _earliest(parts: Iterable[Visits]) -> Visits:
    """The visits of all parts, which all hold."""
    found: dict[Place, Fraction] = {}
    for part in parts:
        for place, by in part.items():
            found[place] = min(by, found.get(place, by))
    return found


def _latest(parts: Iterable[Visits]) -> Visits:
    """The visits of every part, one of which holds."""
    first, *rest = parts
    return {
        place: max(by, *(each[place] for each in rest)) if rest else by
        for place, by in first.items()
        if all(place in each for each in rest)
    }


def _pushed(formula: ir.Formula) -> ir.Formula:
    """The formula without a leading negation, as far as its operators have duals."""
    while isinstance(formula, ir.Not):
        match formula.operand:
            case ir.Not(operand=part):
                formula = part
            case ir.And(operands=operands):
                return ir.Or(tuple(ir.Not(part) for part in operands))
            case ir.Or(operands=operands):
                return ir.And(tuple(ir.Not(part) for part in operands))
            case ir.Implies(left=left, right=right):
                return ir.And((left, ir.Not(right)))
            case ir.Always(operand=part, window=window):
                return ir.Eventually(ir.Not(part), window)
            case ir.Eventually(operand=part, window=window):
                return ir.Always(ir.Not(part), window)
            case _:
                return formula
    if isinstance(formula, ir.Implies):
        return ir.Or((ir.Not(formula.left), formula.right))
    return formula


@dataclass(frozen=True, slots=True)
class _Visits:
    horizon: Fraction
    step: Fraction

    def of(self, formula: ir.Formula, latest: Fraction) -> Visits:
        """The visits that follow from a formula that holds at some instant not after ``latest``."""
        pushed = _pushed(formula)
        match pushed:
            case ir.And(operands=operands):
                return _earliest([self.of(part, latest) for part in operands])
            case ir.Or(operands=operands):
                return _latest([self.of(part, latest) for part in operands])
            case ir.Not(operand=operand):
                return self.without(operand, latest)
            case ir.Atom(region=region, effector=effector):
                return {Place(region, effector): latest}
            case _:
                return self.in_time(pushed, latest)

    def in_time(self, formula: ir.Formula, latest: Fraction) -> Visits:
        """The visits that follow from a temporal operator."""
        match formula:
            case ir.Always(operand=part, window=window):
                return self.if_in_time(part, latest + window.lower)
            case ir.Eventually(operand=part, window=window):
                upper = self.horizon if window.upper is None else latest + window.upper
                return self.of(part, min(upper, self.horizon))
            case ir.Last(operand=part, duration=duration):
                return self.of(part, max(Fraction(0), self.horizon - duration))
            case ir.Next(operand=part):
                return self.of(part, min(latest + self.step, self.horizon))
            case ir.Until(left=left, right=right):
                # Left or right holds at first, and right at some time.
                at_first = _latest([self.of(left, latest), self.of(right, latest)])
                return _earliest([at_first, self.of(right, self.horizon)])
            case _:
                raise TypeError(formula)

    def without(self, formula: ir.Formula, latest: Fraction) -> Visits:
        """The visits that follow from the negation of a formula that has no dual."""
        match formula:
            case ir.Last(operand=part):
                return self.of(ir.Not(part), self.horizon)
            case ir.Next(operand=part):
                return self.if_in_time(ir.Not(part), latest + self.step)
            case ir.Until(right=right):
                return self.of(ir.Not(right), latest)
            case _:
                return NO_VISITS

    def if_in_time(self, formula: ir.Formula, latest: Fraction) -> Visits:
        """The visits if nothing is demanded after T: an instant after T demands nothing."""
        return self.of(formula, latest) if latest <= self.horizon else NO_VISITS


@dataclass(frozen=True, slots=True)
class _Avoided:
    horizon: Fraction | None

    def lasts(self, duration: Fraction | None) -> bool:
        """Whether this duration covers the whole motion; None stands for all time."""
        return duration is None or (self.horizon is not None and duration >= self.horizon)

    def at_first(self, formula: ir.Formula) -> Places:
        """The avoided places that follow from a formula that holds at time 0."""
        pushed = _pushed(formula)
        match pushed:
            case ir.And(operands=operands):
                return _union([self.at_first(part) for part in operands])
            case ir.Or(operands=operands):
                return _common([self.at_first(part) for part in operands])
            case ir.Always(operand=part, window=window):
                covers = self.lasts(window.upper) and window.lower == 0
                return self.throughout(part) if covers else NOWHERE
            case ir.Last(operand=part, duration=duration):
                return self.throughout(part) if self.lasts(duration) else NOWHERE
            case _:
                return NOWHERE

    def throughout(self, formula: ir.Formula) -> Places:
        """The avoided places that follow from a formula that holds at every instant of [0, T]."""
        pushed = _pushed(formula)
        match pushed:
            case ir.And(operands=operands):
                return _union([self.throughout(part) for part in operands])
            case ir.Or(operands=operands):
                return _common([self.throughout(part) for part in operands])
            case ir.Not(operand=ir.Atom(region=region, effector=effector, poses=())):
                return frozenset([Place(region, effector)])
            case ir.Not(operand=ir.Until(right=right)):
                return self.throughout(ir.Not(right))
            case ir.Until(left=left, right=right):
                return self.throughout(left) & self.throughout(right)
            case ir.Always(operand=part, window=window):
                return self.throughout(part) if window.lower == 0 else NOWHERE
            case ir.Last():
                return self.at_first(pushed)
            case _:
                return NOWHERE
