r"""The points of a robot for all coordinates and parameters of a box, in ball arithmetic.

For a linear function of a point, a height n . p, two enclosures are intersected: the natural one,
and the centred form

.. math:: n \cdot p(c) + \sum_i \left(n \cdot \partial_i p(X)\right) (X_i - c_i)

which is the sharper one on small boxes.

Source: Moore, Kearfott & Cloud, *Introduction to Interval Analysis* (2009), chapter 6.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import casadi as ca
import numpy as np
from flint import arb

from compiler.arrays import Array
from compiler.dynamics.corner_points import corner_points
from compiler.dynamics.kinematics import kinematics, own_coordinates
from compiler.dynamics.symbolic_evaluator import SymbolicEvaluator
from compiler.expressions.evaluators.balls import BALLS, ball, constant_ball
from compiler.expressions.evaluators.intervals import INTERVALS, Ends, around
from compiler.expressions.scalars import Constant, PiConstant
from compiler.expressions.tape import Tape, tape
from compiler.robots.robot import RobotModel
from grammar_lang import ir

ZERO = arb(0)


@dataclass(frozen=True, slots=True)
class BallRow:
    """A half-space ``normal . p <= offset``, given by balls around its numbers."""

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
        found = corner_points(at)
        first = len(model.effectors)
        self.axes = tuple(tuple(first + i for i in axes) for axes in found.axes)
        value = ca.densify(found.points)
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
    """The derivatives, those of one variable together; None if they have no exact value."""
    if not variables.numel() or not value.numel():
        return None
    columns = ca.vec(ca.densify(ca.jacobian(value, variables)))
    try:
        return tape(ca.Function("slopes", inputs, [ca.cse(columns)]))
    except ValueError:
        return None


@dataclass(slots=True)
class EnclosedPoints:
    """The points of a robot over one box, computed only when they are asked for."""

    tapes: PointTapes
    box: list[Ends]
    _natural: list[Ends] = field(default_factory=list[Ends])
    _centred: _Centred | None = None
    _asked: bool = False

    def beyond(self, point: int, row: BallRow) -> bool:
        """Whether the point is strictly outside a half-space throughout the box."""
        if self._naturally(point, row).low > row.offset:
            return True
        centred = self._centred_height(point, row)
        return centred is not None and bool(centred.low > row.offset)

    def highest(self, point: int, row: BallRow) -> arb:
        """An upper bound of the height of the point throughout the box; it may be nan."""
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
            # A factor is exact, or a ball far narrower than the distance of any number from zero.
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
        """The centred form, if all values and derivatives are defined throughout the box."""
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
