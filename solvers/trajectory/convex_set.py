"""Polytopes in floats, with the data that separating planes need."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from functools import cached_property, lru_cache
from itertools import combinations

import numpy as np

from compiler.arrays import Array
from compiler.workspaces.polytope import Polytope, polytope_of
from grammar_lang import ir

FAR = Fraction(1000)
"""Metres at which an unbounded polytope is cut off."""
ON_FACET = 1e-9
"""Metres up to which a vertex lies on a facet."""
PARALLEL = 1e-9


@dataclass(frozen=True)
class ConvexSet:
    """A polytope in floats: unit normals (m, d); offsets (m,) and vertices (w, d), in metres."""

    normals: Array
    offsets: Array
    vertices: Array

    @cached_property
    def box(self) -> tuple[Array, Array]:
        """The least and greatest coordinates of the vertices, (d,) each."""
        return self.vertices.min(axis=0), self.vertices.max(axis=0)

    @cached_property
    def edge_directions(self) -> Array:
        """Unit directions (e, 3) of the edges in space, parallel ones once; none in the plane.

        Two vertices on two common facets are taken to span an edge; extra directions do no harm.
        """
        found: list[Array] = []
        if self.vertices.shape[1] == 2:
            return np.array(found).reshape(-1, 3)
        on = np.abs(self.vertices @ self.normals.T - self.offsets) <= ON_FACET
        for i, j in combinations(range(len(self.vertices)), 2):
            direction = self.vertices[j] - self.vertices[i]
            length = float(np.linalg.norm(direction))
            if np.count_nonzero(on[i] & on[j]) < 2 or length <= ON_FACET:
                continue
            direction = direction / length
            if all(np.linalg.norm(np.cross(direction, other)) > PARALLEL for other in found):
                found.append(direction)
        return np.array(found).reshape(-1, 3)


def point_set(place: Array) -> ConvexSet:
    """The set of one point (d,), in metres."""
    normals = np.concatenate([np.eye(len(place)), -np.eye(len(place))])
    return ConvexSet(normals, normals @ place, place[None])


@lru_cache(maxsize=4096)
def region_set(shape: ir.RegionShape, dimension: int) -> ConvexSet:
    """The region's set in floats, cached because searches request the same ones repeatedly."""
    return convex_set(polytope_of(shape, dimension))


def convex_set(polytope: Polytope) -> ConvexSet:
    """A polytope in floats; an unbounded one is cut off far away."""
    if not polytope.is_bounded:
        d = polytope.dimension
        rows = [
            ir.HalfSpace(tuple(Fraction(sign * (i == j)) for j in range(d)), FAR)
            for i in range(d)
            for sign in (-1, 1)
        ]
        polytope = polytope.intersection(Polytope(tuple(rows)))
    vertices = np.array([[float(x) for x in vertex] for vertex in polytope.vertices])
    return ConvexSet(polytope.A, polytope.b, vertices)
