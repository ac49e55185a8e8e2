"""Decide exactly whether triangles lie in a union of convex pieces.

A triangle lies in a convex piece if and only if its corners do.  Doubles with a bound on their
rounding settle most triangles.  A triangle that no single piece holds is cut at the planes of one
piece after another: first in doubles, with cuts at short fractions, and if these are not
conclusive, in integers, which always decide.  The check does not depend on how the pieces were
found.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

import numpy as np

from srgc.imports.meshes.convex_piece import ConvexPiece, Plane
from srgc.imports.meshes.exact_places import ExactPlaces, Point
from srgc.imports.meshes.mesh import Bools, Floats, Ints
from srgc.imports.meshes.plane_heights import Crossing, Heights
from srgc.imports.meshes.two_pieces import in_two

Polygon: TypeAlias = list[Point]
Weights: TypeAlias = tuple[int, int, int]


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
        if _surely_covered(crossings):
            continue
        left = [[places.of(corner) for corner in triangles[number].tolist()]]
        for crossing in crossings:
            left = _beyond_all(left, crossing.planes, crossing.unit)
        if left:
            missing.append(Uncovered(number, tuple(map(tuple, left))))
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


# --- In doubles, with a bound on their rounding ---------------------------------------------------


MOST_PARTS = 64
"""With more parts than this, integers decide."""
STEPS = 1 << 24
"""Edges are cut at multiples of their length divided by this."""


def _surely_covered(crossings: Sequence[Crossing]) -> bool:
    """Whether doubles show that the pieces cover a triangle; False is not conclusive.

    The parts are polygons whose corners are exact weighted means of the triangle's corners, so they
    cover it whatever the rounding.  A part is covered if all its corners are in a piece for sure.
    """
    parts: list[list[Weights]] = [[(1, 0, 0), (0, 1, 0), (0, 0, 1)]]
    for _, _, heights, doubt in crossings:
        parts = [left for part in parts for left in _cut(part, heights, doubt)]
        if not parts:
            return True
        if len(parts) > MOST_PARTS:
            return False
    return False


def _cut(part: list[Weights], heights: Floats, doubt: Floats) -> list[list[Weights]]:
    """The parts of a polygon beyond planes, given heights (3, f) of the triangle's corners."""
    left = list[list[Weights]]()
    while True:
        over = _shares(part) @ heights
        outside = (over > -doubt).any(axis=0)
        if not outside.any():
            return left
        if (over > -2 * doubt).all(axis=0).any():
            return [*left, part]
        column = int(outside.argmax())
        part, outer = _split(part, over[:, column].tolist(), -2 * float(doubt[column]))
        left.append(outer)
        if (_shares(part) @ heights[:, column] > -doubt[column]).any():
            return [*left, part]


def _shares(part: list[Weights]) -> Floats:
    """The corners (k, 3) of a polygon in barycentric coordinates of the triangle."""
    return np.array([(x / (w := x + y + z), y / w, z / w) for x, y, z in part])


def _split(
    part: list[Weights], over: list[float], level: float
) -> tuple[list[Weights], list[Weights]]:
    """The parts of a polygon below and above a level, with the same corners between them."""
    inner, outer = list[Weights](), list[Weights]()
    for i, here in enumerate(part):
        following = (i + 1) % len(part)
        below, next_below = over[i] <= level, over[following] <= level
        (inner if below else outer).append(here)
        if below == next_below:
            continue
        one, other = (i, following) if below else (following, i)
        share = (level - over[one]) / (over[other] - over[one])
        steps = min(max(int(share * STEPS), 0), STEPS)
        between = _between(part[one], part[other], steps)
        inner.append(between)
        outer.append(between)
    return inner, outer


def _between(one: Weights, other: Weights, steps: int) -> Weights:
    """The point at ``steps`` of :data:`STEPS` from one to the other."""
    first, second = (STEPS - steps) * sum(other), steps * sum(one)
    x, y, z = (first * a + second * b for a, b in zip(one, other, strict=True))
    return x, y, z


# --- Exactly --------------------------------------------------------------------------------------


def polygon_of(corners: Floats) -> Polygon:
    """The exact polygon of corners in doubles (k, 3)."""
    return [(Fraction(x), Fraction(y), Fraction(z)) for x, y, z in corners.tolist()]


def beyond(polygons: list[Polygon], pieces: Sequence[ConvexPiece]) -> list[Polygon]:
    """Convex polygons that with the pieces cover the given ones; empty if these are covered.

    No returned polygon lies in a piece; segments and points count as polygons.
    """
    for piece in pieces:
        polygons = _beyond_all(polygons, piece.planes, Fraction(1, 10**piece.digits))
        if not polygons:
            return []
    return polygons


def _beyond_all(polygons: list[Polygon], planes: Sequence[Plane], unit: Fraction) -> list[Polygon]:
    return [left for each in polygons for left in _beyond(each, planes, unit)]


def _beyond(polygon: Polygon, planes: Sequence[Plane], unit: Fraction) -> list[Polygon]:
    left = list[Polygon]()
    for a, b, c, d in planes:
        limit = d * unit
        over = [a * x + b * y + c * z - limit for x, y, z in polygon]
        if max(over) <= 0:
            continue
        if min(over) >= 0:
            return [*left, polygon]
        polygon, outer = _halves(polygon, over)
        left.append(outer)
    return left


def _halves(polygon: Polygon, over: list[Fraction]) -> tuple[Polygon, Polygon]:
    inner, outer = list[Point](), list[Point]()
    for i, here in enumerate(polygon):
        following = (i + 1) % len(polygon)
        high, next_high = over[i], over[following]
        if high <= 0:
            inner.append(here)
        if high >= 0:
            outer.append(here)
        if (high < 0 < next_high) or (next_high < 0 < high):
            share = high / (high - next_high)
            x, y, z = (p + share * (q - p) for p, q in zip(here, polygon[following], strict=True))
            inner.append((x, y, z))
            outer.append((x, y, z))
    return inner, outer
