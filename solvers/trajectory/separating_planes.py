"""The best half-planes between sets of points and convex obstacles, many at once.

Candidates are the obstacle's facets; in the plane also the lines through two of the points, in
space the planes through three of them and those parallel to one edge of either set.  The sets are
disjoint iff one of these separates them (separating axis theorem).  Directions from corners to
points make the best gap the distance if two corners are nearest.  If an obstacle is a single point,
or there are many points, the direction between the nearest points of both is used, if they are
apart.

Rows are the last axis of arrays and coordinates the first, so that every operation acts on long
vectors.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.hull_distance import nearest_to_zero
from solvers.trajectory.convex_set import ConvexSet
from solvers.trajectory.subproblem import Indices

SHORTEST = 1e-9
"""Metres, or products of them: anything shorter has no direction."""
MOST_POINTS = 8
"""For more points the nearest pair is used, as candidates grow with the cube of their number."""
MOST_DIFFERENCES = 1 << 17
"""The most differences of points and vertices in a block."""
MOST_ROWS = 256
"""The most rows in a block, so that the candidates stay in the processor's cache."""


@dataclass(frozen=True)
class Obstacles:
    """Convex sets with equal numbers of facets, vertices and edge directions."""

    sets: tuple[ConvexSet, ...]

    @staticmethod
    def kind(of: ConvexSet) -> tuple[int, ...]:
        """The numbers that sets in one collection must have in common."""
        return len(of.normals), len(of.vertices), len(of.edge_directions)

    @cached_property
    def facets(self) -> Array:
        """Unit normals, (d, facets, sets)."""
        return _rows_last([each.normals for each in self.sets])

    @cached_property
    def vertices(self) -> Array:
        """Vertices in metres, (d, vertices, sets)."""
        return _rows_last([each.vertices for each in self.sets])

    @cached_property
    def facet_supports(self) -> Array:
        """The support in the directions of the facets, (facets, sets)."""
        return np.asarray(_heights(self.facets, self.vertices).max(axis=0))

    @cached_property
    def edges(self) -> Array:
        """Directions of edges, (3, edges, sets)."""
        return _rows_last([each.edge_directions for each in self.sets])


def facet_planes(swept: Array, obstacles: Obstacles, which: Indices) -> tuple[Array, Array, Array]:
    """The best of the facets, as in ``separating_planes``, and its distance, (k,) in m."""
    points = np.ascontiguousarray(swept.transpose(2, 1, 0))
    facets, support = obstacles.facets[:, :, which], obstacles.facet_supports[:, which]
    gaps = _heights(facets, points).min(axis=0) - support
    best, row = np.argmax(gaps, axis=0), np.arange(len(swept))
    return np.ascontiguousarray(facets[:, best, row].T), support[best, row], gaps[best, row]


def separating_planes(
    swept: Array, obstacles: Obstacles, which: Indices | None = None
) -> tuple[Array, Array]:
    """The best half-plane between each set of points and an obstacle.

    Args:
        swept: the points, (k, w, d).
        obstacles: the obstacles.
        which: the index of the obstacle for each set of points, (k,); None if there is only one.

    Returns:
        Unit normals (k, d) that point away from the obstacle, and the obstacle's support (k,) in
            those directions.
    """
    k, _, d = swept.shape
    if obstacles.vertices.shape[1] == 1 or swept.shape[1] > MOST_POINTS:
        return _between_nearest(swept, obstacles, which)
    normal, support = np.empty((k, d)), np.empty(k)
    points = np.ascontiguousarray(swept.transpose(2, 1, 0))
    for start in range(0, k, MOST_ROWS):
        part = slice(start, start + MOST_ROWS)
        arrays = obstacles.facets, obstacles.vertices, obstacles.edges
        if which is not None:
            facets, vertices, edges = (each[:, :, which[part]] for each in arrays)
        else:
            facets, vertices, edges = arrays
        normal[part], support[part] = _best(points[:, :, part], facets, vertices, edges)
    return normal, support


def _between_nearest(
    swept: Array, obstacles: Obstacles, which: Indices | None
) -> tuple[Array, Array]:
    """The half-planes perpendicular to the lines between the nearest points of sets and obstacles.

    If a pair intersects, the best of other candidates is taken: of all if there are few points,
    else of the facets and the direction between the centres.
    """
    k, width, d = swept.shape
    sets = np.zeros(k, dtype=int) if which is None else which
    normal, gap = np.empty((k, d)), np.empty(k)
    size = max(1, MOST_DIFFERENCES // (width * obstacles.vertices.shape[1]))
    for start in range(0, k, size):
        part = slice(start, start + size)
        vertices = obstacles.vertices[:, :, sets[part]].transpose(2, 1, 0)
        apart = swept[part, :, None] - vertices[:, None]
        away = nearest_to_zero(apart.reshape(len(apart), -1, d))
        gap[part] = np.linalg.norm(away, axis=1)
        normal[part] = away / np.maximum(gap[part], SHORTEST)[:, None]
    meeting = np.flatnonzero(gap <= SHORTEST)
    for start in range(0, len(meeting), MOST_ROWS):
        rows = meeting[start : start + MOST_ROWS]
        points = np.ascontiguousarray(swept[rows].transpose(2, 1, 0))
        facets, vertices, edges = (
            each[:, :, sets[rows]]
            for each in (obstacles.facets, obstacles.vertices, obstacles.edges)
        )
        if width <= MOST_POINTS:
            normal[rows], _ = _best(points, facets, vertices, edges)
            continue
        across = points.mean(axis=1, keepdims=True) - vertices.mean(axis=1, keepdims=True)
        candidates = np.concatenate([facets, _unit(across, facets[:, :1])], axis=1)
        depths = _heights(candidates, points).min(axis=0) - _heights(candidates, vertices).max(
            axis=0
        )
        normal[rows] = candidates[:, np.argmax(depths, axis=0), np.arange(len(rows))].T
    support = np.einsum("kd,dvk->vk", normal, obstacles.vertices[:, :, sets]).max(axis=0)
    return normal, support


def _best(points: Array, facets: Array, vertices: Array, edges: Array) -> tuple[Array, Array]:
    """The best half-plane of each of k rows, (k, d) and (k,)."""
    d, width, k = points.shape
    pairs = list(combinations(range(width), 2))
    edge = points[:, [j for _, j in pairs]] - points[:, [i for i, _ in pairs]]
    fallback = facets[:, :1]
    across = _unit(_planar(edge) if d == 2 else _spatial(edge, points, edges), fallback)
    away = points[:, :, None] - np.broadcast_to(vertices, (d, vertices.shape[1], k))[:, None]
    away = _unit(away.reshape(d, -1, k), fallback)
    facets = np.broadcast_to(facets, (d, facets.shape[1], k))
    candidates = np.concatenate([facets, across, -across, away], axis=1)
    # Supports and fronts of -across follow from those of across.
    ours, theirs = _heights(across, points), _heights(across, vertices)
    others = np.concatenate([facets, away], axis=1)
    nearest = _heights(others, points).min(axis=0)
    support = _heights(others, vertices).max(axis=0)
    count = facets.shape[1]
    supports = np.concatenate(
        [support[:count], theirs.max(axis=0), -theirs.min(axis=0), support[count:]]
    )
    fronts = np.concatenate([nearest[:count], ours.min(axis=0), -ours.max(axis=0), nearest[count:]])
    best, row = np.argmax(fronts - supports, axis=0), np.arange(k)
    return candidates[:, best, row].T, supports[best, row]


def _heights(normals: Array, points: Array) -> Array:
    """Normals . points, (w, c, k), for (d, c, k) and (d, w, k)."""
    found: Array = normals[0] * points[0, :, None]
    for axis in range(1, len(normals)):
        found += normals[axis] * points[axis, :, None]
    return found


def _unit(vectors: Array, fallback: Array) -> Array:
    """Vectors (d, c, k) scaled to length 1; too short ones become the ``fallback``, (d, 1, k)."""
    length = np.sqrt(np.sum(vectors**2, axis=0))
    return np.where(length > SHORTEST, vectors / np.maximum(length, SHORTEST / 1000), fallback)


def _planar(edge: Array) -> Array:
    """Normals (2, c, k) of the lines through two of the points."""
    return np.stack([-edge[1], edge[0]])


def _spatial(edge: Array, points: Array, edges: Array) -> Array:
    """Normals (3, c, k): products of two edges, and of the planes through three of the points."""
    k, width = points.shape[2], points.shape[1]
    count = edge.shape[1] * edges.shape[1]
    crossed = _cross(edge[:, :, None], edges[:, None]).reshape(3, count, k)
    first, second, third = ([each[i] for each in combinations(range(width), 3)] for i in range(3))
    sides = points[:, second] - points[:, first], points[:, third] - points[:, first]
    return np.concatenate([crossed, _cross(*sides)], axis=1)


def _cross(a: Array, b: Array) -> Array:
    """Cross products along the first axis."""
    return np.stack(
        [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
    )


def _rows_last(arrays: Sequence[Array]) -> Array:
    return np.ascontiguousarray(np.stack(arrays).transpose(2, 1, 0))
