"""Distances of cells for an effector, and the least number of changes of cell for a formula."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from heapq import heapify, heappop, heappush
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from compiler.tasks.formula_clauses import Ints
from compiler.tasks.places import UNREACHABLE, distances, edges
from compiler.tasks.sampled_formula import (
    Eventually,
    Every,
    Literal,
    SampledFormula,
    Some,
    Throughout,
    ThroughoutFrom,
    Until,
    nodes,
    parts_of,
)
from compiler.tasks.specification import PlannedEffector, PlanningProblem

# --------------------------------------------------------------------------------------------------
# What every word that satisfies a sampled formula does: where it always is, begins and ends.


@dataclass(slots=True)
class FormulaConditions:
    """Literals that hold at all samples, at the first sample, or at the last."""

    always: list[Literal] = field(default_factory=list)
    first: list[Literal] = field(default_factory=list)
    last: list[Literal] = field(default_factory=list)


def formula_demands(formula: SampledFormula | None) -> FormulaConditions:
    """Conditions that are necessary for the formula to hold at sample 0, not sufficient."""
    found = FormulaConditions()
    if formula is None:
        return found
    for part in _conjuncts(formula):
        match part:
            case Literal():
                found.first.append(part)
            case Throughout(part=Literal() as literal, first=0, last=None):
                found.always.append(literal)
            case ThroughoutFrom(part=Literal() as literal):
                found.last.append(literal)
            case _:
                pass
    return found


def _conjuncts(formula: SampledFormula) -> Iterator[SampledFormula]:
    stack = [formula]
    while stack:
        part = stack.pop()
        if isinstance(part, Every):
            stack.extend(reversed(part.parts))
        else:
            yield part


# --------------------------------------------------------------------------------------------------
# The least number of changes of cell that an effector needs for a formula to hold, for every cell.
#
# Times and other effectors are ignored, so the numbers are lower bounds; they are exact for visits
# one after the other.


Mask: TypeAlias = NDArray[np.bool_]
NEAR = 4
"""Windows of at most this many samples bound the changes until they end."""


def formula_distances(
    formula: SampledFormula,
    neighbours: Sequence[Sequence[int]],
    allowed: Mask,
    inside: Callable[[Literal], Mask | None],
) -> Ints:
    """For each cell a lower bound, ``UNREACHABLE`` if the formula cannot hold; shape (n,).

    Args:
        formula: the formula that must hold.
        neighbours: the neighbours of each cell.
        allowed: the cells that may be entered.
        inside: where a literal holds; None for one about another effector.
    """
    of: dict[int, Ints] = {}
    for node in nodes(formula):
        of[id(node)] = _bounds(node, of, neighbours, allowed, inside)
    return of[id(formula)]


def _bounds(
    node: SampledFormula,
    of: Mapping[int, Ints],
    neighbours: Sequence[Sequence[int]],
    allowed: Mask,
    inside: Callable[[Literal], Mask | None],
) -> Ints:
    none = np.zeros(len(neighbours), dtype=np.int64)
    parts = [of[id(part)] for part in parts_of(node)]
    match node:
        case Literal():
            holds = inside(node)
            return none if holds is None else np.where(holds, none, UNREACHABLE)
        case Every():
            return np.asarray(np.max([none, *parts], axis=0), dtype=np.int64)
        case Some():
            return np.asarray(np.min([none + UNREACHABLE, *parts], axis=0), dtype=np.int64)
        case Eventually(last=int() as last) if last <= NEAR:
            return _within(parts[0], neighbours, allowed, last)
        case Eventually() | ThroughoutFrom():
            return _on_the_way(parts[0], neighbours, allowed)
        case Until():
            return _on_the_way(parts[1], neighbours, allowed & (parts[0] < UNREACHABLE))
        case Throughout(first=0):
            return parts[0]
        case _:
            return none


def _within(goal: Ints, neighbours: Sequence[Sequence[int]], through: Mask, most: int) -> Ints:
    """As ``_on_the_way``, with at most ``most`` changes; one change leads to the next sample."""
    found = goal.tolist()
    passable = np.flatnonzero(through).tolist()
    for _ in range(most):
        before = list(found)
        for cell in passable:
            nearest = min((before[other] for other in neighbours[cell]), default=UNREACHABLE)
            found[cell] = min(found[cell], nearest + 1)
    return np.minimum(np.array(found, dtype=np.int64), UNREACHABLE)


def _on_the_way(goal: Ints, neighbours: Sequence[Sequence[int]], through: Mask) -> Ints:
    """The least number of changes to a cell through some cells, and from there as in ``goal``."""
    if not goal.any():
        return goal
    found, passable = goal.tolist(), through.tolist()
    waiting = [(bound, cell) for cell, bound in enumerate(found) if bound < UNREACHABLE]
    heapify(waiting)
    while waiting:
        bound, cell = heappop(waiting)
        if bound > found[cell]:
            continue
        for other in neighbours[cell]:
            if passable[other] and found[other] > bound + 1:
                found[other] = bound + 1
                heappush(waiting, (bound + 1, other))
    return np.array(found, dtype=np.int64)


# --------------------------------------------------------------------------------------------------
# Distances of cells for one effector of a problem, and the least number of changes it needs.


class EffectorDistances:
    """Distances in changes of cell, within what the task and its formula allow.

    Attributes:
        edges: the graph.
        from_start: the distance of each cell, ``UNREACHABLE`` if there is no path; shape (n,).
        to_end: the distance from each cell to an end, in the same form.
        shortest: the fewest changes from the start to an end whatever the formula says; None if
            there is no path.
        least: no fewer changes satisfy the formula; None if certainly no path does.
    """

    def __init__(self, problem: PlanningProblem, planned: PlannedEffector) -> None:
        self.edges = edges(problem.neighbours)
        self._problem = problem
        self._planned = planned
        demands = formula_demands(problem.formula)
        self.from_start, self.to_end = self._within(demands)
        self.least = _least(np.where(self.from_start == 0, self.to_end, UNREACHABLE))
        self.shortest = self.least
        if problem.formula is not None:
            self.shortest = _least(np.add(*self._within(FormulaConditions())))
            self.least = self._least_of_formula(problem.formula, demands)

    def _least_of_formula(self, formula: SampledFormula, demands: FormulaConditions) -> int | None:
        """The fewest changes from the start that satisfy the formula and lead to an end."""
        needed = formula_distances(
            formula, self._problem.neighbours, self._allowed(demands), self._where_alone
        )
        return _least(np.where(self.from_start == 0, np.maximum(needed, self.to_end), UNREACHABLE))

    def _where_alone(self, literal: Literal) -> Mask | None:
        own = literal.effector == self._planned.effector + 1
        return self._where([literal]) if own else None

    def _allowed(self, demands: FormulaConditions) -> Mask:
        count = len(self._problem.neighbours)
        return self._where(demands.always) & ~_cells(count, self._planned.forbidden)

    def _within(self, demands: FormulaConditions) -> tuple[Ints, Ints]:
        """The distances from the start and to the end within the allowed cells."""
        planned, neighbours = self._planned, self._problem.neighbours
        count = len(neighbours)
        allowed = self._allowed(demands)
        start = self._where(demands.first) & _cells(count, planned.start)
        end = self._where(demands.last)
        if planned.end is not None:
            end &= _cells(count, planned.end)
        return (
            distances(neighbours, np.flatnonzero(start).tolist(), allowed),
            distances(neighbours, np.flatnonzero(end).tolist(), allowed),
        )

    def _where(self, literals: Sequence[Literal]) -> Mask:
        """The cells in which all literals about this effector hold."""
        mask = np.ones(len(self._problem.neighbours), dtype=bool)
        for literal in literals:
            if literal.effector == self._planned.effector + 1:
                mask &= _inside(self._problem, literal.region) == literal.positive
        return mask


def _least(through: Ints) -> int | None:
    least = int(through.min(initial=UNREACHABLE))
    return least if least < UNREACHABLE else None


def _cells(count: int, chosen: Iterable[int]) -> Mask:
    mask = np.zeros(count, dtype=bool)
    mask[list(chosen)] = True
    return mask


def _inside(problem: PlanningProblem, region: str) -> Mask:
    return np.array([region in names for names in problem.propositions], dtype=bool)
