"""Exact area and volume of convex polytopes given by vertices and facets.

Source: Bueler, Enge & Fukuda, *Exact volume computation for polytopes* (2000), section 3:
triangulation by boundary facets, as pyramids from one vertex.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from fractions import Fraction
from itertools import pairwise
from math import lcm
from typing import TypeAlias

from compiler.geometry.double_description import Point

Lattice: TypeAlias = tuple[int, ...]


def on_lattice(points: Sequence[Point]) -> tuple[list[Lattice], int]:
    """The points times their least common denominator, and that denominator.

    Integers are compared and multiplied several times as fast as fractions.
    """
    scale = lcm(*(x.denominator for point in points for x in point))
    return [tuple(x.numerator * (scale // x.denominator) for x in p) for p in points], scale


def _turn(a: Lattice, b: Lattice, c: Lattice) -> int:
    """Twice the signed area of the triangle a, b, c of the plane."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def counter_clockwise(points: Iterable[Point]) -> tuple[Point, ...]:
    """The corners of the hull of points of the plane, from the lexicographically least one on."""
    given = tuple(points)
    lattice, _ = on_lattice(given)
    original = dict(zip(lattice, given, strict=True))
    return tuple(original[point] for point in _hull(lattice))


def _hull(points: Iterable[Lattice]) -> list[Lattice]:
    ordered = sorted(points)
    if len(ordered) < 3:
        return ordered
    return [*_chain(ordered)[:-1], *_chain(ordered[::-1])[:-1]]


def _chain(points: Sequence[Lattice]) -> list[Lattice]:
    """One half of Andrew's monotone chain."""
    chain: list[Lattice] = []
    for point in points:
        while len(chain) >= 2 and _turn(chain[-2], chain[-1], point) <= 0:
            chain.pop()
        chain.append(point)
    return chain


def around(corners: Sequence[Point]) -> tuple[Point, ...]:
    """The corners of a facet in order: the ends of a segment, or round a polygon of space."""
    if len(corners[0]) == 2:
        return tuple(corners)
    for drop in range(3):
        flat = {(*point[:drop], *point[drop + 1 :]): point for point in corners}
        ring = counter_clockwise(flat)
        if len(ring) == len(corners):
            return tuple(flat[corner] for corner in ring)
    raise ValueError("the corners of a facet are those of a convex polygon")


def polygon_area(corners: Sequence[Point]) -> Fraction:
    """The area of a convex polygon of the plane, its corners in counter-clockwise order.

    Zero of fewer than three corners.
    """
    if len(corners) < 3:
        return Fraction(0)
    lattice, scale = on_lattice(corners)
    fan = sum(_turn(lattice[0], b, c) for b, c in pairwise(lattice[1:]))
    return Fraction(fan, 2 * scale * scale)


def polyhedron_volume(facets: Sequence[tuple[Point, Sequence[Point]]]) -> Fraction:
    """The volume of a convex polyhedron of space.

    Args:
        facets: each facet once, as its normal (3,) and its corners in any order.
    """
    lattice, scale = on_lattice([point for _, corners in facets for point in corners])
    taken = iter(lattice)
    faces = [(normal, [next(taken) for _ in corners]) for normal, corners in facets]
    apex = min(lattice)
    total = 0
    for normal, corners in faces:
        if apex in corners:
            continue
        drop = next(axis for axis, entry in enumerate(normal) if entry)
        flat = {(*point[:drop], *point[drop + 1 :]): point for point in corners}
        ring = [flat[corner] for corner in _hull(flat)]
        for b, c in pairwise(ring[1:]):
            total += abs(_determinant(apex, ring[0], b, c))
    return Fraction(total, 6 * scale**3)


def _determinant(o: Lattice, a: Lattice, b: Lattice, c: Lattice) -> int:
    (ax, ay, az), (bx, by, bz), (cx, cy, cz) = (
        tuple(p - q for p, q in zip(point, o, strict=True)) for point in (a, b, c)
    )
    return ax * (by * cz - bz * cy) - ay * (bx * cz - bz * cx) + az * (bx * cy - by * cx)
