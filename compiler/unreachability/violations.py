r"""Where the points of a robot are for all coordinates and parameters of a box, in ball arithmetic.

Of a linear function of a point, a height n . p, two enclosures are intersected: the natural one,
and the centred form

.. math:: n \cdot p(c) + \sum_i \left(n \cdot \partial_i p(X)\right) (X_i - c_i)

which is the sharper one on small boxes.

Source: Moore, Kearfott & Cloud, *Introduction to Interval Analysis* (2009), chapter 6.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Protocol

import casadi as ca
import numpy as np
from flint import arb

from compiler.arrays import Array
from compiler.dynamics.kinematics import kinematics, own_coordinates
from compiler.dynamics.symbolic_evaluator import SymbolicEvaluator
from compiler.expressions.evaluators.balls import BALLS, ball, constant_ball
from compiler.expressions.evaluators.intervals import INTERVALS, Ends, around
from compiler.expressions.scalars import Constant, PiConstant
from compiler.expressions.tape import Tape, tape
from compiler.robots.robot import RobotModel
from compiler.unreachability.motion_conditions import MotionConditions, PointIn
from grammar_lang import ir

ZERO = arb(0)


@dataclass(frozen=True, slots=True)
class BallRow:
    """A half-space ``normal . p <= offset`` by balls around its numbers."""

    normal: tuple[arb, ...]
    offset: arb


def ball_row(row: ir.HalfSpace) -> BallRow:
    """The half-space at the working precision."""
    return BallRow(tuple(ball(entry) for entry in row.normal), ball(row.offset))


class PointTapes:
    """The points of a robot as programs in (q, theta), in the joints' own coordinates.

    Raises:
        ValueError: the rules have no exact value.
    """

    def __init__(self, model: RobotModel) -> None:
        self.dimension: int = model.dimension
        n, p = len(model.dofs), len(model.parameters)
        q, theta, constants = ca.SX.sym("q", n), ca.SX.sym("theta", p), SymbolicEvaluator()
        at = kinematics(model, q, theta, constants, own_coordinates(model))
        points = [at.origins[frame] for frame in model.effectors]
        points += [point for each in model.colliders for point in at.bases(each)]
        value = ca.densify(ca.vertcat(*(point[: self.dimension] for point in points)))
        inputs = [q, theta, constants.vector()]
        self._numeric = ca.Function("points", inputs, [ca.cse(value)])
        self.values = tape(self._numeric)
        self.slopes = _slopes(value, ca.vertcat(q, theta), inputs)
        known: list[Constant | PiConstant] = list(constants.symbols)
        self.constants = [around(constant_ball(constant)) for constant in known]
        self._floats = [float(constant_ball(constant).mid()) for constant in known]

    def near(self, coordinates: Array, parameters: Array) -> Array:
        """The points at samples (K, n) of the coordinates, in floats that prove nothing: (K, m, d).

        ``parameters`` are (p,).
        """
        count = len(coordinates)
        columns = [ca.DM(coordinates.T), ca.DM(parameters), ca.DM(self._floats)]
        found = self._numeric.map(count)(*(_repeated(column, count) for column in columns))
        return np.asarray(found.full()).T.reshape(count, -1, self.dimension)

    def over(self, box: Sequence[Ends]) -> EnclosedPoints:
        """The points over a box of (q, theta), enclosed."""
        return EnclosedPoints(self, list(box))


def _repeated(column: ca.DM, count: int) -> ca.DM:
    return column if column.size2() == count else ca.repmat(column, 1, count)


def _slopes(value: ca.SX, variables: ca.SX, inputs: list[ca.SX]) -> Tape | None:
    """The derivatives, those of one variable together; None where they have no exact value."""
    if not variables.numel() or not value.numel():
        return None
    columns = ca.vec(ca.densify(ca.jacobian(value, variables)))
    try:
        return tape(ca.Function("slopes", inputs, [ca.cse(columns)]))
    except ValueError:
        return None


@dataclass(slots=True)
class EnclosedPoints:
    """The points of a robot over one box; what is not asked for is not computed."""

    tapes: PointTapes
    box: list[Ends]
    _natural: list[Ends] = field(default_factory=list[Ends])
    _centred: _Centred | None = None
    _asked: bool = False

    def beyond(self, point: int, row: BallRow) -> bool:
        """Whether the point is strictly outside a half-space for all of the box."""
        if self._naturally(point, row).low > row.offset:
            return True
        centred = self._centred_height(point, row)
        return centred is not None and bool(centred.low > row.offset)

    def highest(self, point: int, row: BallRow) -> arb:
        """An upper bound of the height of the point over all of the box; it may be nan."""
        natural, centred = self._naturally(point, row).high, self._centred_height(point, row)
        return natural if centred is None or not centred.high < natural else centred.high

    def _naturally(self, point: int, row: BallRow) -> Ends:
        if not self._natural:
            inputs = [*self.box, *self.tapes.constants]
            self._natural = self.tapes.values.evaluate(inputs, INTERVALS)
        low, high, start = ZERO, ZERO, point * self.tapes.dimension
        for axis, factor in enumerate(row.normal):
            if factor.is_zero():
                continue
            entry = self._natural[start + axis]
            below, above = factor * entry.low, factor * entry.high
            # A factor is a ball that is far narrower than any number is from zero, or it is exact.
            if factor > 0:
                low, high = low + below, high + above
            elif factor < 0:
                low, high = low + above, high + below
            else:
                return Ends(arb("nan"), arb("nan"))
        return Ends(low.lower(), high.upper())

    def _centred_height(self, point: int, row: BallRow) -> Ends | None:
        if not self._asked:
            self._asked = True
            self._centred = self._expanded()
        return None if self._centred is None else self._centred.height(point, row)

    def _expanded(self) -> _Centred | None:
        """The centred form, where all values and derivatives are defined throughout the box."""
        tapes = self.tapes
        if tapes.slopes is None or not all(side.finite for side in self.box):
            return None
        if not all(entry.finite for entry in self._natural):
            return None
        middles = [side.ball().mid() for side in self.box]
        known = [constant.ball() for constant in tapes.constants]
        at = tapes.values.evaluate([*middles, *known], BALLS)
        slopes = tapes.slopes.evaluate([*self.box, *tapes.constants], INTERVALS)
        if not all(entry.finite for entry in slopes):
            return None
        radii = [
            (side.ball() - middle).abs_upper()
            for side, middle in zip(self.box, middles, strict=True)
        ]
        return _Centred(
            tapes.dimension,
            at,
            [entry.ball() for entry in slopes],
            radii,
        )


@dataclass(frozen=True, slots=True)
class _Centred:
    """Points at the middle of a box, derivatives over it, and its radii."""

    dimension: int
    at: list[arb]
    slopes: list[arb]
    radii: list[arb]

    def height(self, point: int, row: BallRow) -> Ends:
        """The height of a point in the centred form."""
        start, size = point * self.dimension, len(self.at)
        middle, spread = ZERO, ZERO
        for axis, factor in enumerate(row.normal):
            middle += factor * self.at[start + axis]
        for number, radius in enumerate(self.radii):
            slope, place = ZERO, number * size + start
            for axis, factor in enumerate(row.normal):
                slope += factor * self.slopes[place + axis]
            spread += slope.abs_upper() * radius
        return Ends((middle - spread).lower(), (middle + spread).upper())


# --------------------------------------------------------------------------------------------------
# What a motion must not do, on one box: certain in balls for all of its poses, or not known.
#
# Floats say where it is worth asking: what is not so in the middle of a box is not so all over it.


FRACTIONS = 4096
"""Points of a segment are looked at in steps of a part of it as small as this."""


class Violation(Protocol):
    """A demand that is violated."""

    def depth(self, places: Array) -> Array:
        """By how much at samples of all points (K, m, d), positive where violated: (K,), floats."""
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
        """Whether it is at every pose."""
        return points.beyond(self.point, self.row)


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
        """Whether it is at every pose."""
        return all(points.highest(self.point, row) < row.offset for row in self.rows)


@dataclass(frozen=True, slots=True)
class Crossing:
    """One and the same point of a segment is in the interior of an intersection of half-spaces.

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
        """Whether it is at every pose."""
        first = [points.highest(self.ends[0], row) - row.offset for row in self.rows]
        last = [points.highest(self.ends[1], row) - row.offset for row in self.rows]
        fraction = _common_fraction([float(a) for a in first], [float(b) for b in last])
        if fraction is None:
            return False
        ahead, behind = ball(fraction), ball(1 - fraction)
        return all(behind * a + ahead * b < 0 for a, b in zip(first, last, strict=True))


def _common_fraction(first: Sequence[float], last: Sequence[float]) -> Fraction | None:
    """A fraction f at which all (1 - f) a + f b look negative; None: there seems to be none."""
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
    """How far points (K, d) are within a half-space, in metres: (K,)."""
    normal = np.array([_float(entry) for entry in row.normal])
    length = float(np.linalg.norm(normal)) or 1.0
    return np.asarray((_float(row.offset) - at @ normal) / length)


def _float(value: arb) -> float:
    return float(value.mid())


def at_any_instant(demands: MotionConditions) -> list[Violation]:
    """What must not be so at any instant: each of these blocks a pose."""
    bounds = [ball_row(row) for row in demands.bounds]
    found: list[Violation] = [Outside(point, row) for point in demands.bounded for row in bounds]
    for obstacle in demands.obstacles:
        rows = _facing(obstacle.rows)
        if rows:
            found += [Interior(point, rows) for point in obstacle.points]
            found += [Crossing(ends, rows) for ends in obstacle.segments]
    return found


def _facing(rows: Sequence[ir.HalfSpace]) -> tuple[BallRow, ...]:
    """The half-spaces of an interior, without those that are everything; none if it is empty."""
    proper = [row for row in rows if any(row.normal)]
    if any(row.offset < 0 for row in rows if not any(row.normal)):
        return ()
    return tuple(ball_row(row) for row in proper)


def elsewhere(place: PointIn) -> list[Outside]:
    """What must not be so where a point has to be in a region."""
    return [Outside(place.point, ball_row(row)) for row in place.rows]
