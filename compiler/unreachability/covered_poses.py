"""The poses of a robot on the boxes of a covering: where it may be, start and arrive; in balls.

A box is *blocked* if every pose in it strictly violates one and the same demand. Every other box
may contain poses of a motion: nothing is claimed about it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np
from flint import arb
from numpy.typing import NDArray

from compiler.arrays import Array
from compiler.expressions.evaluators.balls import ball, closed_ball
from compiler.expressions.evaluators.intervals import Ends
from compiler.time_limits.time_limit import check_time
from compiler.unreachability.actuation_bounds import LeafBox
from compiler.unreachability.box_tree import (
    MOST_HALVINGS,
    BoxTreeError,
    CoordinateTree,
    Part,
    Parts,
    RangeSide,
    coordinate_boxes,
    coordinate_sides,
    enclosures,
    parameter_sides,
)
from compiler.unreachability.enclosed_points import EnclosedPoints, PointTapes
from compiler.unreachability.motion_conditions import GivenPose, MotionConditions, Passage, PointIn
from compiler.unreachability.violations import Violation, at_any_instant, elsewhere
from grammar_lang import ir

NEAR = Fraction(1, 10**9)
"""A motion from a given pose may start this far from it, in every coordinate (SI)."""
NEARLY = 1e-9
"""Violations whose depth in floats is above minus this are still checked, in metres."""
BLOCK = 1000
"""The number of boxes whose middles are evaluated together."""


class CoveredPoses:
    """One robot and the demands on it, for boxes of its parameters and coordinates.

    Must be used at one working precision.

    Raises:
        ValueError: the rules of the robot have no exact value.
        BoxTreeError: a prismatic joint has no range, so its coordinate cannot be covered.
    """

    def __init__(self, demands: MotionConditions) -> None:
        self.demands = demands
        self.tapes = PointTapes(demands.model)
        self.parameters = parameter_sides(demands.model)
        coordinates = coordinate_sides(demands.model)
        if coordinates is None:
            raise BoxTreeError("a prismatic joint without a range cannot be covered")
        self.coordinates: tuple[RangeSide, ...] = coordinates
        self.violations = at_any_instant(demands)
        self._parts: dict[tuple[int, Part], Ends] = {}

    def parameters_of(self, box: Parts) -> list[Ends]:
        """Intervals around the parameters in a box of them.

        Raises:
            BoxTreeError: the box is of another robot.
        """
        return enclosures(self.parameters, box)

    def cover(self, parameters: list[Ends], tree: CoordinateTree) -> Cover:
        """The boxes of a tree of coordinates, for parameters in some intervals.

        Raises:
            BoxTreeError: the tree is of another robot.
        """
        boxes = list(coordinate_boxes(tree, len(self.coordinates)))
        sides = [self._enclosures(box) for box in boxes]
        return Cover(self, parameters, boxes, sides)

    def _enclosures(self, box: Parts) -> list[Ends]:
        """The sides of a box of coordinates; boxes share many of them."""
        found: list[Ends] = []
        for place, part in enumerate(box):
            key = place, part
            if key not in self._parts:
                self._parts[key] = self.coordinates[place].enclosure(part)
            found.append(self._parts[key])
        return found


@dataclass(slots=True, eq=False)
class Cover:
    """The boxes of coordinates for one box of parameters; ``free`` ones are not blocked, (K,)."""

    poses: CoveredPoses
    parameters: list[Ends]
    boxes: list[Parts]
    sides: list[list[Ends]]
    free: Flags = field(init=False)
    _places: Array = field(init=False)
    _points: dict[int, EnclosedPoints] = field(default_factory=dict[int, EnclosedPoints])
    _touching: TouchingBoxes | None = None

    def __post_init__(self) -> None:
        self.free = np.ones(len(self.boxes), dtype=bool)
        theta = np.array([_middle(side) for side in self.parameters])
        middles = [[_middle(side) for side in box] for box in self.sides]
        at = np.array(middles).reshape(len(middles), len(self.poses.coordinates))
        self._places = self.poses.tapes.near(at, theta)
        for start in range(0, len(self.boxes), BLOCK):
            block = range(start, min(start + BLOCK, len(self.boxes)))
            for number in self._violated(block, self.poses.violations):
                self.free[number] = False
                self._points.pop(number, None)

    def passable(self, passage: Passage) -> Flags:
        """The free boxes connected by touching free boxes to where a passage may start, (K,)."""
        if self._touching is None:
            circles = [side.circle for side in self.poses.coordinates]
            self._touching = TouchingBoxes(self.boxes, circles)
        return self._touching.reachable(self.starts(passage), self.free)

    def starts(self, passage: Passage) -> Flags:
        """The free boxes in which a passage may start, (K,)."""
        if isinstance(passage.start, GivenPose):
            held = [
                bool(self.free[i]) and _holds(self.poses.coordinates, self.sides[i], passage.start)
                for i in range(len(self.boxes))
            ]
            return np.array(held, dtype=bool)
        return self._within(passage.start, self.free)

    def goals(self, passage: Passage, among: Flags) -> Flags:
        """The given free boxes in which a passage may end, (K,)."""
        return self._within(passage.goal, among)

    def way(self, passage: Passage) -> bool:
        """Whether a chain of touching free boxes leads from the start to the goal."""
        return bool(self.goals(passage, self.passable(passage)).any())

    def leaves(self, passage: Passage) -> list[LeafBox]:
        """The boxes that a motion from start to goal may be in: those connected to its start."""
        passable = self.passable(passage)
        starts, goals = self.starts(passage), self.goals(passage, passable)
        return [
            LeafBox(tuple(side.ball() for side in self.sides[i]), bool(starts[i]), bool(goals[i]))
            for i in np.flatnonzero(passable)
        ]

    def _within(self, place: PointIn, among: Flags) -> Flags:
        """The given boxes in which a point may be in a region, as far as is known."""
        found = among.copy()
        numbers = np.flatnonzero(among)
        violations = elsewhere(place, self.poses.tapes.axes)
        for number in self._violated([int(i) for i in numbers], violations):
            found[number] = False
        return found

    def _violated(self, numbers: Sequence[int], violations: Sequence[Violation]) -> list[int]:
        """The given boxes in which one of the violations is certain for all poses."""
        if not numbers or not violations:
            return []
        places = self._places[list(numbers)]
        depths = np.array([violation.depth(places) for violation in violations])
        found: list[int] = []
        for column, number in enumerate(numbers):
            check_time()
            # The deepest first; nan sorts last and is not a candidate.
            order = np.argsort(-depths[:, column], kind="stable")
            candidates = (i for i in order if depths[i, column] > -NEARLY)
            points = self._enclosed(number)
            if any(violations[i].certain(points) for i in candidates):
                found.append(number)
        return found

    def _enclosed(self, number: int) -> EnclosedPoints:
        if number not in self._points:
            box = [*self.sides[number], *self.parameters]
            self._points[number] = self.poses.tapes.over(box)
        return self._points[number]


def _middle(side: Ends) -> float:
    return float(side.ball().mid()) if side.finite else float("nan")


def _holds(sides: Sequence[RangeSide], box: Sequence[Ends], pose: GivenPose) -> bool:
    """Whether a given pose may be in a box, or so near that a motion may start there."""
    if len(pose.values) != len(sides):
        return False
    return all(
        _near(side, part, value) for side, part, value in zip(sides, box, pose.values, strict=True)
    )


def _near(side: RangeSide, part: Ends, value: ir.Expr) -> bool:
    given, near = closed_ball(value), ball(NEAR)
    above, below = given - part.high - near, given - part.low + near
    if not side.circle:
        return not (above > 0 or below < 0)
    # For some integer k, low <= value - 2 pi k <= high.
    turn = 2 * arb.pi()
    first = (above / turn).lower().ceil().unique_fmpz()
    last = (below / turn).upper().floor().unique_fmpz()
    return first is None or last is None or first <= last


# --- Which boxes of a covering chains of touching boxes lead to; exact, in integers ---------------
#
# Closed boxes touch if they share a point, even a corner; on a circle the last part touches the
# first.


Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]
LARGEST_BLOCK = 2_000_000
"""The most pairs of boxes that are compared at once."""


class TouchingBoxes:
    """Boxes, by the parts of their sides; ``circles`` says which sides are circles."""

    def __init__(self, boxes: Sequence[Parts], circles: Sequence[bool]) -> None:
        shape = (len(boxes), len(circles))
        self.circles = tuple(circles)
        self.low: Integers = np.zeros(shape, dtype=np.int64)
        self.high: Integers = np.zeros(shape, dtype=np.int64)
        for i, box in enumerate(boxes):
            for j, part in enumerate(box):
                width = 1 << (MOST_HALVINGS - part.halvings)
                self.low[i, j], self.high[i, j] = part.number * width, (part.number + 1) * width

    def reachable(self, seeds: Flags, free: Flags) -> Flags:
        """The free boxes that chains of touching free boxes connect to free seeds, (K,)."""
        reached = seeds & free
        frontier, waiting = np.flatnonzero(reached), np.flatnonzero(free & ~reached)
        while len(frontier) and len(waiting):
            touched = np.zeros(len(waiting), dtype=bool)
            size = max(1, LARGEST_BLOCK // len(waiting))
            for start in range(0, len(frontier), size):
                check_time()
                touched |= self._touch(frontier[start : start + size], waiting).any(axis=0)
            frontier, waiting = waiting[touched], waiting[~touched]
            reached[frontier] = True
        return reached

    def _touch(self, some: Integers, others: Integers) -> Flags:
        """Which pairs share a point, shape (some, others)."""
        found: Flags = np.ones((len(some), len(others)), dtype=bool)
        for side, circle in enumerate(self.circles):
            low, high = self.low[some, side, None], self.high[some, side, None]
            first, last = self.low[None, others, side], self.high[None, others, side]
            meet = (low <= last) & (first <= high)
            if circle:
                whole = 1 << MOST_HALVINGS
                meet |= ((low == 0) & (last == whole)) | ((high == whole) & (first == 0))
            found &= meet
        return found
