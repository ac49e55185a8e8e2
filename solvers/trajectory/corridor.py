"""The constraints on a motion along a cell path: on its poses, and on positions of its points."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array
from compiler.discretisation.batched_function import MOST_IN_BATCH
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.robots.robot import RobotModel
from compiler.tasks.word_formula import Obligation
from compiler.workspaces.abstraction import Abstraction
from grammar_lang import ir
from solvers.trajectory.body_clearance import Avoidances, BodyClearance
from solvers.trajectory.convex_set import ConvexSet, convex_set, region_set
from solvers.trajectory.inverse_kinematics import Pool, pool
from solvers.trajectory.joint_ways import looked_at, positions_of, straight_ways
from solvers.trajectory.path_timing import Entries
from solvers.trajectory.pose_dwells import pose_dwells
from solvers.trajectory.position_plan import Dwell, Separation
from solvers.trajectory.task_limits import final_samples
from solvers.trajectory.task_size import length_unit

# --------------------------------------------------------------------------------------------------
# The constraints on a robot's poses on a cell path: the effector's cells, and a clear body.


STRAY = 0.02
"""The allowed distance of the effector from its cells, relative to their extent."""
SPACING = 0.02
"""The distance that any point moves between two checked poses, relative to the extent."""

Flags = NDArray[np.bool_]
Layers = NDArray[np.int64]
"""Places on the path, from 0."""


@dataclass(frozen=True)
class Corridor:
    """A robot with parameters ``theta`` whose ``point`` moves through ``cells`` in order.

    ``box`` bounds the coordinates, (n,) each; ``margin`` is the required clearance, in metres.
    ``unit`` is the unit of length (m).  With ``start_is_given`` there is a single start pose.
    """

    numeric: NumericRobot
    theta: Array
    point: int
    cells: tuple[ConvexSet, ...]
    clearance: BodyClearance
    box: tuple[Array, Array]
    margin: float
    start_is_given: bool = False
    unit: float = 1.0

    @cached_property
    def extent(self) -> float:
        """The diagonal of the box about the cells, in metres."""
        corners = np.concatenate([cell.vertices for cell in self.cells])
        return float(np.linalg.norm(np.ptp(corners, axis=0)))

    def drawn(self, rng: np.random.Generator) -> Pool:
        """Random poses of the robot."""
        reach = max(float(np.max(np.abs(cell.vertices))) for cell in self.cells)
        return pool(self.numeric, self.theta, self.box, reach, rng)

    @cached_property
    def levers(self) -> Array:
        """The most metres that each coordinate moves any point per unit, (n,), in random poses."""
        drawn = self.drawn(np.random.default_rng(0))
        found: Array = np.full(self.numeric.n, 1e-6)
        for start in range(0, len(drawn.q), MOST_IN_BATCH):
            q = drawn.q[start : start + MOST_IN_BATCH]
            moved = np.linalg.norm(self.numeric.points(q, self.theta).by_q, axis=2)
            found = np.maximum(found, np.max(moved, axis=(0, 1)))
        return found

    def positions(self, q: Array) -> Array:
        """The positions of the points in poses (K, n), shape (K, m, d)."""
        return positions_of(self.numeric, q, self.theta)

    def clear(self, q: Array) -> Flags:
        """Whether the body is clear in poses (K, n)."""
        return self.clearance.exceeds(self.positions(q), self.margin)

    def beyond(self, positions: Array) -> Array:
        """The distance (m) by which the point leaves each cell, negative inside, (K, cells)."""
        at = positions[:, self.point]
        columns = [np.max(at @ cell.normals.T - cell.offsets, axis=1) for cell in self.cells]
        return np.stack(columns, axis=1)

    def follows(self, q: Array) -> bool:
        """Whether the point moves along the cells in poses (K, n), from the first to the last."""
        beyond = self.beyond(self.positions(q))
        ends = [beyond[-1, -1]] if self.start_is_given else [beyond[0, 0], beyond[-1, -1]]
        return bool(max(*ends, np.max(np.min(beyond, axis=1))) <= STRAY * self.extent)

    def kept(self, q: Array, first: Layers, last: Layers) -> Flags:
        """Whether poses (K, n) are clear, with the point in a cell from ``first`` to ``last``."""
        positions = self.positions(q)
        numbers = np.arange(len(self.cells))
        others = (numbers < first[:, None]) | (numbers > last[:, None])
        astray = np.where(others, np.inf, self.beyond(positions)).min(axis=1)
        near: Flags = astray <= STRAY * self.extent
        near[near] = self.clearance.exceeds(positions[near], self.margin)
        return near

    def passable(self, starts: Array, ends: Array, first: Layers, last: Layers) -> Flags:
        """Whether the straight ways in coordinates between poses (E, n) are allowed, shape (E,)."""
        counts = looked_at(np.abs(ends - starts) @ self.levers, SPACING * self.extent)
        return straight_ways(
            starts, ends, counts, lambda q, edge: self.kept(q, first[edge], last[edge])
        )


# --- Constraints on the positions of a robot that follows a cell path: dwells and separations -----
#
# They come from the cells of the path, the bounds, every ``avoid``, and formulas at some samples.


CELL_SHARE = 0.25
"""The share of the margin that samples keep from the facets between cells of the path."""
ON_FACET = 1e-9
"""Two facets are equal up to this, in metres and in cosines of angles."""


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
        """The constraints on positions that hold at all times."""
        return Avoidances(self.numeric, self.workspace, self.task)

    @property
    def start_effector(self) -> int:
        """The effector that starts in the start region."""
        start = self.task.start
        named = start.effector if isinstance(start, ir.StartIn) else None
        return self.recorded if named is None else named - 1

    @property
    def starts_in_its_cell(self) -> bool:
        """Whether the task says where the effector of the path starts."""
        own = self.start_effector == self.effector
        return own and isinstance(self.task.start, ir.StartIn)

    @property
    def ends_in_its_cell(self) -> bool:
        """Whether the task says where the effector of the path ends, other than by formulas."""
        return self.task.reach is not None and self.recorded == self.effector

    def dwells(
        self, entries: Entries | None, obligations: Sequence[Obligation], *, closed: bool = False
    ) -> tuple[Dwell, ...]:
        """The dwells of points.

        Without ``entries`` only the ends of the path that the task fixes bind to cells.  A path
        that is ``closed`` ends in its last cell.
        """
        k = self.task.steps
        found = list[Dwell]()
        if closed or self.ends_in_its_cell:
            last = convex_set(self.abstraction.cells[self.cells[-1]].polytope)
            found.append(Dwell(self.effector, k, k, last))
        if self.starts_in_its_cell:
            first = convex_set(self.abstraction.cells[self.cells[0]].polytope)
            found.insert(0, _planned_start(self.effector, first))
        if entries is not None:
            ends = [*(entry - 1 for entry in entries[1:]), k]
            path = zip(self.cells, entries, ends, strict=True)
            found += [self._stay(cell, first, last) for cell, first, last in path]
        found += self._within_bounds(with_own=entries is None)
        found += self._ends(self.effector)
        for item in obligations:
            if item.inside:
                found.append(Dwell(item.effector, item.first, item.last, self._set(item.region)))
                samples = item.first, item.last
                found += self._turned(item.poses, item.effector, samples, away=item.away)
        return tuple(found)

    def relaxed(self, visits: Mapping[int, int]) -> tuple[Dwell, ...]:
        """The dwells with the effector in cells at single samples, by places on the path.

        Instead of the cells at the ends of the path, the regions named in the task bind.
        """
        found = [self._stay(self.cells[place], at, at) for place, at in visits.items()]
        return (*found, *self._within_bounds(with_own=True), *self._ends(None))

    def _stay(self, cell: int, first: int, last: int) -> Dwell:
        """A stay in a cell of the path, with a smaller margin at the facets between cells.

        Only samples of the planned motion must lie in cells, for the proof.  The bounds hold at all
        times, also for disturbed motions.
        """
        region = convex_set(self.abstraction.cells[cell].polytope)
        bounds = region_set(self.workspace.bounds.shape, self.workspace.dimension)
        alike = region.normals @ bounds.normals.T > 1 - ON_FACET
        level = np.abs(region.offsets[:, None] - bounds.offsets) < ON_FACET
        bounding = np.any(alike & level, axis=1)
        shares = np.where(bounding, 1.0, CELL_SHARE)
        return Dwell(self.effector, first, last, region, shares, bounding.astype(float))

    def _within_bounds(self, *, with_own: bool) -> Iterator[Dwell]:
        """Effectors, and bodies if the task says so, stay inside the bounds."""
        k, count = self.task.steps, len(self.model.effectors)
        bounds = self.avoidances.bounds
        for effector in range(count):
            if with_own or effector != self.effector:
                yield Dwell(effector, 0, k, bounds)
        yield from self.avoidances.bodies_within_bounds(k)

    def _ends(self, but: int | None) -> Iterator[Dwell]:
        """Start and target of effectors, ``but`` not of the one bound by cells; and final poses."""
        k, start, reach = self.task.steps, self.task.start, self.task.reach
        if isinstance(start, ir.StartIn) and self.start_effector != but:
            yield _planned_start(self.start_effector, self._set(start.region))
        if reach is None:
            return
        if self.recorded != but:
            yield Dwell(self.recorded, k, k, self._set(reach.region))
        yield from self._turned(reach.poses, self.recorded, (k + 1 - final_samples(self.task), k))

    def _turned(
        self,
        poses: Sequence[ir.Pose],
        effector: int,
        samples: tuple[int, int],
        *,
        away: bool = False,
    ) -> Iterator[Dwell]:
        """Between two samples an effector's frame is in some poses, or away from them."""
        unit = length_unit(self.workspace)
        for pose in poses:
            yield from pose_dwells(self.numeric, pose, unit, effector, samples, away=away)

    def separations(self, obligations: Sequence[Obligation]) -> tuple[Separation, ...]:
        """The sets that points and bodies stay away from."""
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
    """The dwell at the start of the planned motion; disturbed motions may start next to it."""
    return Dwell(effector, 0, 0, region, spreads=np.zeros(len(region.offsets)))
