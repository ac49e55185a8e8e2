"""The corners of a convex piece that holds a mesh: what a link with a hull collides as.

A mesh of few vertices is their hull.  Of more, the planes that touch it across the axes, and across
the diagonals of faces and of space (in the plane, of 16 directions) enclose it; their polytope has
few corners, and is larger than the hull of the mesh where this is round.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from functools import lru_cache
from itertools import product
from typing import TypeAlias

from compiler.workspaces.polytope import Polytope
from compiler.workspaces.round_set import unit_normals
from grammar_lang.ir import HalfSpace, Mesh

FEW = 32
"""So many vertices are corners as they are."""
NEAR = 1e-9
"""Relatively, by how much floats may mistake the farthest vertex in a direction."""

Point: TypeAlias = tuple[Fraction, ...]


@lru_cache(maxsize=64)
def mesh_corners(mesh: Mesh, scale: Fraction, dimension: int) -> tuple[Point, ...]:
    """The corners (c, 3) of what holds a mesh, in metres; in the plane of its shadow, at z = 0."""
    points = sorted({vertex[:dimension] for vertex in mesh.vertices})
    if len(points) > FEW:
        points = sorted(_enclosing(points, dimension))
    rest = (Fraction(0),) * (3 - dimension)
    return tuple((*(scale * x for x in point), *rest) for point in points)


def _enclosing(points: Sequence[Point], dimension: int) -> Sequence[Point]:
    """The corners of the polytope whose planes touch points (v, d) across fixed directions."""
    floats = [tuple(map(float, point)) for point in points]
    size = max(abs(x) for point in floats for x in point) or 1.0
    rows = []
    for normal in _directions(dimension):
        along = [sum(float(a) * x for a, x in zip(normal, point, strict=True)) for point in floats]
        least = max(along) - NEAR * size * sum(abs(float(a)) for a in normal)
        near = (point for point, value in zip(points, along, strict=True) if value >= least)
        rows.append(HalfSpace(normal, max(_dot(normal, point) for point in near)))
    return Polytope(tuple(rows)).vertices


def _directions(dimension: int) -> tuple[Point, ...]:
    if dimension == 2:
        return unit_normals(2)
    places = product((-1, 0, 1), repeat=3)
    return tuple(tuple(map(Fraction, place)) for place in places if any(place))


def _dot(one: Point, other: Point) -> Fraction:
    return sum((a * b for a, b in zip(one, other, strict=True)), Fraction(0))
