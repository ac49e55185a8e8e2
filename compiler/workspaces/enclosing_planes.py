"""Half-spaces of fixed directions that touch a set of points and contain all of it.

There are 26 directions, to the neighbours of a cube's middle, and 16 in the plane.  Boxes along the
axes are enclosed tightly, round bodies with a small margin.  Decision 110 gives the reasons.
"""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction
from itertools import product
from operator import mul

from compiler.workspaces.hull import Point
from compiler.workspaces.round_set import unit_normals
from grammar_lang.ir import HalfSpace

FEW = 32
"""The most points that are used as corners of a piece directly."""
NEAR = 1e-9
"""The relative error that floats may make in the farthest point in a direction."""


def enclosing_rows(points: Sequence[Point], dimension: int) -> tuple[HalfSpace, ...]:
    """The half-spaces across the fixed directions whose planes touch points (v, d)."""
    floats = [tuple(map(float, point)) for point in points]
    size = max(abs(x) for point in floats for x in point) or 1.0
    rows = []
    for normal in _directions(dimension):
        turned = tuple(map(float, normal))
        along = [sum(map(mul, turned, point)) for point in floats]
        least = max(along) - NEAR * size * sum(map(abs, turned))
        near = (point for point, value in zip(points, along, strict=True) if value >= least)
        rows.append(HalfSpace(normal, max(_dot(normal, point) for point in near)))
    return tuple(rows)


def _directions(dimension: int) -> tuple[Point, ...]:
    if dimension == 2:
        return unit_normals(2)
    places = product((-1, 0, 1), repeat=3)
    return tuple(tuple(map(Fraction, place)) for place in places if any(place))


def _dot(one: Point, other: Point) -> Fraction:
    return sum((a * b for a, b in zip(one, other, strict=True)), Fraction(0))
