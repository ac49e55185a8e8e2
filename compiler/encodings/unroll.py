"""Paths through cells as clauses: one Boolean per (cell, position).

Source: Biere, Cimatti, Clarke & Zhu, *Symbolic model checking without BDDs* (1999), with the
ladder encoding of "at most one" (Gent & Nightingale 2004).  A layer is added per position and
nothing is ever rebuilt; the bound m is chosen by assuming the literal ``at_target(m)``.
A variable exists only where its cell can be at its position: no sooner than its distance from
the start, and no later than its distance to the target leaves room for within the limit.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Sequence
from typing import Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

Ints: TypeAlias = NDArray[np.int64]
UNREACHABLE = np.iinfo(np.int64).max // 4


class CellGraph(Protocol):
    """Cells 0 .. n - 1 with a symmetric adjacency."""

    @property
    def neighbours(self) -> tuple[tuple[int, ...], ...]:
        """Per cell its neighbours, ascending."""


def distances(graph: CellGraph, sources: Iterable[int], allowed: NDArray[np.bool_]) -> Ints:
    """The least number of steps from the sources within the allowed cells, shape (n,)."""
    found = np.full(len(graph.neighbours), UNREACHABLE, dtype=np.int64)
    waiting = deque(cell for cell in sorted(set(sources)) if allowed[cell])
    found[list(waiting)] = 0
    while waiting:
        cell = waiting.popleft()
        for following in graph.neighbours[cell]:
            if allowed[following] and found[following] == UNREACHABLE:
                found[following] = found[cell] + 1
                waiting.append(following)
    return found


class Unrolling:
    """Simple paths c_0 .. c_m from start to target, m <= limit, clause by clause.

    Variables count from 1; 0 stands for a variable that does not exist, which is false.
    """

    def __init__(
        self,
        graph: CellGraph,
        start: Iterable[int],
        target: Iterable[int],
        forbidden: Iterable[int],
        limit: int,
    ) -> None:
        """Measure distances; no clauses yet (``extend`` makes them)."""
        self._cells = len(graph.neighbours)
        degrees = [len(cells) for cells in graph.neighbours]
        self._tails = np.repeat(np.arange(self._cells), degrees)
        self._heads = np.array([c for cells in graph.neighbours for c in cells], dtype=np.int64)
        allowed = np.ones(self._cells, dtype=bool)
        allowed[list(forbidden)] = False
        self._target = np.zeros(self._cells, dtype=bool)
        self._target[list(target)] = True
        self._from_start = distances(graph, start, allowed)
        self._to_target = distances(graph, np.flatnonzero(self._target).tolist(), allowed)
        through = self._from_start + self._to_target
        self.shortest: int | None = int(through.min()) if (through < UNREACHABLE).any() else None
        longest = int((through < UNREACHABLE).sum()) - 1
        self.complete = longest <= limit
        self.limit = min(limit, longest)
        self._at: list[Ints] = []
        self._seen = np.zeros(self._cells, dtype=np.int64)
        self._at_target: list[int] = []
        self._last = 0

    @property
    def positions(self) -> int:
        """The number of positions laid out so far."""
        return len(self._at)

    def variable(self, cell: int, position: int) -> int:
        """The variable of a cell at a position laid out, 0 if the cell cannot be there."""
        return int(self._at[position][cell])

    def at_target(self, position: int) -> int:
        """The literal that, assumed, lets the path end in the target at a position laid out."""
        return self._at_target[position]

    def extend(self) -> list[Ints]:
        """Lay out the next position; its clauses, as arrays of shape (clauses, literals)."""
        position = self.positions
        useful = (self._from_start <= position) & (self._to_target <= self.limit - position)
        cells = np.flatnonzero(useful)
        layer = np.zeros(self._cells, dtype=np.int64)
        layer[cells] = self._fresh(len(cells))
        literals = layer[cells]
        clauses = [literals[None, :], *self._at_most_one(literals)]
        if position:
            clauses += self._moves(self._at[-1], layer)
            clauses += self._moves(layer, self._at[-1])
        clauses += self._no_return(cells, literals)
        ending = int(self._fresh(1)[0])
        clauses.append(np.array([[-ending, *layer[useful & self._target].tolist()]]))
        self._at.append(layer)
        self._at_target.append(ending)
        return clauses

    def decode(self, true: NDArray[np.bool_], changes: int) -> tuple[int, ...]:
        """The path c_0 .. c_m of a model; ``true[v]`` tells whether variable v holds."""
        path: list[int] = []
        for layer in self._at[: changes + 1]:
            cells = np.flatnonzero(layer)
            (chosen,) = cells[true[layer[cells]]].tolist()
            path.append(chosen)
        return tuple(path)

    def excluding(self, cells: Sequence[int]) -> list[int] | None:
        """The clause against starting with these cells (all laid out); None if none can."""
        literals = [-self.variable(cell, position) for position, cell in enumerate(cells)]
        return None if 0 in literals else literals

    def _fresh(self, count: int) -> Ints:
        numbers = np.arange(self._last + 1, self._last + 1 + count, dtype=np.int64)
        self._last += count
        return numbers

    def _at_most_one(self, literals: Ints) -> list[Ints]:
        """A ladder l_i ("one of the first i + 1"): x_i -> l_i -> l_{i+1}, x_{i+1} -> not l_i."""
        if len(literals) < 2:
            return []
        ladder = self._fresh(len(literals) - 1)
        return [
            np.column_stack([-literals[:-1], ladder]),
            np.column_stack([-ladder[:-1], ladder[1:]]),
            np.column_stack([-literals[1:], -ladder]),
        ]

    def _moves(self, here: Ints, there: Ints) -> list[Ints]:
        """A cell at one position has a neighbour at the next (or previous) one."""
        keep = (here[self._tails] > 0) & (there[self._heads] > 0)
        tails, following = self._tails[keep], there[self._heads[keep]]
        cells = np.flatnonzero(here)
        degree = np.bincount(tails, minlength=self._cells)
        clauses: list[Ints] = []
        for length in np.unique(degree[cells]).tolist():
            chosen = cells[degree[cells] == length]
            body = following[degree[tails] == length].reshape(len(chosen), length)
            clauses.append(np.column_stack([-here[chosen], body]))
        return clauses

    def _no_return(self, cells: Ints, literals: Ints) -> list[Ints]:
        """``seen`` grows: x -> seen', seen -> seen', and x -> not seen."""
        before = self._seen
        after = before.copy()
        after[cells] = self._fresh(len(cells))
        known = before[cells] > 0
        self._seen = after
        return [
            np.column_stack([-literals, after[cells]]),
            np.column_stack([-before[cells][known], after[cells][known]]),
            np.column_stack([-literals[known], -before[cells][known]]),
        ]
