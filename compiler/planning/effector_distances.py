"""How far the cells are for one effector of a problem, and how many changes it needs at least."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from compiler.planning.cell_graph import UNREACHABLE, distances, edges
from compiler.planning.clauses import Ints
from compiler.planning.formula_demands import FormulaDemands, formula_demands
from compiler.planning.formula_distances import formula_distances
from compiler.planning.specification import PlannedEffector, PlanningProblem
from compiler.specifications.sampled_formula import Literal, SampledFormula

Mask = NDArray[np.bool_]


class EffectorDistances:
    """Distances in changes of cell, within what the task and its formula allow.

    Attributes:
        edges: the graph.
        from_start: per cell, ``UNREACHABLE`` where there is no way; shape (n,).
        to_end: likewise.
        shortest: the fewest changes from the start to an end whatever the formula says; None if
            there is no way.
        least: no fewer satisfy the formula; None if none do, for certain.
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
            self.shortest = _least(np.add(*self._within(FormulaDemands())))
            self.least = self._least_of_formula(problem.formula, demands)

    def _least_of_formula(self, formula: SampledFormula, demands: FormulaDemands) -> int | None:
        """The fewest changes from the start for the formula, and to an end."""
        needed = formula_distances(
            formula, self._problem.neighbours, self._allowed(demands), self._where_alone
        )
        return _least(np.where(self.from_start == 0, np.maximum(needed, self.to_end), UNREACHABLE))

    def _where_alone(self, literal: Literal) -> Mask | None:
        own = literal.effector == self._planned.effector + 1
        return self._where([literal]) if own else None

    def _allowed(self, demands: FormulaDemands) -> Mask:
        count = len(self._problem.neighbours)
        return self._where(demands.always) & ~_cells(count, self._planned.forbidden)

    def _within(self, demands: FormulaDemands) -> tuple[Ints, Ints]:
        """Distances from the start and to the end within what is allowed."""
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
        """The cells in which all of the literals about this effector hold."""
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
