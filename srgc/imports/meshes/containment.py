"""Whether triangles lie in a union of convex pieces: decided exactly.

A triangle lies in a convex piece if and only if its corners do.  Doubles with a bound of their
rounding settle most of them.  A triangle that no single piece holds is cut up at the planes of one
piece after another; first with places of cuts that are short fractions and doubles that are sure of
themselves, then in integers, which always decide.

Nothing here knows how the pieces were found.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import NamedTuple, TypeAlias

import numpy as np

from srgc.imports.meshes.convex_piece import ROUNDING, ConvexPiece, Plane
from srgc.imports.meshes.mesh import Bools, Floats, Ints

Point: TypeAlias = tuple[Fraction, Fraction, Fraction]
Polygon: TypeAlias = list[Point]
Weights: TypeAlias = tuple[int, int, int]


@dataclass(frozen=True, slots=True)
class Uncovered:
    """A triangle that is not in the union of the pieces, and convex polygons of it that are not.

    Together with the pieces they cover the triangle.
    """

    triangle: int
    polygons: tuple[tuple[Point, ...], ...]


def uncovered(
    vertices: Floats, triangles: Ints, pieces: Sequence[ConvexPiece]
) -> tuple[Uncovered, ...]:
    """The triangles that are not in the union of the pieces, in their order; none: all are.

    Args:
        vertices: (n, 3) in metres, finite; each double is the rational that it is.
        triangles: (m, 3) of their numbers; they may be segments or points.
        pieces: closed convex polytopes.
    """
    heights = [_Heights(piece) for piece in pieces]
    single = np.zeros(len(triangles), dtype=bool)
    for each in heights:
        near = np.flatnonzero(~single)
        single[near] = each.surely_hold(vertices)[triangles[near]].all(axis=1)
    boxes = np.array([(each.lower, each.upper) for each in heights]).reshape(-1, 2, 3)
    missing = list[Uncovered]()
    for number in np.flatnonzero(~single).tolist():
        corners = vertices[triangles[number]]
        lower, upper = corners.min(axis=0), corners.max(axis=0)
        near = np.flatnonzero(((lower <= boxes[:, 1]) & (upper >= boxes[:, 0])).all(axis=1))
        crossings = [each for i in near.tolist() if (each := heights[i].crossing(corners))]
        if crossings and _surely_covered(crossings):
            continue
        left = [polygon_of(corners)]
        for crossing in crossings:
            left = _beyond_all(left, crossing.planes, crossing.unit)
        if left:
            missing.append(Uncovered(number, tuple(map(tuple, left))))
    return tuple(missing)


def surely_inside(points: Floats, piece: ConvexPiece) -> Bools:
    """Whether doubles are sure of each of the points (n, 3) that the piece holds it."""
    return _Heights(piece).surely_hold(points)


# --- In doubles, with a bound of their rounding ---------------------------------------------------


class _Crossing(NamedTuple):
    """The planes of a piece that a triangle may be beyond, with the heights of its corners (3, f).

    It is surely within all others.
    """

    planes: tuple[Plane, ...]
    unit: Fraction
    heights: Floats
    doubt: Floats


class _Heights:
    """How far points are beyond the planes of a piece, in doubles, and how sure that is."""

    def __init__(self, piece: ConvexPiece) -> None:
        self.piece = piece
        self.scale = 10.0**piece.digits
        planes = np.array(piece.planes, dtype=object)
        self.origin = np.array([float(x) for x in piece.corners[0]])
        # The offset from a corner, in integers: heights near zero are not differences of large ones.
        local = planes[:, 3] - planes[:, :3] @ np.array(piece.corners[0], dtype=object)
        self.normals = planes[:, :3].astype(np.float64)
        self.offsets = local.astype(np.float64)
        self.weights = np.abs(self.normals).sum(axis=1)
        points = np.array(piece.corners, dtype=np.float64) / self.scale
        slack = 1e-9 * np.abs(points).max() + 1e-300
        self.lower, self.upper = points.min(axis=0) - slack, points.max(axis=0) + slack

    def of(self, points: Floats) -> tuple[Floats, Floats]:
        """Heights (n, f) of points (n, 3) over the planes, and bounds of their errors."""
        scaled = points * self.scale
        local = scaled - self.origin
        size = (np.abs(scaled) + np.abs(self.origin)).max(axis=1, initial=0.0) + 1.0
        found = local @ self.normals.T - self.offsets
        return found, ROUNDING * (size[:, None] * self.weights + np.abs(self.offsets))

    def surely_hold(self, points: Floats) -> Bools:
        """Whether each of the points (n, 3) is surely in the piece."""
        held: Bools = ((points >= self.lower) & (points <= self.upper)).all(axis=1)
        near = np.flatnonzero(held)
        found, doubt = self.of(points[near])
        held[near] = (found <= -doubt).all(axis=1)
        return held

    def crossing(self, corners: Floats) -> _Crossing | None:
        """How a triangle (3, 3) meets the piece; None where it is surely beyond one plane."""
        found, doubts = self.of(corners)
        doubt = doubts.max(axis=0) + ROUNDING * np.abs(found).max(axis=0)
        if (found > doubt).all(axis=0).any():
            return None
        crossed = np.flatnonzero((found > -doubt).any(axis=0))
        planes = tuple(self.piece.planes[i] for i in crossed.tolist())
        unit = Fraction(1, 10**self.piece.digits)
        return _Crossing(planes, unit, found[:, crossed], doubt[crossed])


MOST_PARTS = 64
STEPS = 1 << 24
"""Edges are cut at multiples of one part in so many."""


def _surely_covered(crossings: Sequence[_Crossing]) -> bool:
    """Whether pieces are found in doubles that cover a triangle; False says nothing.

    The parts are polygons whose corners are exact means of those of the triangle, so they cover it
    whatever the doubles are; a part counts as covered where all its corners are surely in a piece.
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
    """What is left of a polygon beyond planes, given heights (3, f) of the triangle's corners."""
    left = list[list[Weights]]()
    for column in range(heights.shape[1]):
        over = _over(part, heights[:, column])
        bound = float(doubt[column])
        if all(value <= -bound for value in over):
            continue
        if all(value > -2 * bound for value in over):
            return [*left, part]
        inner, outer = _split(part, over, -2 * bound)
        left.append(outer)
        if not all(value <= -bound for value in _over(inner, heights[:, column])):
            return [*left, inner]
        part = inner
    return left


def _over(part: list[Weights], heights: Floats) -> list[float]:
    a, b, c = heights.tolist()
    return [x / (x + y + z) * a + y / (x + y + z) * b + z / (x + y + z) * c for x, y, z in part]


def _split(
    part: list[Weights], over: list[float], level: float
) -> tuple[list[Weights], list[Weights]]:
    """The polygon below a level and the one above it, with the same corners between them."""
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
    """The point so many of :data:`STEPS` from one to the other."""
    first, second = (STEPS - steps) * sum(other), steps * sum(one)
    x, y, z = (first * a + second * b for a, b in zip(one, other, strict=True))
    return x, y, z


# --- Exactly --------------------------------------------------------------------------------------


def polygon_of(corners: Floats) -> Polygon:
    """Points of doubles (k, 3) as they are."""
    return [(Fraction(x), Fraction(y), Fraction(z)) for x, y, z in corners.tolist()]


def beyond(polygons: list[Polygon], pieces: Sequence[ConvexPiece]) -> list[Polygon]:
    """Convex polygons that, with the pieces, cover the given ones; empty if these are covered.

    No polygon that is given back lies in a piece; segments and points are polygons, too.
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
