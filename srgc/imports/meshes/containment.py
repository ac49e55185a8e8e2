"""Whether triangles lie in a union of convex pieces: decided exactly.

A triangle lies in a convex piece if and only if its corners do.  Doubles with a bound of their
rounding settle most of them.  A triangle that no single piece holds is cut up at the planes of one
piece after another; first with places of cuts that are short fractions and doubles that are sure of
themselves, then in integers, which always decide.

Nothing here knows how the pieces were found.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import combinations
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
    across = np.flatnonzero(~single)
    meetings = _meetings(vertices[triangles[across]], heights)
    missing = list[Uncovered]()
    for number, crossings in zip(across.tolist(), meetings, strict=True):
        if _surely_in_two(crossings) or _surely_covered(crossings):
            continue
        left = [polygon_of(vertices[triangles[number]])]
        for crossing in crossings:
            left = _beyond_all(left, crossing.planes, crossing.unit)
        if left:
            missing.append(Uncovered(number, tuple(map(tuple, left))))
    return tuple(missing)


def _meetings(sides: Floats, heights: Sequence[_Heights]) -> list[list[_Crossing]]:
    """For each triangle (n, 3, 3) how it meets the pieces that it may meet, in their order."""
    found: list[list[_Crossing]] = [[] for _ in range(len(sides))]
    lower, upper = sides.min(axis=1), sides.max(axis=1)
    for each in heights:
        near = np.flatnonzero(((lower <= each.upper) & (upper >= each.lower)).all(axis=1))
        for number, crossing in each.crossings(near, sides[near]):
            found[number].append(crossing)
    return found


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
        # Offsets from a corner, in integers: heights are no differences of large numbers then.
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

    def crossings(self, numbers: Ints, sides: Floats) -> Iterator[tuple[int, _Crossing]]:
        """How triangles (n, 3, 3) meet the piece, with their numbers; not those surely apart."""
        found, doubts = self.of(sides.reshape(-1, 3))
        found = found.reshape(len(sides), 3, len(self.offsets))
        doubt = doubts.reshape(found.shape).max(axis=1) + ROUNDING * np.abs(found).max(axis=1)
        apart = (found > doubt[:, None]).all(axis=1).any(axis=1)
        crossed = (found > -doubt[:, None]).any(axis=1)
        unit = Fraction(1, 10**self.piece.digits)
        for row in np.flatnonzero(~apart).tolist():
            chosen = np.flatnonzero(crossed[row])
            planes = tuple(self.piece.planes[i] for i in chosen.tolist())
            crossing = _Crossing(planes, unit, found[row][:, chosen], doubt[row][chosen])
            yield int(numbers[row]), crossing


TRIED = 3
"""Two of so many pieces are tried that hold the most corners of a triangle."""


def _surely_in_two(crossings: Sequence[_Crossing]) -> bool:
    """Whether two pieces are found in doubles whose union holds a triangle; False says nothing.

    A point is in neither piece if and only if it is beyond a plane of either.  By the minimax
    theorem no point of the triangle is beyond both planes if and only if a mean of their heights is
    at most zero at all three corners.
    """
    inside = [-int((each.heights <= -each.doubt).all(axis=1).sum()) for each in crossings]
    likely = [crossings[i] for i in np.argsort(inside, kind="stable")[:TRIED]]
    return any(_union_holds(one, other) for one, other in combinations(likely, 2))


def _union_holds(one: _Crossing, other: _Crossing) -> bool:
    a, b = one.heights[:, :, None], other.heights[:, None, :]
    doubt = one.doubt[:, None] + other.doubt[None, :]
    doubt = doubt + ROUNDING * (np.abs(a).max(axis=0) + np.abs(b).max(axis=0))
    # The share s of the first that makes s a + (1 - s) b least at the worst corner lies between
    # bounds that the corners give; any is sound, since the mean is looked at again.
    slope, rest = a - b, -b - doubt
    with np.errstate(all="ignore"):
        limit = rest / slope
    most = np.where(slope > 0, limit, 1.0).min(axis=0)
    least = np.where(slope < 0, limit, 0.0).max(axis=0)
    share = np.clip((np.clip(least, 0.0, 1.0) + np.clip(most, 0.0, 1.0)) / 2, 0.0, 1.0)
    return bool((share * a + (1 - share) * b <= -doubt).all())


MOST_PARTS = 64
"""With more of them, integers decide."""
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
    """The corners (k, 3) of a polygon as shares of those of the triangle."""
    return np.array([(x / (w := x + y + z), y / w, z / w) for x, y, z in part])


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
