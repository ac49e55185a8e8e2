"""Constraints that a body or an effector stays away from a convex obstacle.

A lower bound of the distance of two convex sets follows from the direction between their nearest
points. The direction is found in floats; the bound that it gives is computed in balls.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import combinations
from typing import TypeAlias

import numpy as np
from flint import arb

from compiler.arrays import Array
from solvers.verifier.proofs.extension import Corner, Extension, Rim, corner_at, corners, lowest
from solvers.verifier.proofs.hull_extension import ManyCorners, has_hull
from solvers.verifier.proofs.point_map import Slice
from solvers.verifier.proofs.tube_checks import Constraint, Row

Point: TypeAlias = Sequence[arb]

RIM_ROUNDS = 3
"""How often the lowest points of rims are added and the direction is computed again."""
LOWEST = 8
"""The number of directions in which corners of hulls that may surround zero are looked for."""
GLANCE = 0.5
"""A direction is renewed if it shows less than this fraction of its earlier distance."""


@dataclass(slots=True)
class Apart(Constraint):
    """The hull of some points stays away from a convex obstacle by more than a distance.

    The ``extensions`` are added to every point. ``vertices`` is empty for an unbounded obstacle;
    its own facets are then the only candidate directions. The direction that separated the two last
    is tried first, since it usually does so again.
    """

    rows: tuple[Row, ...] = ()
    vertices: tuple[tuple[arb, ...], ...] = ()
    distance: arb = field(default_factory=lambda: arb(0))
    last: Row | None = None
    shown: float = 0.0
    """The distance in the last direction when that was the best one."""

    def glance(self, over: Slice) -> float:
        """The distance in the last direction, or -inf if that direction may be a bad one by now."""
        if self.last is None:
            return float("-inf")
        lower = _lower(self._along(self.last, over))
        return lower if lower >= min(self.hope, GLANCE * self.shown) else float("-inf")

    def bound(self, over: Slice) -> tuple[arb, arb]:
        """The distance along the best separating direction, minus the required distance.

        If the last direction shows as much as is known of the motion before, no other is tried.
        """
        best = arb("-inf"), arb("-inf")
        if self.last is not None:
            best = self._along(self.last, over)
            if float(best[0].lower()) >= self.hope:
                return best
        for row in (*self._between(over), *self.rows):
            found = self._along(row, over)
            if _lower(found) > _lower(best):
                best, self.last = found, row
        self.shown = _lower(best)
        return best

    def _along(self, row: Row, over: Slice) -> tuple[arb, arb]:
        """The distance in a direction minus the required one: over the slice, and at its middle."""
        lower, centre = arb("inf"), arb("inf")
        for value, at in lowest(over, row.normal, self.points, self.extensions):
            lower, centre = lower.min(value), centre.min(at)
        return (
            ((lower - row.offset) / row.length - self.distance).lower(),
            (centre - row.offset) / row.length - self.distance,
        )

    def _between(self, over: Slice) -> list[Row]:
        """The half-space around the obstacle whose normal points from it to the points."""
        if not self.vertices:
            return []
        normal = tuple(arb(x) for x in self._nearest(over)[1].difference)
        length = _product(normal, normal).sqrt()
        if not length > 0:
            return []
        support = arb("-inf")
        for vertex in self.vertices:
            support = support.max(_product(normal, vertex))
        return [Row(normal, support, length)]

    def _nearest(self, over: Slice) -> tuple[list[Corner], Nearest]:
        """Corners at the middle of a slice, and where their hull is nearest to the obstacle.

        The lowest rim points of discs in the direction found are added, a few times.
        """
        obstacle = [[float(x) for x in vertex] for vertex in self.vertices]
        rims = [list[Rim]() for _ in self.extensions]
        many = has_hull(self.extensions)
        while True:
            if many:
                tried, found = _nearest_of_many(
                    ManyCorners.of(over, self.points, self.extensions, rims), obstacle
                )
            else:
                tried = corners(self.points, self.extensions, rims)
                places = [[float(x.mid()) for x in corner_at(over, corner)] for corner in tried]
                found = nearest_points(places, obstacle)
            more = [each.lowest_on_rim(found.difference, over) for each in self.extensions]
            if not any(more) or len(rims[0]) == RIM_ROUNDS:
                return tried, found
            for rim, way in zip(rims, more, strict=True):
                rim.append(way or (1.0, 0.0))

    def violated(self, over: Slice) -> bool:
        """Whether the condition certainly fails at the middle of the slice."""
        places = [corner_at(over, corner) for corner in corners(self.points, self.extensions)]
        tried = [*places, *self._inner(places)]
        if any(all(bool(_excess(row, p) < 0) for row in self.rows) for p in tried):
            return True
        if self.vertices:
            found, nearest = self._nearest(over)
            body = _mixed(nearest.left, [corner_at(over, corner) for corner in found])
            return _nearer(body, _mixed(nearest.right, self.vertices), self.distance)
        return any(_nearer(p, foot, self.distance) for p in places for foot in self._feet(p))

    def _inner(self, places: Sequence[Point]) -> list[list[arb]]:
        """The middle of the part of a body between two points that lies in the obstacle."""
        if len(places) != 2:
            return []
        p, q = ([float(x.mid()) for x in place] for place in places)
        low, high = 0.0, 1.0
        for row in self.rows:
            at, along = -float(row.offset), 0.0
            for a, x, y in zip(row.normal, p, q, strict=True):
                at, along = at + float(a) * x, along + float(a) * (y - x)
            if along > 0:
                high = min(high, -at / along)
            elif along < 0:
                low = max(low, -at / along)
        share = (low + high) / 2
        return [_mixed((1 - share, share), places)] if 0 <= low < high <= 1 else []

    def _feet(self, p: Point) -> list[list[arb]]:
        """The feet of a point on the facets that certainly lie in the obstacle."""
        found = []
        for row in self.rows:
            share = _excess(row, p) / (row.length * row.length)
            foot = [x - share * a for x, a in zip(p, row.normal, strict=True)]
            if all(bool(_excess(other, foot) <= 0) for other in self.rows if other is not row):
                found.append(foot)
        return found

    def where(self, over: Slice) -> tuple[float, ...]:
        """The point of the body that is nearest to the obstacle, at the middle of the slice."""
        if not self.vertices:
            return over.middle(self.points[0])
        found, nearest = self._nearest(over)
        return _place(nearest.left, over, found)


@dataclass(slots=True)
class BodiesApart(Apart):
    """Two bodies stay apart: the hull of their points' differences stays away from zero.

    The differences are the ``points``, ordered by the point of the first body; the ``extensions``
    are those of the first body, then of the second. ``body`` are the points of the first body
    itself, and ``shape`` its extensions; ``where`` uses both.
    """

    body: tuple[int, ...] = ()
    shape: tuple[Extension, ...] = ()

    def violated(self, over: Slice) -> bool:
        """Whether the bodies are certainly nearer at the middle of the slice, or certainly meet."""
        found, least = self._nearest(over)
        places = [corner_at(over, corner) for corner in found]
        if len(places[0]) == 2 and _surround_zero(self._around(over, places)):
            return True
        nearest = _mixed(least.left, places)
        return _nearer(nearest, [arb(0)] * len(nearest), self.distance)

    def _around(self, over: Slice, places: list[list[arb]]) -> list[list[arb]]:
        """Corners that may surround zero; for hulls, the lowest ones in several directions."""
        if not has_hull(self.extensions):
            return places
        rims = [()] * len(self.extensions)
        many = ManyCorners.of(over, self.points, self.extensions, rims)
        angles = 2 * np.pi * np.arange(LOWEST) / LOWEST
        heights = many.places @ np.array([np.cos(angles), np.sin(angles)])
        chosen = np.unique(heights.argmin(axis=0)).tolist()
        return [corner_at(over, many.corner(number)) for number in chosen]

    def where(self, over: Slice) -> tuple[float, ...]:
        """The point of the first body that is nearest to the second, at the middle of the slice."""
        found, least = self._nearest(over)
        others = len(self.points) // len(self.body)
        first = self.extensions[: len(self.shape)]
        seen = [column for each in first for column in each.columns]
        own = dict(zip(seen, (c for each in self.shape for c in each.columns), strict=True))
        body: list[Corner] = [
            (
                self.body[self.points.index(point) // others],
                tuple((own[column], weight) for column, weight in terms if column in own),
            )
            for point, terms in found
        ]
        return _place(least.left, over, body)


def _nearest_of_many(
    many: ManyCorners, obstacle: Sequence[Sequence[float]]
) -> tuple[list[Corner], Nearest]:
    """The corners with a positive weight in the nearest point, and where it is."""
    found = nearest_points(many.places, obstacle)
    counted = [number for number, share in enumerate(found.left) if share > 0]
    left = tuple(found.left[number] for number in counted)
    return [many.corner(number) for number in counted], replace(found, left=left)


def _place(shares: Sequence[float], over: Slice, found: Sequence[Corner]) -> tuple[float, ...]:
    """The approximate point of the hull of corners that has these weights."""
    counted = [(max(0.0, share), corner) for share, corner in zip(shares, found, strict=True)]
    total, place = sum(share for share, _ in counted), np.zeros(len(over.points[0]))
    for share, corner in counted:
        if share:
            place += share / total * np.array([float(x.mid()) for x in corner_at(over, corner)])
    return tuple(place.tolist())


def _surround_zero(places: Sequence[Point]) -> bool:
    """Whether zero certainly lies in a triangle of three of some points of the plane."""
    return any(
        all(bool(side > 0) for side in sides) or all(bool(side < 0) for side in sides)
        for a, b, c in combinations(places, 3)
        for sides in [[p[0] * q[1] - p[1] * q[0] for p, q in ((a, b), (b, c), (c, a))]]
    )


def _product(left: Point, right: Point) -> arb:
    value = arb(0)
    for a, b in zip(left, right, strict=True):
        value += a * b
    return value


def _excess(row: Row, p: Point) -> arb:
    return _product(row.normal, p) - row.offset


def _mixed(weights: Sequence[float], points: Sequence[Point]) -> list[arb]:
    """The point of a hull with these weights, normalised; negative ones count as zero."""
    shares = [arb(max(0.0, weight)) for weight in weights]
    total = sum(shares, arb(0))
    return [_product(shares, axis) / total for axis in zip(*points, strict=True)]


def _nearer(p: Point, foot: Point, distance: arb) -> bool:
    """Whether two points are certainly nearer to each other than a distance."""
    gap = [a - b for a, b in zip(p, foot, strict=True)]
    return bool(_product(gap, gap) < distance * distance)


def _lower(bound: tuple[arb, arb]) -> float:
    value = float(bound[0])
    return value if value == value else float("-inf")


# --------------------------------------------------------------------------------------------------
# Where two convex hulls of points are nearest, in floats: it guides a proof and proves nothing.
#
# Source: Wolfe, *Finding the nearest point in a polytope* (1976), on the differences of the points.


MOST_STEPS = 60
CLOSELY = 1e-13
"""A step whose gain, relative to the largest square, is less than this ends the search."""


@dataclass(frozen=True, slots=True)
class Nearest:
    """The vector between the nearest points of two hulls, and their weights on the points."""

    difference: tuple[float, ...]
    left: tuple[float, ...]
    right: tuple[float, ...]


def nearest_points(
    left: Sequence[Sequence[float]] | Array, right: Sequence[Sequence[float]]
) -> Nearest:
    """The nearest points of two hulls; the vector points from ``right`` to ``left``.

    The points are (d,) each, and the algorithm is Wolfe's (1976).
    """
    apart = np.array(left)[:, None, :] - np.array(right)[None, :, :]
    search = _Search(apart.reshape(-1, apart.shape[-1]))
    weights = search.weights().reshape(apart.shape[:2])
    return Nearest(
        tuple(search.point.tolist()),
        tuple(weights.sum(axis=1).tolist()),
        tuple(weights.sum(axis=0).tolist()),
    )


@dataclass(slots=True)
class _Search:
    """The point of least norm in the hull of ``points``, shape (n, d)."""

    points: Array
    corral: list[int] = field(default_factory=list[int])
    shares: Array = field(default_factory=lambda: np.ones(1))
    point: Array = field(default_factory=lambda: np.zeros(0))

    def weights(self) -> Array:
        """The weight of each point in the point of least norm, shape (n,)."""
        squares = np.einsum("ij,ij->i", self.points, self.points)
        least_gain = CLOSELY * float(squares.max())
        self.corral = [int(squares.argmin())]
        self.point = self.points[self.corral[0]]
        for _ in range(MOST_STEPS):
            along = self.points @ self.point
            best = int(along.argmin())
            if float(self.point @ self.point - along[best]) <= least_gain or best in self.corral:
                break
            self.corral.append(best)
            self.shares = np.append(self.shares, 0.0)
            self._settle()
        found = np.zeros(len(self.points))
        found[self.corral] = self.shares
        return found

    def _settle(self) -> None:
        """Move to the point of least norm of the affine hull, or to the boundary on the way."""
        while True:
            aim = self._affine()
            if bool((aim > 0).all()):
                self.shares = aim
                break
            falling = aim <= 0
            share = float((self.shares[falling] / (self.shares[falling] - aim[falling])).min())
            moved = (1 - share) * self.shares + share * aim
            moved[falling & (moved <= moved[falling].min())] = 0.0
            kept = moved > 0
            self.corral = [item for item, keep in zip(self.corral, kept, strict=True) if keep]
            self.shares = moved[kept] / moved[kept].sum()
        self.point = self.shares @ self.points[self.corral]

    def _affine(self) -> Array:
        """The weights, of any sign, of the point of least norm of the affine hull."""
        chosen = self.points[self.corral]
        size = len(chosen)
        system = np.ones((size + 1, size + 1))
        system[0, 0] = 0.0
        system[1:, 1:] = chosen @ chosen.T
        right = np.zeros(size + 1)
        right[0] = 1.0
        return np.asarray(np.linalg.lstsq(system, right, rcond=None)[0][1:], dtype=np.float64)
