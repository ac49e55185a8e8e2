"""The initial motions if a task constrains the whole body: collision-free ones first.

Half-planes between bodies and obstacles are chosen about the seed, so a seed that passes an
obstacle on the wrong side fails.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from compiler.arrays import Array
from solvers.trajectory.corridor import Corridor, Flags, Layers
from solvers.trajectory.inverse_kinematics import Pool, apart, poses_in
from solvers.trajectory.monotone_cubic import monotone_cubic
from solvers.trajectory.path_timing import Entries

TOUCHING = -0.02
"""A seed counts as clear down to this, in units of length: programs repair the rest."""
WAYS = 2
"""The number of motions taken from a roadmap."""
HOPELESS = 2
"""The number of colliding seeds kept if none is clear."""


def body_seeds(
    corridor: Corridor, tracked: list[Array], entries: Entries, count: int, seed: int
) -> list[Array]:
    """Initial motions (k + 1, n), the most promising first, at most ``count`` that are clear.

    ``tracked`` are motions that try to follow the path of the effector, at least one.  Those that
    succeed and are clear are kept.  If there are none, and for redundant arms, a roadmap is
    searched.  If that finds nothing either, those that collide least are kept.
    """
    clearances = [float(np.min(corridor.clearance.of(corridor.positions(q)))) for q in tracked]
    follow = [corridor.follows(q) for q in tracked]
    order = sorted(range(len(tracked)), key=lambda i: (not follow[i], -clearances[i]))
    most = TOUCHING * corridor.unit
    clear = [tracked[i] for i in order if follow[i] and clearances[i] > most][:count]
    wanted = min(count - len(clear), WAYS)
    redundant = corridor.numeric.n > corridor.numeric.d
    if wanted and (redundant or not clear):
        clear += roadmap_motions(corridor, tracked[0], entries, wanted, seed)
    return clear or [tracked[i] for i in order[:HOPELESS]]


def roadmap_motions(
    corridor: Corridor, like: Array, entries: Entries, count: int, seed: int
) -> list[Array]:
    """Motions (k + 1, n) along ways of a roadmap, the shortest way first.

    ``like`` is a motion with as many samples; its first pose is kept if the start is given.
    """
    first = like[0] if corridor.start_is_given else None
    paths = joint_paths(corridor, first, count, seed)
    return [timed(corridor, path, entries, len(like) - 1) for path in paths]


# --------------------------------------------------------------------------------------------------
# A roadmap of collision-free poses along a cell path, searched lazily for ways in joint space.
#
# Nodes are poses with the effector in a cell of the path and the body clear; edges lead to near
# nodes in the same cell and in the next one.  The shortest way is sought, its edges are checked and
# removed if not passable, until a way remains.  All this only provides seeds.
#
# Sources: Kavraki, Svestka, Latombe & Overmars, *Probabilistic Roadmaps for Path Planning in
# High-Dimensional Configuration Spaces*; Bohlin & Kavraki, *Path Planning Using Lazy PRM*.


NODES = 32
"""The number of poses sought in each cell."""
DRAWN = 3
"""Poses with the effector in a cell that are checked for each one kept."""
THOROUGH = 4
"""The factor by which this grows if none is clear."""
NEAREST = 10
"""Neighbours of a node in each of the two cells."""
SEARCHES = 30
"""The number of ways that are checked."""
NARROW = 0.02
"""Edges count up to twice as long if clearances are below about this share of the extent."""
ROUNDS = 2
"""Roadmaps made for redundant arms, each with more poses, until there is a way."""


@dataclass(frozen=True, slots=True, eq=False)
class JointPath:
    """Poses (w, n) joined by straight ways in coordinates, and the place on the path of each."""

    q: Array
    layers: Layers


def joint_paths(corridor: Corridor, first: Array | None, count: int, seed: int) -> list[JointPath]:
    """At most ``count`` ways with different last poses, the shortest first; empty if none is found.

    ``first`` (n,) is the only start pose, or None for any.
    """
    rng = np.random.default_rng(seed)
    redundant = corridor.numeric.n > corridor.numeric.d
    for number in range(1, ROUNDS + 1 if redundant else 2):
        roadmap = _roadmap(corridor, first, number * NODES, rng)
        if roadmap is None:
            return []
        found = roadmap.ways(count)
        if found:
            return found
    return []


def _roadmap(
    corridor: Corridor, first: Array | None, count: int, rng: np.random.Generator
) -> Roadmap | None:
    """A roadmap with nodes in every cell; None if a cell has none."""
    drawn = corridor.drawn(rng)
    # The ends come first because they are narrow.
    places = sorted(range(len(corridor.cells)), key=lambda i: min(i, len(corridor.cells) - 1 - i))
    nodes: dict[int, Array] = {}
    for place in places:
        if place == 0 and first is not None:
            q = first[None, :]
            q = q[corridor.clear(q)]
        else:
            q = _clear_poses(corridor, drawn, place, DRAWN * count, rng)
        if not len(q):
            return None
        nodes[place] = q[_spread(q * corridor.levers, count)]
    parts = [nodes[place] for place in range(len(corridor.cells))]
    layers = np.repeat(np.arange(len(parts)), [len(part) for part in parts])
    return Roadmap(corridor, np.concatenate(parts), layers)


def _clear_poses(
    corridor: Corridor, drawn: Pool, place: int, count: int, rng: np.random.Generator
) -> Array:
    """The clear ones of ``count`` poses in a cell; of more poses, if none of them is clear."""
    q = np.zeros((0, corridor.numeric.n))
    for more in (1, THOROUGH):
        q = poses_in(
            corridor.numeric, corridor.theta, drawn, corridor.box, corridor.point,
            corridor.cells[place], more * count, rng,
        )  # fmt: skip
        q = q[corridor.clear(q)] if len(q) else q
        if len(q):
            break
    return q


def _spread(points: Array, count: int) -> list[int]:
    """At most ``count`` of the points (K, n), far from each other, beginning with the first one.

    Source: Gonzalez, *Clustering to Minimize the Maximum Intercluster Distance*.
    """
    if len(points) <= count:
        return list(range(len(points)))
    chosen = [0]
    nearest = np.linalg.norm(points - points[0], axis=1)
    while len(chosen) < count:
        chosen.append(int(np.argmax(nearest)))
        nearest = np.minimum(nearest, np.linalg.norm(points - points[chosen[-1]], axis=1))
    return chosen


@dataclass(slots=True, eq=False)
class Roadmap:
    """Nodes (N, n) with their places on the path, and the edges not known to be impassable."""

    corridor: Corridor
    q: Array
    layers: Layers
    _lengths: Array = field(init=False)
    _known: Flags = field(init=False)

    def __post_init__(self) -> None:
        scaled = self.q * self.corridor.levers
        distance = np.linalg.norm(scaled[:, None, :] - scaled[None, :, :], axis=2)
        near = NARROW * self.corridor.extent
        clearance = self.corridor.clearance.of(self.corridor.positions(self.q))
        narrow = near / (near + np.maximum(clearance, 0.0))
        distance = distance * (1 + np.maximum(narrow[:, None], narrow[None, :]))
        self._lengths = np.full(distance.shape, np.inf)
        self._known = np.zeros(distance.shape, dtype=bool)
        for ahead in (0, 1):
            fits = self.layers[None, :] - self.layers[:, None] == ahead
            np.fill_diagonal(fits, val=False)
            ranked = np.where(fits, distance, np.inf)
            order = np.argsort(ranked, axis=1, kind="stable")[:, :NEAREST]
            rows = np.repeat(np.arange(len(self.q)), order.shape[1])
            columns = order.ravel()
            rows, columns = (item[fits[rows, columns]] for item in (rows, columns))
            self._lengths[rows, columns] = distance[rows, columns]

    def ways(self, count: int) -> list[JointPath]:
        """At most ``count`` ways with different last poses."""
        last = np.flatnonzero(self.layers == self.layers[-1])
        found: list[JointPath] = []
        for _ in range(SEARCHES):
            if not len(last) or len(found) == count:
                break
            way = self._shortest(last)
            if way is None:
                break
            if not self._passable(way):
                continue
            found.append(self._shortened(way))
            far = [apart(self.corridor.numeric, self.q[i], self.q[way[-1]]) for i in last]
            last = last[np.array(far)]
        return found

    def _shortest(self, last: Layers) -> Layers | None:
        """The nodes of the shortest way to one of the nodes ``last``, by edges not ruled out."""
        # Imported here because it takes a tenth of the time of a short run.
        from scipy.sparse import csr_matrix
        from scipy.sparse.csgraph import dijkstra

        finite = np.isfinite(self._lengths)
        # A zero entry would mean that there is no edge.
        weights = np.where(finite, np.maximum(self._lengths, 1e-12), 0.0)
        starts = np.flatnonzero(self.layers == 0)
        distance, before, _ = dijkstra(
            csr_matrix(weights), indices=starts, return_predecessors=True, min_only=True
        )
        end = int(last[np.argmin(distance[last])])
        if not np.isfinite(distance[end]):
            return None
        way = [end]
        while before[way[-1]] >= 0:
            way.append(int(before[way[-1]]))
        return np.array(way[::-1])

    def _passable(self, way: Layers) -> bool:
        """Check the edges of a way, and those around it if one of them is not passable."""
        starts, ends = way[:-1], way[1:]
        self._look(starts, ends)
        if bool(np.all(np.isfinite(self._lengths[starts, ends]))):
            return True
        near = np.zeros_like(self._known)
        near[way], near[:, way] = True, True
        self._look(*np.nonzero(near & np.isfinite(self._lengths)))
        return False

    def _look(self, starts: Layers, ends: Layers) -> None:
        """Check edges and remove those that are not passable."""
        new = ~self._known[starts, ends]
        starts, ends = starts[new], ends[new]
        if not len(starts):
            return
        good = self.corridor.passable(
            self.q[starts], self.q[ends], self.layers[starts], self.layers[ends]
        )
        self._known[starts, ends] = True
        self._lengths[starts[~good], ends[~good]] = np.inf
        # Within a cell edges are undirected.
        same = self.layers[starts] == self.layers[ends]
        self._known[ends[same], starts[same]] = True
        self._lengths[ends[same & ~good], starts[same & ~good]] = np.inf

    def _shortened(self, way: Layers) -> JointPath:
        """The way without the nodes that straight ways can skip."""
        kept, at = [int(way[0])], 0
        while at < len(way) - 1:
            ahead = np.arange(len(way) - 1, at, -1)
            here = np.full(len(ahead), way[at])
            good = self.corridor.passable(
                self.q[here], self.q[way[ahead]], self.layers[here], self.layers[way[ahead]]
            )
            good[-1] = True
            at = int(ahead[np.argmax(good)])
            kept.append(int(way[at]))
        return JointPath(self.q[kept], self.layers[kept])


# --------------------------------------------------------------------------------------------------
# The timing of a way in joint space: smooth, from rest to rest, with given entries.


DENSE = 400
"""The number of poses on a way that are checked to find when cells are entered."""
ROUNDED = 0.06
"""Corners are rounded over this share of the time."""


def timed(corridor: Corridor, path: JointPath, entries: Entries, steps: int) -> Array:
    """Coordinates (steps + 1, n) along a way that enter the cells at given samples.

    A monotone cubic in time through the gates, half a step before each entry.  Corners are rounded
    if the body stays clear.
    """
    ways = np.linalg.norm(np.diff(path.q, axis=0) * corridor.levers, axis=1)
    along = np.concatenate([[0.0], np.cumsum(ways)])
    if along[-1] <= 0:
        return np.tile(path.q[0], (steps + 1, 1))
    dense = np.linspace(0.0, along[-1], DENSE)
    gates = dense[_gates(corridor, _at(path, along, dense))]
    times = np.array([0.0, *(entry - 0.5 for entry in entries[1:]), float(steps)])
    values = np.array([0.0, *gates, along[-1]])
    curve = monotone_cubic(times, values, np.arange(steps + 1.0))
    q = _at(path, along, np.clip(curve, 0.0, along[-1]))
    rounded = _rounded(q, steps)
    clear = corridor.clearance.of(corridor.positions(rounded)).min()
    return rounded if clear >= min(0.0, corridor.clearance.of(corridor.positions(q)).min()) else q


def _at(path: JointPath, along: Array, places: Array) -> Array:
    """Coordinates at lengths along a way."""
    # Coinciding nodes are dropped: interpolation needs increasing lengths.
    kept = np.concatenate([[True], np.diff(along) > 0])
    columns = [np.interp(places, along[kept], column) for column in path.q[kept].T]
    return np.stack(columns, axis=1)


def _gates(corridor: Corridor, q: Array) -> list[int]:
    """The first of dense poses (s, n) that belongs to each cell after the first one."""
    beyond = corridor.beyond(corridor.positions(q))
    gates, at = [], 0
    for cell in range(1, beyond.shape[1]):
        nearer = np.flatnonzero(beyond[at:, cell] <= beyond[at:, cell - 1])
        at = at + int(nearer[0]) if len(nearer) else len(q) - 1
        gates.append(at)
    return gates


def _rounded(q: Array, steps: int) -> Array:
    """Moving averages over the samples; both ends stay, by point reflection of the motion there."""
    half = max(1, round(ROUNDED * steps / 2))
    if len(q) <= 2 * half:
        return q
    before, after = 2 * q[0] - q[half:0:-1], 2 * q[-1] - q[-2 : -half - 2 : -1]
    padded = np.concatenate([before, q, after])
    kernel = np.hanning(2 * half + 3)[1:-1]
    columns = [np.convolve(column, kernel / kernel.sum(), mode="valid") for column in padded.T]
    return np.stack(columns, axis=1)
