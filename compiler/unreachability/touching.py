"""Two bodies of a robot that touch at all poses of a box, from the differences of their points.

The differences are seen from the last frame that both bodies come after, so motions that both share
do not widen them. The differences of two segments fill a parallelogram, and the distance of the
bodies is the distance of the parallelogram from zero. Bodies are represented by their points, or by
the axes of rods, capsules and cylinders, with the radii that are known numbers: this is a subset of
each body.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from flint import arb

from compiler.arrays import Array
from compiler.expressions.evaluators.balls import ball
from compiler.expressions.evaluators.intervals import INTERVALS, outward
from compiler.unreachability.enclosed_points import BallRow, EnclosedPoints

FRACTIONS = 4096
"""Positions on a segment are multiples of its length divided by this."""


@dataclass(frozen=True, slots=True)
class Touching:
    """Two bodies are nearer than allowed; or, in the plane, segments without radius cross.

    ``points`` are the numbers of the differences of their ends, grouped by the ends of the first
    body; ``counts`` is the number of ends of each; they must be ``apart`` by this many metres.
    """

    points: tuple[int, ...]
    counts: tuple[int, int]
    apart: Fraction

    def depth(self, places: Array) -> Array:
        """By how many metres they are too near, (K,), for samples (K, m, d)."""
        corner, sides = spanned(places[:, self.points], self.counts)
        shares = nearest_shares(corner, sides)
        off = corner + shares[:, 0, None] * sides[0] + shares[:, 1, None] * sides[1]
        return np.asarray(float(self.apart) - np.linalg.norm(off, axis=1))

    def certain(self, points: EnclosedPoints) -> bool:
        """Whether they are too near at every pose of a box."""
        dimension = points.tapes.dimension
        reach = [self._heights(points, axis, dimension) for axis in range(dimension)]
        if self.apart and self._near(points, reach):
            return True
        return dimension == 2 and self.counts == (2, 2) and _around_zero(reach)

    def _heights(self, points: EnclosedPoints, axis: int, dimension: int) -> list[tuple[arb, arb]]:
        """For each difference the least and the largest coordinate along an axis, or nan."""
        rows = [
            BallRow(tuple(arb(sign * (axis == other)) for other in range(dimension)), arb(0))
            for sign in (-1, 1)
        ]
        return [
            (-points.highest(point, rows[0]), points.highest(point, rows[1]))
            for point in self.points
        ]

    def _near(self, points: EnclosedPoints, reach: Sequence[Sequence[tuple[arb, arb]]]) -> bool:
        """Whether one point of the parallelogram is near zero throughout the box."""
        middles = [[float((low + high).mid()) / 2 for low, high in axis] for axis in reach]
        corner, sides = spanned(np.array(middles).T[None], self.counts)
        shares = nearest_shares(corner, sides)[0]
        if not np.isfinite(shares).all():
            return False
        first, second = (Fraction(round(float(s) * FRACTIONS), FRACTIONS) for s in shares)
        weights = [
            ball(one * two)
            for one in ((1 - first, first) if self.counts[0] == 2 else (Fraction(1),))
            for two in ((1 - second, second) if self.counts[1] == 2 else (Fraction(1),))
        ]
        total = arb(0)
        for axis in reach:
            low = sum((w * least for w, (least, _) in zip(weights, axis, strict=True)), arb(0))
            high = sum((w * most for w, (_, most) in zip(weights, axis, strict=True)), arb(0))
            total += (-low).max(high) ** 2
        return bool(total < ball(self.apart * self.apart))


def spanned(differences: Array, counts: tuple[int, int]) -> tuple[Array, tuple[Array, Array]]:
    """One corner (K, d) of the parallelograms of differences (K, w, d), and their two sides."""
    corner = differences[:, 0]
    none = np.zeros_like(corner)
    first = differences[:, counts[1]] - corner if counts[0] == 2 else none
    second = differences[:, 1] - corner if counts[1] == 2 else none
    return corner, (first, second)


def nearest_shares(corner: Array, sides: tuple[Array, Array]) -> Array:
    """The fractions (K, 2) of both sides that lead from the corners (K, d) nearest to zero.

    Source: Ericson, *Real-Time Collision Detection* (2005), section 5.1.9.
    """
    one, two = sides
    a, b, e = np.sum(one * one, axis=1), np.sum(one * two, axis=1), np.sum(two * two, axis=1)
    c, f = np.sum(one * corner, axis=1), np.sum(two * corner, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        across = a * e - b * b
        first = np.where(across > 1e-12 * a * e, (b * f - c * e) / across, 0.0)
        first = np.clip(np.nan_to_num(first), 0.0, 1.0)
        second = np.clip(np.where(e > 0, -(f + b * first) / e, 0.0), 0.0, 1.0)
        first = np.clip(np.where(a > 0, -(c + b * second) / a, 0.0), 0.0, 1.0)
    return np.stack([first, second], axis=1)


def _around_zero(reach: Sequence[Sequence[tuple[arb, arb]]]) -> bool:
    """Whether zero is strictly inside the parallelogram, wherever its corners are.

    This holds if the path round it turns about zero in one direction at every side.
    """
    x, y = ([outward(low, high) for low, high in axis] for axis in reach)
    way = (0, 2, 3, 1)
    turns = [
        INTERVALS.sub(INTERVALS.mul(x[i], y[j]), INTERVALS.mul(y[i], x[j]))
        for i, j in zip(way, (*way[1:], way[0]), strict=True)
    ]
    left = all(bool(turn.low > 0) for turn in turns)
    return left or all(bool(turn.high < 0) for turn in turns)
