"""The number of short paths that visit certain cells, which a counterexample excludes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import pairwise

import numpy as np

from compiler.tasks.effector_distances import EffectorDistances
from compiler.tasks.places import UNREACHABLE, distances
from compiler.tasks.specification import PlannedEffector, PlanningProblem

MOST = 1000
"""Paths are counted up to this number."""
STEPS = 50_000
"""The most cells that are entered while counting."""


def count_paths(
    problem: PlanningProblem,
    effector: int,
    cells: Sequence[int],
    changes: int,
    *,
    ordered: bool,
) -> int:
    """The number of paths from the start to the end that visit some cells; ``ordered``: in order.

    Only paths that enter no cell twice count, by depth-first search. The formula is used only for
    where paths begin, are and end. At most ``MOST`` are counted.

    Args:
        problem: the planning problem.
        effector: the effector of the paths (from 0), one that is planned.
        cells: the cells that they visit; other cells may lie between.
        changes: the most changes of cell that they have.
        ordered: whether the cells are visited in this order.
    """
    planned = next(one for one in problem.effectors if one.effector == effector)
    search = _Search(problem, planned, tuple(cells), ordered=ordered)
    return sum(1 for _ in search.paths(changes))


class _Search:
    """The paths of an effector through some cells, depth first."""

    def __init__(
        self,
        problem: PlanningProblem,
        planned: PlannedEffector,
        cells: tuple[int, ...],
        *,
        ordered: bool,
    ) -> None:
        found = EffectorDistances(problem, planned)
        self.starts = np.flatnonzero((found.from_start == 0) & (found.to_end < UNREACHABLE))
        self._neighbours = problem.neighbours
        self._to_end = found.to_end
        self._cells = cells
        self._ordered = ordered
        usable = (found.from_start < UNREACHABLE) & (found.to_end < UNREACHABLE)
        self._to_cell = [distances(problem.neighbours, [cell], usable) for cell in cells]
        legs = [int(self._to_cell[i + 1][a]) for i, (a, _) in enumerate(pairwise(cells))]
        ends = [int(found.to_end[cell]) for cell in cells]
        self._rest = ends if not ordered else [
            sum(legs[i:]) + ends[-1] for i in range(len(cells))
        ]  # fmt: skip

    def paths(self, changes: int) -> Iterator[None]:
        """Yield once for each path of at most ``changes`` changes."""
        count, entered = 0, 0
        every = frozenset(range(len(self._cells)))
        stack: list[tuple[int, frozenset[int], tuple[int, ...]]] = [
            (cell, self._left(cell, every), (cell,)) for cell in self.starts.tolist()
        ]
        while stack:
            cell, left, path = stack.pop()
            entered += 1
            if len(path) - 1 + self._needed(cell, left) > changes:
                continue
            if not left and self._to_end[cell] == 0:
                yield
                count += 1
            if count >= MOST or entered >= STEPS:
                return
            stack += [
                (following, self._left(following, left), (*path, following))
                for following in reversed(self._neighbours[cell])
                if following not in path
            ]

    def _left(self, cell: int, left: frozenset[int]) -> frozenset[int]:
        """The cells, by their indices, that remain to be visited once a cell is entered."""
        if self._ordered:
            due = min(left, default=None)
            return left - {due} if due is not None and self._cells[due] == cell else left
        return frozenset(place for place in left if self._cells[place] != cell)

    def _needed(self, cell: int, left: frozenset[int]) -> int:
        """A lower bound on the changes from a cell through the remaining cells to the end."""
        if not left:
            return int(self._to_end[cell])
        due = [min(left)] if self._ordered else sorted(left)
        return max(int(self._to_cell[place][cell]) + self._rest[place] for place in due)
