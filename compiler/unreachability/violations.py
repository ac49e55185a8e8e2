"""Forbidden properties of a motion, on one box: certain in balls for all of its poses, or unknown.

Floats decide which boxes to examine: a violation that does not hold at the middle of a box does not
hold throughout it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Protocol

import numpy as np
from flint import arb

from compiler.arrays import Array
from compiler.expressions.evaluators.balls import ball
from compiler.tasks.pose_target import BALLS, pose_target
from compiler.unreachability.enclosed_points import BallRow, EnclosedPoints, ball_row
from compiler.unreachability.motion_conditions import MotionConditions, PointIn
from compiler.unreachability.touching import FRACTIONS, Touching
from grammar_lang import ir


class Violation(Protocol):
    """A demand that is violated."""

    def depth(self, places: Array) -> Array:
        """The violation at samples of all points (K, m, d), positive if violated: (K,), floats."""
        ...

    def certain(self, points: EnclosedPoints) -> bool:
        """Whether it is violated strictly at every pose of a box."""
        ...


@dataclass(frozen=True, slots=True)
class Outside:
    """A point is outside a closed half-space."""

    point: int
    row: BallRow

    def depth(self, places: Array) -> Array:
        """The height above the boundary in metres, (K,), for samples (K, m, d)."""
        return -_within(places[:, self.point], self.row)

    def certain(self, points: EnclosedPoints) -> bool:
        """Whether it is outside at every pose."""
        return points.beyond(self.point, self.row)


@dataclass(frozen=True, slots=True)
class Astray:
    """The axes of a frame, directions as points, differ from given ones by more than allowed.

    Their products with the ``directions``, normals of half-spaces, add up to less than ``least``.
    """

    points: tuple[int, ...]
    directions: tuple[BallRow, ...]
    least: arb

    def depth(self, places: Array) -> Array:
        """By how much the sum is less, (K,), for samples (K, m, d)."""
        pairs = zip(self.points, self.directions, strict=True)
        within = [-_within(places[:, point], row) for point, row in pairs]
        return np.asarray(_float(self.least) - np.sum(within, axis=0))

    def certain(self, points: EnclosedPoints) -> bool:
        """Whether the sum is less at every pose of a box."""
        pairs = zip(self.points, self.directions, strict=True)
        return bool(sum((points.highest(*pair) for pair in pairs), arb(0)) < self.least)


@dataclass(frozen=True, slots=True)
class Interior:
    """A point is in the interior of an intersection of half-spaces."""

    point: int
    rows: tuple[BallRow, ...]

    def depth(self, places: Array) -> Array:
        """The depth below the nearest boundary in metres, (K,), for samples (K, m, d)."""
        at = places[:, self.point]
        return np.asarray(np.min([_within(at, row) for row in self.rows], axis=0))

    def certain(self, points: EnclosedPoints) -> bool:
        """Whether it is inside at every pose."""
        return all(points.highest(self.point, row) < row.offset for row in self.rows)


@dataclass(frozen=True, slots=True)
class Crossing:
    """One point of a segment, the same for all poses, is in the interior of some half-spaces.

    Heights are linear along a segment: each half-space leaves an open interval of fractions.
    """

    ends: tuple[int, int]
    rows: tuple[BallRow, ...]

    def depth(self, places: Array) -> Array:
        """The length inside, as a fraction (K,) of the segment, for samples (K, m, d)."""
        count = len(places)
        low, high = np.zeros(count), np.ones(count)
        for row in self.rows:
            start = _within(places[:, self.ends[0]], row)
            end = _within(places[:, self.ends[1]], row)
            with np.errstate(divide="ignore", invalid="ignore"):
                at = start / (start - end)
            low = np.where(end > start, np.maximum(low, at), low)
            high = np.where(end < start, np.minimum(high, at), high)
            high = np.where((end == start) & (start < 0), -1.0, high)
        return np.asarray(high - low)

    def certain(self, points: EnclosedPoints) -> bool:
        """Whether it is inside at every pose."""
        first = [points.highest(self.ends[0], row) - row.offset for row in self.rows]
        last = [points.highest(self.ends[1], row) - row.offset for row in self.rows]
        fraction = _common_fraction([float(a) for a in first], [float(b) for b in last])
        if fraction is None:
            return False
        ahead, behind = ball(fraction), ball(1 - fraction)
        return all(behind * a + ahead * b < 0 for a, b in zip(first, last, strict=True))


def _common_fraction(first: Sequence[float], last: Sequence[float]) -> Fraction | None:
    """A fraction f at which all (1 - f) a + f b seem negative; None if there seems to be none."""
    low, high = 0.0, 1.0
    for a, b in zip(first, last, strict=True):
        if a < 0 and b < 0:
            continue
        if not (a < 0 or b < 0):
            return None
        at = a / (a - b)
        low, high = (low, min(high, at)) if a < 0 else (max(low, at), high)
    if not low <= high:
        return None
    return Fraction(round((low + high) / 2 * FRACTIONS), FRACTIONS)


def _within(at: Array, row: BallRow) -> Array:
    """How far points (K, d) are inside a half-space, in metres: (K,)."""
    normal = np.array([_float(entry) for entry in row.normal])
    length = float(np.linalg.norm(normal)) or 1.0
    return np.asarray((_float(row.offset) - at @ normal) / length)


def _float(value: arb) -> float:
    return float(value.mid())


def at_any_instant(demands: MotionConditions) -> list[Violation]:
    """The violations that are forbidden at every instant: each of these blocks a pose."""
    bounds = [ball_row(row) for row in demands.bounds]
    found: list[Violation] = [Outside(point, row) for point in demands.bounded for row in bounds]
    for obstacle in demands.obstacles:
        rows = _facing(obstacle.rows)
        if rows:
            found += [Interior(point, rows) for point in obstacle.points]
            found += [Crossing(ends, rows) for ends in obstacle.segments]
    found += [Touching(pair.points, pair.counts, pair.apart) for pair in demands.pairs]
    return found


def _facing(rows: Sequence[ir.HalfSpace]) -> tuple[BallRow, ...]:
    """The half-spaces of an interior, without those that are the whole space; empty if it is."""
    proper = [row for row in rows if any(row.normal)]
    if any(row.offset < 0 for row in rows if not any(row.normal)):
        return ()
    return tuple(ball_row(row) for row in proper)


def elsewhere(place: PointIn, axes: Sequence[Sequence[int]]) -> list[Violation]:
    """The violations that are forbidden where a point must be in a region.

    ``axes`` are the numbers of the axes of each effector, as directions.
    """
    found: list[Violation] = [Outside(place.point, ball_row(row)) for row in place.rows]
    for pose in place.poses:
        own = axes[place.point]
        target = pose_target(pose, len(own), BALLS)
        rows = tuple(BallRow(direction, arb(0)) for direction in target.directions)
        least = target.along(target.within.cos())
        found.append(Astray(tuple(own[axis] for axis in target.axes), rows, least))
    return found
