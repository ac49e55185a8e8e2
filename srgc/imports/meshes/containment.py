"""Decide exactly whether triangles lie in a union of convex pieces.

A triangle lies in a convex piece if and only if its corners do.  Doubles with a bound on their
rounding settle most triangles.  A triangle that neither a single piece nor, for sure, two of them
hold is cut at the planes of one piece after another, in integers, which always decide.  The check
does not depend on how the pieces were found.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import gcd, lcm
from typing import TypeAlias

import numpy as np

from srgc.imports.meshes.convex_piece import ConvexPiece, Plane
from srgc.imports.meshes.exact_places import ExactPlaces, Point
from srgc.imports.meshes.mesh import Bools, Floats, Ints
from srgc.imports.meshes.plane_heights import Crossing, Heights
from srgc.imports.meshes.two_pieces import in_two

Polygon: TypeAlias = list[Point]


@dataclass(frozen=True, slots=True)
class Uncovered:
    """A triangle that is not in the union of the pieces, and convex polygons in it that are not.

    Together with the pieces the polygons cover the triangle.
    """

    triangle: int
    polygons: tuple[tuple[Point, ...], ...]


def uncovered(
    vertices: Floats,
    triangles: Ints,
    pieces: Sequence[ConvexPiece],
    places: ExactPlaces | None = None,
) -> tuple[Uncovered, ...]:
    """The triangles that are not in the union of the pieces, in their order; empty if all are.

    Args:
        vertices: (n, 3) in metres, finite.
        triangles: (m, 3) indices of vertices; a triangle may degenerate to a segment or a point.
        pieces: closed convex polytopes.
        places: the vertices as rationals close to the doubles; if None, the doubles are exact.
    """
    places = ExactPlaces(vertices, binary=True) if places is None else places
    heights = [Heights(piece, places.slack()) for piece in pieces]
    sides = vertices[triangles]
    lower, upper = sides.min(axis=1), sides.max(axis=1)
    across = np.arange(len(triangles))
    for each in heights:
        near = each.around(lower[across], upper[across])
        held = each.hold(vertices, places, triangles[across[near]])
        across = np.delete(across, near[held])
    across = across[~in_two(sides[across], heights)]
    meetings = _meetings(sides[across], heights)
    missing = list[Uncovered]()
    for number, crossings in zip(across.tolist(), meetings, strict=True):
        left = [[_corner(places.of(corner)) for corner in triangles[number].tolist()]]
        for crossing in crossings:
            planes, scale = crossing.planes, crossing.scale
            left = [part for one in left for part in _beyond(one, planes, scale)]
        if left:
            polygons = tuple(tuple(map(_point, polygon)) for polygon in left)
            missing.append(Uncovered(number, polygons))
    return tuple(missing)


def _meetings(sides: Floats, heights: Sequence[Heights]) -> list[list[Crossing]]:
    """For each triangle (n, 3, 3), how it meets the pieces that it may meet, in their order."""
    found: list[list[Crossing]] = [[] for _ in range(len(sides))]
    lower, upper = sides.min(axis=1), sides.max(axis=1)
    for each in heights:
        near = np.flatnonzero(((lower <= each.upper) & (upper >= each.lower)).all(axis=1))
        for number, crossing in each.crossings(near, sides[near]):
            found[number].append(crossing)
    return found


def surely_inside(points: Floats, piece: ConvexPiece) -> Bools:
    """Whether each of the points (n, 3) is in the piece for sure, despite rounding."""
    return Heights(piece).surely_hold(points)


# --- Exactly --------------------------------------------------------------------------------------
#
# Corners are homogeneous integers: the point (x, y, z) / w, w > 0, without a common divisor. They
# are many times faster than rationals, which are reduced at every operation.


Corner: TypeAlias = tuple[int, int, int, int]


def polygon_of(corners: Floats) -> Polygon:
    """The exact polygon of corners in doubles (k, 3)."""
    return [(Fraction(x), Fraction(y), Fraction(z)) for x, y, z in corners.tolist()]


def _corner(point: Point) -> Corner:
    """The homogeneous integers of a point."""
    w = lcm(*(each.denominator for each in point))
    x, y, z = (each.numerator * (w // each.denominator) for each in point)
    return x, y, z, w


def _point(corner: Corner) -> Point:
    """The rationals of homogeneous integers."""
    x, y, z, w = corner
    return Fraction(x, w), Fraction(y, w), Fraction(z, w)


def _beyond(polygon: list[Corner], planes: Sequence[Plane], scale: int) -> list[list[Corner]]:
    """Convex parts of a polygon that with the piece of these planes cover it.

    ``scale`` is 10 to the number of decimals of the piece.  None of the parts lies in the piece;
    segments and points count as polygons.  A polygon that the piece at most touches stays whole.
    """
    left, rest = list[list[Corner]](), polygon
    for a, b, c, d in planes:
        over = [(a * x + b * y + c * z) * scale - d * w for x, y, z, w in rest]
        if max(over) <= 0:
            continue
        if min(over) >= 0:
            return [polygon]
        rest, outer = _halves(rest, over)
        left.append(outer)
    return left


def _halves(polygon: list[Corner], over: list[int]) -> tuple[list[Corner], list[Corner]]:
    """The parts below and above a plane, given heights times the ``w`` of each corner."""
    inner, outer = list[Corner](), list[Corner]()
    for i, here in enumerate(polygon):
        following = (i + 1) % len(polygon)
        high, next_high = over[i], over[following]
        if high <= 0:
            inner.append(here)
        if high >= 0:
            outer.append(here)
        if (high < 0 < next_high) or (next_high < 0 < high):
            between = _on_plane(here, high, polygon[following], next_high)
            inner.append(between)
            outer.append(between)
    return inner, outer


def _on_plane(one: Corner, high: int, other: Corner, next_high: int) -> Corner:
    """Where the segment of two corners on different sides of a plane meets it."""
    x, y, z, w = (high * q - next_high * p for p, q in zip(one, other, strict=True))
    divisor = gcd(x, y, z, w) if w > 0 else -gcd(x, y, z, w)
    return x // divisor, y // divisor, z // divisor, w // divisor
