"""Exact area and volume of convex polytopes given by vertices and facets.

Source: Bueler, Enge & Fukuda, *Exact volume computation for polytopes* (2000), section 3:
triangulation by boundary facets, as pyramids from one vertex.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from itertools import pairwise

from compiler.geometry.double_description import Point


def _turn(a: Point, b: Point, c: Point) -> Fraction:
    """Twice the signed area of the triangle a, b, c of the plane."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def counter_clockwise(points: Iterable[Point]) -> tuple[Point, ...]:
    """The corners of the hull of points of the plane, from the lexicographically least one on."""
    ordered = sorted(points)
    if len(ordered) < 3:
        return tuple(ordered)
    lower, upper = _chain(ordered), _chain(ordered[::-1])
    return (*lower[:-1], *upper[:-1])


def _chain(points: Sequence[Point]) -> list[Point]:
    """One half of Andrew's monotone chain."""
    chain: list[Point] = []
    for point in points:
        while len(chain) >= 2 and _turn(chain[-2], chain[-1], point) <= 0:
            chain.pop()
        chain.append(point)
    return chain


def polygon_area(corners: Sequence[Point]) -> Fraction:
    """The area of a convex polygon of the plane, its corners in counter-clockwise order."""
    fan = (_turn(corners[0], b, c) for b, c in pairwise(corners[1:]))
    return sum(fan, Fraction(0)) / 2


def polyhedron_volume(facets: Sequence[tuple[Point, Sequence[Point]]]) -> Fraction:
    """The volume of a convex polyhedron of space.

    Args:
        facets: each facet once, as its normal (3,) and its corners in any order.
    """
    apex = min(point for _, corners in facets for point in corners)
    total = Fraction(0)
    for normal, corners in facets:
        if apex in corners:
            continue
        drop = next(axis for axis, entry in enumerate(normal) if entry)
        flat = {(*point[:drop], *point[drop + 1 :]): point for point in corners}
        ring = [flat[corner] for corner in counter_clockwise(flat)]
        for b, c in pairwise(ring[1:]):
            total += abs(_determinant(apex, ring[0], b, c))
    return total / 6


def _determinant(o: Point, a: Point, b: Point, c: Point) -> Fraction:
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (
        tuple(p - q for p, q in zip(point, o, strict=True)) for point in (a, b, c)
    )
    return ax * (by * cz - bz * cy) - ay * (bx * cz - bz * cx) + az * (bx * cy - by * cx)
