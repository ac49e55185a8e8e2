"""What a robot's poses have to keep to on a cell path: the effector's cells, and a clear body."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array
from compiler.discretisation.batched_function import MOST_LANES
from compiler.discretisation.numeric_robot import NumericRobot
from solvers.motions.body_clearance import BodyClearance
from solvers.motions.pose_samples import Pool, pool
from solvers.motions.position_rows import ConvexSet

STRAY = 0.02
"""How far from its cells the effector may be, in parts of their extent."""
SPACING = 0.02
"""The way of any point between two poses that are looked at, in the same parts."""

Flags = NDArray[np.bool_]
Layers = NDArray[np.int64]
"""Places on the path, from 0."""


@dataclass(frozen=True)
class Corridor:
    """A robot with parameters ``theta`` whose ``point`` goes through ``cells`` in order.

    ``box`` bounds the coordinates, (n,) each; ``margin`` is the clearance wanted, in metres.
    With ``start_is_given`` there is one pose to start from.
    """

    numeric: NumericRobot
    theta: Array
    point: int
    cells: tuple[ConvexSet, ...]
    clearance: BodyClearance
    box: tuple[Array, Array]
    margin: float
    start_is_given: bool = False

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
        """Metres that a coordinate can move any point per unit, shape (n,), by random poses."""
        drawn = self.drawn(np.random.default_rng(0))
        moved = np.linalg.norm(self.numeric.points(drawn.q, self.theta).by_q, axis=2)
        found: Array = np.maximum(np.max(moved, axis=(0, 1)), 1e-6)
        return found

    def positions(self, q: Array) -> Array:
        """Where the points are in poses (K, n), shape (K, m, d)."""
        # Always as many as fill whole blocks: each number of lanes has a program of its own.
        filled = np.concatenate([q, np.repeat(q[-1:], -len(q) % MOST_LANES, axis=0)])
        found: Array = self.numeric.points(filled, self.theta).value[: len(q)]
        return found

    def clear(self, q: Array) -> Flags:
        """Whether the body is clear in poses (K, n)."""
        return self.clearance.of(self.positions(q), self.margin) >= self.margin

    def beyond(self, positions: Array) -> Array:
        """By how much the point leaves each cell, metres, negative inside, shape (K, cells)."""
        at = positions[:, self.point]
        columns = [np.max(at @ cell.normals.T - cell.offsets, axis=1) for cell in self.cells]
        return np.stack(columns, axis=1)

    def follows(self, q: Array) -> bool:
        """Whether the point goes along the cells in poses (K, n), from the first to the last."""
        beyond = self.beyond(self.positions(q))
        ends = [beyond[-1, -1]] if self.start_is_given else [beyond[0, 0], beyond[-1, -1]]
        return bool(max(*ends, np.max(np.min(beyond, axis=1))) <= STRAY * self.extent)

    def kept(self, q: Array, first: Layers, last: Layers) -> Flags:
        """Whether poses (K, n) are clear, with the point in one of the cells first to last."""
        positions = self.positions(q)
        numbers = np.arange(len(self.cells))
        others = (numbers < first[:, None]) | (numbers > last[:, None])
        astray = np.where(others, np.inf, self.beyond(positions)).min(axis=1)
        near: Flags = astray <= STRAY * self.extent
        near &= self.clearance.of(positions, self.margin) >= self.margin
        return near

    def passable(self, starts: Array, ends: Array, first: Layers, last: Layers) -> Flags:
        """Whether the straight ways in coordinates between poses (E, n) are kept, shape (E,)."""
        ways = np.abs(ends - starts) @ self.levers
        counts = np.maximum(2, np.ceil(ways / (SPACING * self.extent)).astype(int) + 1)
        edge = np.repeat(np.arange(len(starts)), counts)
        # 0 to 1 along every edge.
        offsets = np.repeat(np.cumsum(counts) - counts, counts)
        share = (np.arange(len(edge)) - offsets) / np.repeat(counts - 1, counts)
        q = starts[edge] + share[:, None] * (ends - starts)[edge]
        good = self.kept(q, first[edge], last[edge])
        found: Flags = np.bincount(edge, weights=~good, minlength=len(starts)) == 0
        return found
