"""A roadmap of collision-free poses along a cell path, searched lazily for ways in joint space.

Nodes are poses with the effector in a cell of the path and the body clear; edges go to near nodes
in the same cell and in the next one.  The shortest way is searched first, its edges are looked at,
and what is not passable is left out, until a way stands.  Only a source of seeds.

Sources: Kavraki, Svestka, Latombe & Overmars, *Probabilistic Roadmaps for Path Planning in
High-Dimensional Configuration Spaces*; Bohlin & Kavraki, *Path Planning Using Lazy PRM*.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from scipy.sparse import csr_matrix
from scipy.sparse.csgraph import dijkstra

from compiler.arrays import Array
from solvers.motions.corridor import Corridor, Flags, Layers
from solvers.motions.inverse_kinematics import apart
from solvers.motions.pose_samples import Pool, poses_in

NODES = 32
"""Poses that are looked for in each cell."""
DRAWN = 3
"""Poses with the effector in a cell that are looked at for each that is kept."""
THOROUGH = 4
"""How many times more are looked at where none is clear."""
NEAREST = 10
"""Neighbours of a node in each of the two cells."""
SEARCHES = 30
"""Ways that are looked at."""
NARROW = 0.02
"""Edges count up to twice as long where the clearance is small for this part of the extent."""
ROUNDS = 2
"""Roadmaps that are made for redundant arms, each with more poses, until there is a way."""


@dataclass(frozen=True, slots=True, eq=False)
class JointPath:
    """Poses (w, n) that straight ways in coordinates join, and the place on the path of each."""

    q: Array
    layers: Layers


def joint_paths(corridor: Corridor, first: Array | None, count: int, seed: int) -> list[JointPath]:
    """At most ``count`` ways with different last poses, the shortest first; none if none is found.

    ``first`` (n,) is the only pose to start from, None: any.
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
    """A roadmap with nodes in every cell; None where a cell has none."""
    drawn = corridor.drawn(rng)
    # The ends first: they are the narrow ones.
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
    """The clear ones of ``count`` poses in a cell; of more, where none of them is."""
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
    """At most ``count`` of some points (K, n) that are far from each other, the first one first.

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
        room = self.corridor.clearance.of(self.corridor.positions(self.q))
        narrow = near / (near + np.maximum(room, 0.0))
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
        """The nodes of the shortest way to one of the last nodes that is not ruled out."""
        finite = np.isfinite(self._lengths)
        # A zero entry would be no edge at all.
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
        """Look at the edges of a way, and at those about it if one of them is not passable."""
        starts, ends = way[:-1], way[1:]
        self._look(starts, ends)
        if bool(np.all(np.isfinite(self._lengths[starts, ends]))):
            return True
        near = np.zeros_like(self._known)
        near[way], near[:, way] = True, True
        self._look(*np.nonzero(near & np.isfinite(self._lengths)))
        return False

    def _look(self, starts: Layers, ends: Layers) -> None:
        """Look at edges; those that are not passable are left out from now on."""
        new = ~self._known[starts, ends]
        starts, ends = starts[new], ends[new]
        if not len(starts):
            return
        good = self.corridor.passable(
            self.q[starts], self.q[ends], self.layers[starts], self.layers[ends]
        )
        self._known[starts, ends] = True
        self._lengths[starts[~good], ends[~good]] = np.inf
        # Within a cell an edge is one in both directions.
        same = self.layers[starts] == self.layers[ends]
        self._known[ends[same], starts[same]] = True
        self._lengths[ends[same & ~good], starts[same & ~good]] = np.inf

    def _shortened(self, way: Layers) -> JointPath:
        """The way with nodes left out where straight ways pass them by."""
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
