"""The demands of a task on boxes of coordinates and parameters, in floats.

The results guide a search and prove nothing: the verifier evaluates the same demands exactly.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import product
from math import cos
from typing import TypeAlias

import numpy as np

from compiler.arrays import Array
from compiler.dynamics.corner_points import corner_points
from compiler.dynamics.equations_of_motion import RobotGraph
from compiler.expressions.evaluators.balls import closed_ball
from compiler.expressions.evaluators.intervals import TURN, IntervalBatch
from compiler.expressions.evaluators.intervals import product as times
from compiler.tasks.pose_target import FLOATS, pose_target
from compiler.time_limits.time_limit import check_time
from compiler.unreachability.motion_conditions import (
    GivenPose,
    MotionConditions,
    Obstacle,
    Pair,
    Passage,
    PointIn,
)
from compiler.unreachability.touching import FRACTIONS, nearest_shares, spanned
from grammar_lang import ir
from solvers.impossibility.box_points import BoxPoints, Placed, ends
from solvers.impossibility.coordinate_cover import Flags, Numbers

CLEAR = 1e-9
"""How far a box has to violate a demand, relative to the size of the numbers in it."""
NEAR = 2e-9
"""A motion from a given pose may start this near to it: a bit more than the verifier's
tolerance."""
MOST_IN_BATCH = 256
"""Boxes are evaluated in blocks of this many."""
MOST_NORMALS = 256
"""Half-spaces of obstacles are evaluated in groups of about this many."""


_Kind: TypeAlias = tuple[tuple[int, ...], tuple[tuple[int, int], ...], int]
"""The points and the segments that avoid an obstacle, and the number of its half-spaces."""


@dataclass(frozen=True, slots=True, eq=False)
class Judged:
    """The result for K boxes and C passages.

    ``open`` (K,): no demand is known to be violated on the whole box; ``free`` (K,): none is
    violated anywhere in it. ``start`` and ``goal`` (K, C): a pose of the box may be there.
    ``effects`` (K, v): how far each variable moves a point, in metres.
    """

    open: Flags
    free: Flags
    start: Flags
    goal: Flags
    effects: Array

    def at(self, where: Flags | Numbers) -> Judged:
        """The result for some boxes: a mask (K,) or their numbers (some,)."""
        return Judged(
            self.open[where], self.free[where], self.start[where], self.goal[where],
            self.effects[where],
        )  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class _Region:
    """Unit normals (r, d) and offsets (r,) in metres, and the indices of points in ``Placed``."""

    normals: Array
    offsets: Array
    points: Numbers

    @property
    def slack(self) -> Array:
        return np.asarray(CLEAR * np.maximum(np.abs(self.offsets), 1.0))

    def outside(self, placed: Placed) -> Flags:
        """Which boxes have a point that is strictly outside on the whole box, (K,)."""
        least = placed.along(self.normals, self.points).low
        return np.asarray((least > self.offsets + self.slack).any(axis=(1, 2)))


@dataclass(frozen=True, slots=True, eq=False)
class _Avoided:
    """Regions whose interiors the same points, and the segments between some of them, avoid.

    All have the same number of normals, stored one after the other in ``regions``.
    """

    regions: _Region
    count: int
    single: Numbers
    first: Numbers
    last: Numbers

    def judged(self, placed: Placed) -> tuple[Flags, Flags]:
        """Which boxes violate this everywhere, and which nowhere, (K,) each."""
        found = placed.along(self.regions.normals, self.regions.points)
        shape = *found.low.shape[:2], self.count, len(self.regions.offsets) // self.count
        offsets, slack = (
            each.reshape(shape[2:]) for each in (self.regions.offsets, self.regions.slack)
        )
        low, high = (end.reshape(shape) for end in ends(found))
        below = high - offsets
        deep: Flags = below[:, self.single] < -slack
        inside = np.any(np.all(deep, axis=3), axis=(1, 2))
        crossed = np.any(_crossed(below[:, self.first], below[:, self.last], slack), axis=(1, 2))
        above: Flags = low >= offsets
        apart = np.all(np.any(above[:, self.single], axis=3), axis=(1, 2))
        beside: Flags = above[:, self.first] & above[:, self.last]
        missed = np.all(np.any(beside, axis=3), axis=(1, 2))
        return np.asarray(inside | crossed), np.asarray(apart & missed)


def _crossed(first: Array, last: Array, slack: Array) -> Flags:
    """Which segments certainly have a point inside a region, by heights of their ends (..., r).

    The fraction is chosen as the verifier chooses it, so that both give the same answer.
    """
    at = first / (first - last)
    low = np.where((first >= 0) & (last < 0), at, 0.0).max(axis=-1, initial=0.0)
    high = np.where((first < 0) & (last >= 0), at, 1.0).min(axis=-1, initial=1.0)
    fraction = (np.round((low + high) / 2 * FRACTIONS) / FRACTIONS)[..., None]
    return np.asarray(((1 - fraction) * first + fraction * last < -slack).all(axis=-1))


@dataclass(frozen=True, slots=True, eq=False)
class _Turned:
    """Axes, by index, whose products with ``directions`` (a, d) must sum to at least ``least``."""

    directions: Array
    points: Numbers
    least: float

    def away(self, placed: Placed) -> Flags:
        """Which boxes have the wrong orientation everywhere, (K,)."""
        high = placed.along(self.directions, self.points).high
        return np.asarray(np.trace(high, axis1=1, axis2=2) < self.least - CLEAR)


@dataclass(frozen=True, slots=True, eq=False)
class _Apart:
    """Two bodies of the robot that stay apart; ``points`` are their differences in ``Placed``."""

    pair: Pair
    points: Numbers

    def judged(self, placed: Placed) -> tuple[Flags, Flags]:
        """Which boxes violate this everywhere, and which nowhere, (K,) each."""
        dimension = placed.centre.shape[2]
        along = placed.along(np.eye(dimension), self.points)
        away = placed.along(_directions(dimension), self.points)
        least = float(self.pair.apart)
        apart = np.asarray((away.low.min(axis=1) > least + CLEAR).any(axis=1))
        near = self._near(along, least) if least else np.zeros(len(apart), dtype=bool)
        if dimension == 2 and self.pair.counts == (2, 2):
            near |= _around_zero(along)
        return near, apart

    def _near(self, along: IntervalBatch, least: float) -> Flags:
        """Which boxes have a point of all differences near zero, chosen as by the verifier."""
        shares = nearest_shares(*spanned((along.low + along.high) / 2, self.pair.counts))
        first, second = (np.round(shares * FRACTIONS) / FRACTIONS).T
        ones = (1 - first, first) if self.pair.counts[0] == 2 else (np.ones(len(first)),)
        twos = (1 - second, second) if self.pair.counts[1] == 2 else (np.ones(len(first)),)
        weights = np.stack([one * two for one in ones for two in twos], axis=1)[:, :, None]
        low, high = (np.sum(weights * end, axis=1) for end in ends(along))
        farthest = np.linalg.norm(np.maximum(-low, high), axis=1)
        return np.asarray(farthest < least - CLEAR * max(1.0, least))


def _directions(dimension: int) -> Array:
    """The unit vectors (r, d) along which two bodies are tested for being apart."""
    found = np.array([each for each in product((-1, 0, 1), repeat=dimension) if any(each)], float)
    return np.asarray(found / np.linalg.norm(found, axis=1, keepdims=True))


def _around_zero(along: IntervalBatch) -> Flags:
    """Which boxes have zero strictly inside the parallelogram of the differences, (K,)."""
    way = [0, 2, 3, 1]
    (x, y), (u, v) = (
        [IntervalBatch(along.low[:, order, axis], along.high[:, order, axis]) for axis in (0, 1)]
        for order in (way, [*way[1:], way[0]])
    )
    one, two = times(x, v), times(y, u)
    low, high = one.low - two.high, one.high - two.low
    return np.asarray((low > CLEAR).all(axis=1) | (high < -CLEAR).all(axis=1))


class BoxConditions:
    """The demands on a robot, for the passages of one question.

    Raises:
        ValueError: the robot's rules have no value over boxes.
    """

    def __init__(
        self,
        demands: MotionConditions,
        passages: Sequence[Passage],
        graph: RobotGraph,
        circles: Flags,
    ) -> None:
        self.n, self.p = len(graph.model.dofs), len(graph.model.parameters)
        used = _used(demands, passages, graph)
        place = {point: i for i, point in enumerate(used)}
        self._points = BoxPoints(graph, used)
        self._passages = passages
        self._bounds = _region(demands.bounds, [place[point] for point in demands.bounded])
        obstacles = _avoided([o for o in demands.obstacles if _has_interior(o)], place)
        self._always: list[_Avoided | _Apart] = [
            *obstacles,
            *(_Apart(each, _numbers([place[i] for i in each.points])) for each in demands.pairs),
        ]
        self._goals = [_region(p.goal.rows, [place[p.goal.point]]) for p in passages]
        self._turned = [_turned(p.goal, graph, place) for p in passages]
        self._starts = [
            _given(p.start, circles) if isinstance(p.start, GivenPose)
            else _region(p.start.rows, [place[p.start.point]])
            for p in passages
        ]  # fmt: skip

    @property
    def given(self) -> Array | None:
        """The coordinates (n,) of a start pose that the task gives, or None."""
        first = self._starts[0]
        return None if isinstance(first, _Region) else first

    def judged(self, low: Array, high: Array) -> Judged:
        """The result for boxes of (q, theta) from ``low`` to ``high`` (K, n + p)."""
        blocks = [slice(i, i + MOST_IN_BATCH) for i in range(0, max(len(low), 1), MOST_IN_BATCH)]
        with np.errstate(all="ignore"):
            parts = [self._block(low[block], high[block]) for block in blocks]
        if len(parts) == 1:
            return parts[0]
        return Judged(
            np.concatenate([part.open for part in parts]),
            np.concatenate([part.free for part in parts]),
            np.concatenate([part.start for part in parts]),
            np.concatenate([part.goal for part in parts]),
            np.concatenate([part.effects for part in parts]),
        )

    def _block(self, low: Array, high: Array) -> Judged:
        check_time()
        placed = self._points.over(low, high)
        violated, free = self._violations(placed)
        start = np.zeros((len(low), len(self._passages)), dtype=bool)
        goal = np.zeros_like(start)
        for i, (begin, end) in enumerate(zip(self._starts, self._goals, strict=True)):
            goal[:, i] = ~end.outside(placed)
            for pose in self._turned[i]:
                goal[:, i] &= ~pose.away(placed)
            if isinstance(begin, _Region):
                start[:, i] = ~begin.outside(placed)
            else:
                above = begin > low[:, : self.n] - NEAR
                inside = above & (begin < high[:, : self.n] + NEAR)
                start[:, i] = inside.all(axis=1)
        return Judged(~violated, free, start, goal, placed.effects)

    def _violations(self, placed: Placed) -> tuple[Flags, Flags]:
        """Which boxes violate a demand everywhere, and which nowhere, (K,) each."""
        found = placed.along(self._bounds.normals, self._bounds.points)
        limit, slack = self._bounds.offsets, self._bounds.slack
        violated = (found.low > limit + slack).any(axis=(1, 2))
        free = (found.high <= limit).all(axis=(1, 2))
        for each in self._always:
            inside, apart = each.judged(placed)
            violated |= inside
            free &= apart
        return np.asarray(violated), np.asarray(free)


def _used(demands: MotionConditions, passages: Sequence[Passage], graph: RobotGraph) -> list[int]:
    """The points that occur in a demand."""
    used = set(demands.bounded)
    for obstacle in demands.obstacles:
        used.update(obstacle.points)
        used.update(point for segment in obstacle.segments for point in segment)
    for pair in demands.pairs:
        used.update(pair.points)
    for passage in passages:
        used.add(passage.goal.point)
        if passage.goal.poses:
            used.update(_axes(graph, passage.goal.point))
        if not isinstance(passage.start, GivenPose):
            used.add(passage.start.point)
    return sorted(used)


def _axes(graph: RobotGraph, effector: int) -> list[int]:
    """The numbers of the axes of the effector's frame, which are directions among the points."""
    first = len(graph.model.effectors)
    return [first + axis for axis in corner_points(graph.parts.at).axes[effector]]


def _turned(goal: PointIn, graph: RobotGraph, place: Mapping[int, int]) -> list[_Turned]:
    """The required orientations of an effector at its goal."""
    found = []
    for pose in goal.poses:
        target = pose_target(pose, graph.model.dimension, FLOATS)
        axes = _axes(graph, goal.point)
        points = _numbers([place[axes[axis]] for axis in target.axes])
        found.append(_Turned(np.array(target.directions), points, target.along(cos(target.within))))
    return found


def _region(rows: Sequence[ir.HalfSpace], points: Sequence[int]) -> _Region:
    normals = np.array([[float(a) for a in row.normal] for row in rows]).reshape(len(rows), -1)
    offsets = np.array([float(row.offset) for row in rows])
    length = np.linalg.norm(normals, axis=1)
    length = np.where(length > 0, length, 1.0)  # a zero row holds everywhere
    return _Region(normals / length[:, None], offsets / length, _numbers(points))


def _has_interior(obstacle: Obstacle) -> bool:
    """Whether no row excludes every point."""
    return all(any(row.normal) or row.offset >= 0 for row in obstacle.rows)


def _avoided(obstacles: Sequence[Obstacle], place: Mapping[int, int]) -> list[_Avoided]:
    """The obstacles, grouped by their points, segments and numbers of half-spaces."""
    alike: dict[_Kind, list[list[ir.HalfSpace]]] = {}
    for obstacle in obstacles:
        rows = [row for row in obstacle.rows if any(row.normal)]
        kind = tuple(obstacle.points), tuple(obstacle.segments), len(rows)
        alike.setdefault(kind, []).append(rows)
    found = []
    for (points, segments, size), regions in alike.items():
        ends = [point for segment in segments for point in segment]
        used = list(dict.fromkeys([*points, *ends]))
        at = {point: i for i, point in enumerate(used)}
        most = max(1, MOST_NORMALS // max(1, size))
        for begin in range(0, len(regions), most):
            some = regions[begin : begin + most]
            found.append(
                _Avoided(
                    _region([row for rows in some for row in rows], [place[i] for i in used]),
                    len(some),
                    _numbers([at[point] for point in points]),
                    _numbers([at[first] for first, _ in segments]),
                    _numbers([at[last] for _, last in segments]),
                )
            )
    return found


def _numbers(values: Sequence[int]) -> Numbers:
    return np.array(values, dtype=np.int64)


def _given(start: GivenPose, circles: Flags) -> Array:
    """The coordinates of a pose; those on a circle are within half a turn."""
    values = np.array([float(closed_ball(value).mid()) for value in start.values])
    return np.where(circles, values - TURN * np.round(values / TURN), values)
