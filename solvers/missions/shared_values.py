"""Parameters that robots of several tasks share, and motions with a single value of each.

Robots are first found one by one, each with parameters that suit its own task.  Then the values of
each of them in turn are given to the others, until motions are found for all.  From there, one
program for all motions (:mod:`joint_motions`) looks for better values.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from compiler.missions.parameter_boxes import Box, Cut
from compiler.missions.parameter_ranges import meet, ranges_of, single
from compiler.time_limits.time_limit import OutOfTimeError
from compiler.words.derivation import Derivation
from grammar_lang import ir
from solvers.missions.joint_motions import joint_values, least_share
from solvers.missions.motions_sought import MotionsSought
from solvers.missions.task_robots import TaskRobots
from solvers.search.path_task import Design

Place: TypeAlias = tuple[int, int]
"""A task of a mission and the index of a parameter of its robot."""
Group: TypeAlias = tuple[Place, ...]
"""Parameters that must be equal."""
Values: TypeAlias = dict[Place, Fraction]
_NOTHING: Mapping[Group, Fraction] = {}


@dataclass(slots=True, eq=False)
class Candidate:
    """A structure with parameters in a box that does one task of a mission, by a ``design``."""

    robots: TaskRobots
    derivation: Derivation
    box: Box
    design: Design

    def value(self, parameter: int) -> Fraction:
        """The value of a parameter in the design."""
        return self.design.parameters[parameter].stated


@dataclass(frozen=True, slots=True)
class Agreed:
    """A design for every task, with equal parameters in each group."""

    designs: tuple[Design, ...]


def agreed(
    candidates: Sequence[Candidate],
    groups: Sequence[Group],
    fixed: Mapping[Group, Fraction],
    number: int,
) -> Agreed | None:
    """Designs with common values, or None if none were found.

    Args:
        candidates: for every task a structure that does it.
        groups: the parameters that must be equal.
        fixed: the groups whose value is given.
        number: the number of the structures in reports.
    """
    tried: list[Values] = []
    found: tuple[Design, ...] | None = None
    for values in _assignments(candidates, groups, fixed):
        if found is None and values not in tried:
            tried.append(values)
            found = _designs(candidates, values, number)
    tasks = [each.robots for each in candidates]
    if found is not None and any(each.minimizes for each in tasks):
        return Agreed(found)
    boxes = [each.box for each in candidates]
    begun = [each.design for each in candidates] if found is None else found
    better = None
    try:
        together = joint_values(tasks, boxes, begun, groups, fixed)
        if together is not None and together not in tried:
            better = _designs(candidates, together, number)
    except OutOfTimeError:
        if found is None:
            raise
    if better is not None and (
        found is None or least_share(tasks, better) > least_share(tasks, found)
    ):
        found = better
    return None if found is None else Agreed(found)


def _assignments(
    candidates: Sequence[Candidate], groups: Sequence[Group], fixed: Mapping[Group, Fraction]
) -> Iterator[Values]:
    """Values for all groups: the fixed ones, with those of one design after another."""
    for leader in range(len(candidates)):
        values: Values = {}
        for group in groups:
            first = next((place for place in group if place[0] == leader), group[0])
            value = fixed.get(group, candidates[first[0]].value(first[1]))
            values |= dict.fromkeys(group, value)
        if all(_allows(candidates[k], parameter, v) for (k, parameter), v in values.items()):
            yield values


def _allows(candidate: Candidate, parameter: int, value: Fraction) -> bool:
    """Whether a value is in the box of a candidate."""
    return meet(single(value), ranges_of(candidate.box[parameter]))


def _designs(
    candidates: Sequence[Candidate], values: Values, number: int
) -> tuple[Design, ...] | None:
    """Designs with given values; robots that already have them stay as they are."""
    sought: list[tuple[Candidate, MotionsSought | None]] = []
    for k, candidate in enumerate(candidates):
        own = {parameter: v for (task, parameter), v in values.items() if task == k}
        robots, derivation = candidate.robots, candidate.derivation
        box = pinned(candidate.box, own, candidate.design)
        if all(candidate.value(parameter) == value for parameter, value in own.items()):
            better = robots.motions(derivation, box, number) if robots.minimizes else None
            sought.append((candidate, better))
            continue
        motions = robots.open_motions(derivation, box, number)
        if motions is None or motions.first() is None:
            return None
        sought.append((candidate, motions))
    return tuple(
        candidate.design if motions is None else motions.best() or candidate.design
        for candidate, motions in sought
    )


def proved_at_once(
    robots: Sequence[tuple[TaskRobots, Derivation, Box]],
    groups: Sequence[Group],
    fixed: Mapping[Group, Fraction],
    number: int,
) -> tuple[Design, ...] | None:
    """Designs with common values from the first motion proved in each task, improved by no search.

    None if none were found.  The arguments are those of ``agreed``, without designs.
    """
    candidates = list[Candidate]()
    for each, derivation, box in robots:
        design = each.motions(derivation, box, number).at_once()
        if design is None:
            return None
        candidates.append(Candidate(each, derivation, box, design))
    for values in _assignments(candidates, groups, fixed):
        found = list[Design]()
        for k, candidate in enumerate(candidates):
            own = {parameter: v for (task, parameter), v in values.items() if task == k}
            design = _at_once(candidate, own, number)
            if design is None:
                break
            found.append(design)
        else:
            return tuple(found)
    return None


def _at_once(candidate: Candidate, values: Mapping[int, Fraction], number: int) -> Design | None:
    """The first design of a candidate with some values."""
    if all(candidate.value(parameter) == value for parameter, value in values.items()):
        return candidate.design
    box = pinned(candidate.box, values, candidate.design)
    motions = candidate.robots.open_motions(candidate.derivation, box, number)
    return None if motions is None else motions.at_once()


def pinned(box: Box, values: Mapping[int, Fraction], design: Design | None = None) -> Box:
    """A box with some parameters fixed to one value; a design may have the value exactly."""
    found = list(box)
    for parameter, value in values.items():
        exact: ir.Expr = ir.Num(value)
        if design is not None:
            own = design.parameters[parameter]
            if own.stated == value and not isinstance(own.exact, Fraction):
                exact = own.exact
        found[parameter] = ir.Choices((_choice(found[parameter], value, exact),))
    return tuple(found)


def _choice(domain: ir.Interval | ir.Choices, value: Fraction, exact: ir.Expr) -> ir.Expr:
    """The value of a domain that a rational number stands for."""
    if isinstance(domain, ir.Choices):
        meant = [
            each for each in domain.values if meet(single(value), ranges_of(ir.Choices((each,))))
        ]
        return meant[0] if meant else exact
    return exact


def is_within(design: Design, box: Box) -> bool:
    """Whether the parameters of a design are in a box."""
    pairs = zip(design.parameters, box, strict=True)
    return all(meet(single(value.stated), ranges_of(domain)) for value, domain in pairs)


# --- Where to cut boxes whose robots disagree -----------------------------------------------------


def widest_disagreement(
    candidates: Sequence[Candidate],
    groups: Sequence[Group],
    whole: Sequence[Box],
    fixed: Mapping[Group, Fraction] = _NOTHING,
) -> tuple[Group, Fraction, Fraction] | None:
    """The group whose values differ most, relative to their range, and its extreme values.

    ``whole`` contains for every task the full box of its structure.
    """
    best: tuple[Fraction, Group, Fraction, Fraction] | None = None
    for group in groups:
        values = [candidates[task].value(parameter) for task, parameter in group]
        values += [fixed[group]] if group in fixed else []
        low, high = min(values), max(values)
        # A parameter fixed by `from` has one value in the first task and may vary in the others.
        width = max(_width(whole[task][parameter]) for task, parameter in group) or Fraction(1)
        if low < high and (best is None or (high - low) / width > best[0]):
            best = (high - low) / width, group, low, high
    return None if best is None else best[1:]


def _width(domain: ir.Interval | ir.Choices) -> Fraction:
    """The distance between the least and the greatest value of a domain."""
    ranges = ranges_of(domain)
    return max(r.high for r in ranges) - min(r.low for r in ranges)


def _index(domain: ir.Choices, value: Fraction) -> int:
    """The index of the choice that a rational number stands for; -1 if there is none."""
    found = (ranges_of(ir.Choices((choice,))) for choice in domain.values)
    return next((i for i, ranges in enumerate(found) if meet(single(value), ranges)), -1)


def cut_between(box: Box, parameter: int, low: Fraction, high: Fraction) -> Cut | None:
    """A cut of a box that separates two values of a parameter; None if there is none."""
    domain = box[parameter]
    if isinstance(domain, ir.Choices):
        first, second = sorted((_index(domain, low), _index(domain, high)))
        return Cut(parameter, second) if 0 <= first < second else None
    (own,) = ranges_of(domain)
    at = ((low + high) / 2).limit_denominator(2**20)
    if not low < at < high:
        at = (low + high) / 2
    return Cut(parameter, at) if own.low < at < own.high else None
