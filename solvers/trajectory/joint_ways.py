"""Collision-free ways in joint space, found by two trees that grow towards each other.

Many samples are processed at once: poses are drawn in batches, and all new edges of a batch are
checked in one evaluation.  All this only provides seeds.

Source: Kuffner & LaValle, *RRT-Connect: An Efficient Approach to Single-Query Path Planning*.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array
from compiler.discretisation.batched_function import MOST_IN_BATCH
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.time_limits.time_limit import check_time
from solvers.trajectory.body_clearance import BodyClearance

SPACING = 0.02
"""The distance that any point moves between two checked poses, relative to the robot's extent."""
REACH = 0.2
"""The distance that any point moves along a new edge of a tree, relative to the extent."""
BATCH = 32
"""The number of poses drawn at once."""
BATCHES = 60
"""The number of batches after which the search for a way is given up."""
FEW = 16
"""One in this many poses on a way is checked first."""
SHORTCUTS = 40
"""The number of pairs of places on a way between which a straight way is tried."""

Flags = NDArray[np.bool_]
Indices = NDArray[np.int64]


def positions_of(numeric: NumericRobot, q: Array, theta: Array) -> Array:
    """The positions of the points in poses (K, n) with parameters (p,), (K, m, d), in metres."""
    # Fill whole blocks, because every batch size has a compiled program of its own.
    filled = np.concatenate([q, np.repeat(q[-1:], -len(q) % MOST_IN_BATCH, axis=0)])
    found: Array = numeric.positions(filled, theta)[: len(q)]
    return found


def straight_ways(
    starts: Array, ends: Array, counts: Indices, good: Callable[[Array, Indices], Flags]
) -> Flags:
    """Whether the straight ways between poses (E, n) are good, shape (E,).

    ``counts`` (E,) poses are checked on each way, at least two.  ``good`` takes poses and the index
    of the way of each, and returns which are good.  A few are checked first, because most bad ways
    are recognised by these.
    """
    edge = np.repeat(np.arange(len(starts)), counts)
    place = np.arange(len(edge)) - np.repeat(np.cumsum(counts) - counts, counts)
    found = np.ones(len(starts), dtype=np.bool_)
    early = place % FEW == FEW // 2
    for chosen in (early, ~early):
        rows = np.flatnonzero(chosen & found[edge])
        if len(rows):
            of = edge[rows]
            share = place[rows] / (counts[of] - 1)  # 0 to 1 along every way
            q = starts[of] + share[:, None] * (ends - starts)[of]
            found[of[~good(q, of)]] = False
    return found


def looked_at(ways: Array, spacing: float) -> Indices:
    """The number of poses checked on ways of these lengths (E,) in metres, both ends included."""
    found: Indices = np.maximum(2, np.ceil(ways / spacing).astype(np.int64) + 1)
    return found


@dataclass(frozen=True, slots=True, eq=False)
class ClearSpace:
    """The collision-free poses of a robot with parameters ``theta`` (p,).

    ``box`` bounds the coordinates, (n,) each, and poses are drawn from it.  ``levers`` (n,) are the
    most metres that a coordinate moves any point per unit; ``extent`` (m) is the robot's size.
    ``clear`` is the clearance (m) from which a pose counts as clear.
    """

    numeric: NumericRobot
    theta: Array
    clearance: BodyClearance
    box: tuple[Array, Array]
    levers: Array
    extent: float
    clear: float

    def clearances(self, q: Array) -> Array:
        """The clearance (K,) of poses (K, n), in metres."""
        return self.clearance.of(positions_of(self.numeric, q, self.theta))

    def are_clear(self, q: Array) -> Flags:
        """Whether poses (K, n) are clear, (K,)."""
        return self.clearance.exceeds(positions_of(self.numeric, q, self.theta), self.clear)

    def passable(self, starts: Array, ends: Array) -> Flags:
        """Whether the straight ways between poses (E, n) are clear, shape (E,)."""
        counts = looked_at(np.abs(ends - starts) @ self.levers, SPACING * self.extent)
        return straight_ways(starts, ends, counts, lambda q, _edge: self.are_clear(q))

    def lengths(self, moves: Array) -> Array:
        """The lengths (...) of moves (..., n), in metres, by the most that points move."""
        return np.asarray(np.linalg.norm(moves * self.levers, axis=-1))


@dataclass(slots=True)
class _Tree:
    """Poses, each with the index of the one from which it was reached; -1 at the root."""

    q: list[Array]
    before: list[int] = field(default_factory=lambda: [-1])

    def nearest(self, space: ClearSpace, to: Array) -> Array:
        """The indices (K,) of the poses in the tree nearest to poses (K, n)."""
        nodes = np.array(self.q)
        found: Array = np.argmin(space.lengths(nodes[None] - to[:, None]), axis=1)
        return found

    def way(self, number: int) -> list[Array]:
        """The poses from the root to a given one."""
        found = [self.q[number]]
        while (number := self.before[number]) >= 0:
            found.append(self.q[number])
        return found[::-1]


def joint_way(space: ClearSpace, start: Array, end: Array, seed: int) -> Array | None:
    """Poses (w, n) from ``start`` to ``end``, with clear straight ways between them.

    None if none is found.
    """
    if space.passable(start[None], end[None])[0]:
        return np.array([start, end])
    rng = np.random.default_rng(seed)
    trees = _Tree([start]), _Tree([end])
    for number in range(BATCHES):
        check_time()
        grown, other = trees[number % 2], trees[1 - number % 2]
        new = _grow(space, grown, rng.uniform(*space.box, size=(BATCH, space.numeric.n)))
        if not len(new):
            continue
        tips = np.array([grown.q[i] for i in new])
        near = other.nearest(space, tips)
        met = np.flatnonzero(space.passable(tips, np.array([other.q[i] for i in near])))
        if len(met):
            way = grown.way(new[met[0]]) + other.way(int(near[met[0]]))[::-1]
            whole = np.array(way if number % 2 == 0 else way[::-1])
            return _shortened(space, whole, rng)
    return None


def _grow(space: ClearSpace, tree: _Tree, towards: Array) -> list[int]:
    """Extend a tree towards poses (K, n); return the indices of the clear new poses."""
    near = tree.nearest(space, towards)
    starts = np.array([tree.q[i] for i in near])
    moves = towards - starts
    far = np.maximum(space.lengths(moves) / (REACH * space.extent), 1.0)
    ends = starts + moves / far[:, None]
    added = []
    for i in np.flatnonzero(space.passable(starts, ends)):
        added.append(len(tree.q))
        tree.q.append(ends[i])
        tree.before.append(int(near[i]))
    return added


def _shortened(space: ClearSpace, way: Array, rng: np.random.Generator) -> Array:
    """The way, with straight shortcuts where these are clear."""
    for _ in range(SHORTCUTS):
        if len(way) < 3:
            break
        lengths = space.lengths(np.diff(way, axis=0))
        along = np.concatenate([[0.0], np.cumsum(lengths)])
        first, last = np.sort(rng.uniform(0.0, along[-1], 2))
        columns = [np.interp((first, last), along, column) for column in way.T]
        cut = np.stack(columns, axis=1)
        if np.searchsorted(along, first) == np.searchsorted(along, last):
            continue
        if space.passable(cut[:1], cut[1:])[0]:
            way = np.concatenate([way[along < first], cut, way[along > last]])
    return way
