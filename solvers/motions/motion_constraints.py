"""What binds the positions of a robot that follows a cell path: dwells and separations.

The cells of the path, the bounds, every ``avoid``, and what a formula asks of which samples.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.robots.robot import RobotModel
from compiler.tasks.word_formula import Obligation
from compiler.workspaces.abstraction import Abstraction
from compiler.workspaces.polytope import polytope_of
from grammar_lang import ir
from solvers.motions.avoidances import Avoidances, convex_set
from solvers.motions.path_timing import Entries
from solvers.motions.position_rows import ConvexSet, Dwell, Separation

CELL_SHARE = 0.25
"""The part of the margin that samples keep from the facets between cells of the path."""
ON_FACET = 1e-9
"""Metres, and cosines of angles, up to which two facets are one."""


@dataclass(frozen=True, slots=True)
class MotionConstraints:
    """A robot in a task; ``effector`` follows ``cells``, ``recorded`` starts and reaches."""

    numeric: NumericRobot
    workspace: ir.Workspace
    task: ir.Task
    abstraction: Abstraction
    effector: int
    recorded: int
    cells: tuple[int, ...]

    @property
    def model(self) -> RobotModel:
        """The robot."""
        return self.numeric.graph.model

    @property
    def avoidances(self) -> Avoidances:
        """What binds positions all the time."""
        return Avoidances(self.numeric, self.workspace, self.task)

    @property
    def start_effector(self) -> int:
        """The effector that starts in the start region."""
        start = self.task.start
        named = start.effector if isinstance(start, ir.StartIn) else None
        return self.recorded if named is None else named - 1

    @property
    def starts_in_its_cell(self) -> bool:
        """Whether the task asks where the effector of the path starts."""
        own = self.start_effector == self.effector
        return own and isinstance(self.task.start, ir.StartIn)

    def dwells(
        self, entries: Entries | None, obligations: Sequence[Obligation]
    ) -> tuple[Dwell, ...]:
        """Where points stay; without ``entries`` only the two ends of the path bind to cells."""
        k = self.task.steps
        last = convex_set(self.abstraction.cells[self.cells[-1]].polytope)
        found = [Dwell(self.effector, k, k, last)]
        if self.starts_in_its_cell:
            first = convex_set(self.abstraction.cells[self.cells[0]].polytope)
            found.insert(0, _planned_start(self.effector, first))
        if entries is not None:
            ends = [*(entry - 1 for entry in entries[1:]), k]
            path = zip(self.cells, entries, ends, strict=True)
            found += [self._stay(cell, first, last) for cell, first, last in path]
        found += self._within_bounds(with_own=entries is None)
        found += self._ends()
        found += [
            Dwell(item.effector, item.first, item.last, self._set(item.region))
            for item in obligations
            if item.inside
        ]
        return tuple(found)

    def _stay(self, cell: int, first: int, last: int) -> Dwell:
        """A stay in a cell of the path, near enough to the facets that it is entered through.

        Only samples of the planned motion lie in cells, for the proof; the bounds hold all the
        time, and of disturbed motions.
        """
        region = convex_set(self.abstraction.cells[cell].polytope)
        bounds = convex_set(polytope_of(self.workspace.bounds.shape, self.workspace.dimension))
        alike = region.normals @ bounds.normals.T > 1 - ON_FACET
        level = np.abs(region.offsets[:, None] - bounds.offsets) < ON_FACET
        bounding = np.any(alike & level, axis=1)
        shares = np.where(bounding, 1.0, CELL_SHARE)
        return Dwell(self.effector, first, last, region, shares, bounding.astype(float))

    def _within_bounds(self, *, with_own: bool) -> Iterator[Dwell]:
        """Effectors, and bodies where the task says so, stay inside the bounds."""
        k, count = self.task.steps, len(self.model.effectors)
        bounds = self.avoidances.bounds
        for effector in range(count):
            if with_own or effector != self.effector:
                yield Dwell(effector, 0, k, bounds)
        yield from self.avoidances.bodies_within_bounds(k)

    def _ends(self) -> Iterator[Dwell]:
        """Start and target of effectors that follow no path of their own."""
        k, start, reach = self.task.steps, self.task.start, self.task.reach
        if isinstance(start, ir.StartIn) and self.start_effector != self.effector:
            yield _planned_start(self.start_effector, self._set(start.region))
        if reach is not None and self.recorded != self.effector:
            yield Dwell(self.recorded, k, k, self._set(reach.region))

    def separations(self, obligations: Sequence[Obligation]) -> tuple[Separation, ...]:
        """What points and bodies stay away from."""
        found = list(self.avoidances.separations())
        found += [
            Separation((item.effector,), self._set(item.region), 0.0, item.first, item.last)
            for item in obligations
            if not item.inside
        ]
        return tuple(found)

    def _set(self, name: str) -> ConvexSet:
        return self.avoidances.region(name)


def _planned_start(effector: int, region: ConvexSet) -> Dwell:
    """Where the planned motion starts; disturbed ones may start beside it."""
    return Dwell(effector, 0, 0, region, spreads=np.zeros(len(region.offsets)))
