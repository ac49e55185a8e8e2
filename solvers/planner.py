"""P.Planning: paths through the cells by SAT, fewest region changes first.

Source: Algorithm 1 and Section 4.2 (Problem 3).  A path is a sequence of cells, no cell twice,
each adjacent to the next; when each is entered is decided by the control synthesis.  Paths that
a counterexample refutes are blocked by their prefix, together with the reason.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np

from compiler.encodings.specification import path_problem
from compiler.encodings.unroll import CellGraph, Unrolling
from compiler.geometry.abstraction import Abstraction
from grammar_lang.ir import StartAt, Task
from solvers.sat import SatSolver
from solvers.verdict import Fails, Holds, Unknown

CONFLICTS = 200_000


@dataclass(frozen=True, slots=True)
class CellPath:
    """The indices of the cells in the order they are entered, each once."""

    cells: tuple[int, ...]

    @property
    def changes(self) -> int:
        """The number of region changes."""
        return len(self.cells) - 1


@dataclass(frozen=True, slots=True)
class BlockedPrefix:
    """Every path that begins with these cells is excluded, and why."""

    cells: tuple[int, ...]
    reason: str


@dataclass(frozen=True, slots=True)
class Exhausted:
    """Proved, by graph distance and by the SAT solver: no path is left.

    ``changes`` is the bound up to which this is so; ``complete`` tells that longer simple paths do
    not exist, so that the bound was no restriction.  The prefixes blocked and the number of paths
    given out before are what the claim rests on: with none of either, start and target are apart.
    """

    changes: int
    complete: bool
    paths: int
    blocked: tuple[BlockedPrefix, ...]


PathVerdict: TypeAlias = Holds[CellPath] | Fails[Exhausted] | Unknown


class Planner:
    """Enumerates the simple paths from start to target cells in order of their length."""

    def __init__(
        self,
        graph: CellGraph,
        start: Iterable[int],
        target: Iterable[int],
        forbidden: Iterable[int],
        max_changes: int,
        *,
        conflicts: int = CONFLICTS,
    ) -> None:
        """Prepare the search; nothing is solved yet.

        Args:
            graph: an abstraction, or anything with ``neighbours``.
            start: cells a path may begin in.
            target: cells a path may end in (passing through them is allowed).
            forbidden: cells no path may enter; they win over start and target.
            max_changes: the largest number of region changes, at least 0.
            conflicts: the budget of each call of the SAT solver.

        Raises:
            ValueError: ``max_changes`` is negative.
        """
        if max_changes < 0:
            raise ValueError("the number of region changes is at least 0")
        self._cells = len(graph.neighbours)
        self._unrolling = Unrolling(graph, start, target, forbidden, max_changes)
        self._max_changes = max_changes
        self._conflicts = conflicts
        self._solver = SatSolver()
        self._changes = self._unrolling.shortest
        self._paths = 0
        self._blocked: list[BlockedPrefix] = []
        self._pending: list[tuple[int, ...]] = []

    @property
    def blocked(self) -> tuple[BlockedPrefix, ...]:
        """The blocked prefixes, in the order they were blocked."""
        return tuple(self._blocked)

    @property
    def complete(self) -> bool:
        """Whether the bound on region changes excludes no path."""
        return self._unrolling.complete

    def next_path(self) -> PathVerdict:
        """The next path, never one given before; or the proof that none is left.

        ``Unknown`` leaves everything as it was: another call goes on with the same bound.
        """
        while self._changes is not None and self._changes <= self._unrolling.limit:
            self._lay_out(self._changes)
            ending = self._unrolling.at_target(self._changes)
            match self._solver.solve([ending], conflicts=self._conflicts):
                case Holds(witness=model):
                    path = self._unrolling.decode(model.true, self._changes)
                    self._exclude(path, ending)
                    self._paths += 1
                    return Holds(CellPath(path))
                case Fails():
                    self._changes += 1
                case Unknown() as unknown:
                    return unknown
        return Fails(
            Exhausted(
                self._max_changes, self._unrolling.complete, self._paths, tuple(self._blocked)
            )
        )

    def block_prefix(self, cells: Sequence[int], reason: str) -> None:
        """Exclude every path that begins with these cells, the path itself included.

        Raises:
            ValueError: no cell, or an index that is none.
        """
        prefix = tuple(cells)
        if not prefix or not all(0 <= cell < self._cells for cell in prefix):
            raise ValueError(f"no prefix of cells: {prefix}")
        self._blocked.append(BlockedPrefix(prefix, reason))
        if len(prefix) <= self._unrolling.positions:
            self._exclude(prefix)
        else:
            self._pending.append(prefix)

    def _lay_out(self, position: int) -> None:
        while self._unrolling.positions <= position:
            for clauses in self._unrolling.extend():
                self._solver.add(clauses)
            ready = self._unrolling.positions
            for prefix in [p for p in self._pending if len(p) <= ready]:
                self._exclude(prefix)
            self._pending = [p for p in self._pending if len(p) > ready]

    def _exclude(self, prefix: Sequence[int], ending: int | None = None) -> None:
        """No path begins so; with ``ending``, only where it also ends there."""
        clause = self._unrolling.excluding(prefix)
        if clause is not None:
            literals = clause if ending is None else [*clause, -ending]
            self._solver.add(np.array([literals], dtype=np.int64))


def path_planner(
    abstraction: Abstraction, task: Task, start_cells: Sequence[int] | None = None
) -> Planner:
    """The planner of an effector in a task.

    ``start_cells`` replaces the cells of the start region, where they depend on the robot; for a
    start pose without them every cell is a start.
    """
    if start_cells is None and isinstance(task.start, StartAt):
        start_cells = range(len(abstraction.cells))
    problem = path_problem(abstraction, task, start_cells)
    start = problem.start if start_cells is None else tuple(start_cells)
    changes = min(task.steps, len(abstraction.cells))
    return Planner(abstraction, start, problem.target, problem.forbidden, changes)
