"""Polytopes of points that are close to a polytope: its offset, from inside.

The offset of a set by d is its Minkowski sum with the closed ball of radius d. It is round; the
Minkowski sum with the hull of points of the sphere lies within it and is a polytope, with exact
coordinates if the points are rational.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import permutations, product

from compiler.workspaces.hull import Point, hull_rows
from compiler.workspaces.polytope import Polytope

# With all signs and orders of their coordinates these are 12 points of the unit circle, whose hull
# contains the disc of radius 0.948, and 54 of the unit sphere, with the ball of radius 0.904.
_CORNERS: dict[int, list[Point]] = {
    2: [(Fraction(1), Fraction(0)), (Fraction(3, 5), Fraction(4, 5))],
    3: [
        (Fraction(1), Fraction(0), Fraction(0)),
        (Fraction(3, 5), Fraction(4, 5), Fraction(0)),
        (Fraction(2, 3), Fraction(2, 3), Fraction(1, 3)),
    ],
}


def inner_offset(shape: Polytope, distance: Fraction) -> Polytope:
    """The polytope and points around it, all at most ``distance`` metres from it.

    Args:
        shape: bounded, with an interior.
        distance: at least 0.

    Raises:
        ValueError: the polytope is not bounded.
    """
    if not distance:
        return shape
    moves = [tuple(distance * entry for entry in point) for point in _sphere(shape.dimension)]
    sums = [
        tuple(a + b for a, b in zip(vertex, move, strict=True))
        for vertex in shape.vertices
        for move in moves
    ]
    return Polytope(hull_rows(sums))


def _sphere(dimension: int) -> list[Point]:
    """Points of the unit circle or sphere."""
    found = {
        tuple(sign * entry for sign, entry in zip(signs, order, strict=True))
        for point in _CORNERS[dimension]
        for order in permutations(point)
        for signs in product((-1, 1), repeat=dimension)
    }
    return sorted(found)
