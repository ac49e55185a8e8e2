"""The shapes of regions: boxes, polytopes, hulls and round sets, all exact."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import Literal, TypeAlias

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.elaboration.closed import (
    NO_UNIT,
    Constants,
    ListUnit,
    coordinates,
    list_unit,
    not_rational,
)
from grammar_lang.elaboration.sorts import Sort, Typed, mismatch, warn_implausible
from grammar_lang.ir import constants
from grammar_lang.source import Span
from grammar_lang.syntax import tasks as t
from grammar_lang.units import LENGTH, ONE, Dimension


@dataclass(frozen=True, slots=True)
class RegionShapes:
    """Reads the shapes of a workspace; ``size`` is its dimension."""

    sink: Sink
    size: Literal[2, 3]

    def lower(self, shape: t.Shape, kind: ir.RegionKind) -> ir.RegionShape | None:
        """The shape of a region of that kind; None if an error was reported."""
        match shape:
            case t.Box():
                return self._box(shape)
            case t.Polytope():
                return self._polytope(shape)
            case t.Hull():
                return self._hull(shape)
            case t.Round():
                return self._round(shape, kind)

    def _units(self, units: tuple[s.Ident | None, ...]) -> list[ListUnit]:
        """The unit of each part; a part without a unit takes that of the last part."""
        last = list_unit(units[-1], LENGTH, self.sink)
        own = [last if u is None else list_unit(u, LENGTH, self.sink) for u in units[:-1]]
        return [*own, last]

    def _box(self, box: t.Box) -> ir.Inequalities | None:
        if len(box.sides) != self.size:
            where = "the plane" if self.size == 2 else "space"
            message = f"a box in {where} has {self.size} sides, not {len(box.sides)}"
            hint = f"write `box {' x '.join(['[…]'] * self.size)}`"
            self.sink.error(Code.OUT_OF_PLANE, message, box.span, hint)
            return None
        units = self._units(tuple(side.unit for side in box.sides))
        rows: list[ir.HalfSpace] = []
        for index, (side, unit) in enumerate(zip(box.sides, units, strict=True)):
            rows += self._side(index, side, unit)
        return ir.Inequalities(tuple(rows)) if len(rows) == 2 * self.size else None

    def _side(self, index: int, side: s.Interval, unit: ListUnit) -> list[ir.HalfSpace]:
        """The rows ``-x <= -lower`` and ``x <= upper``; empty if an error was reported."""
        reader = Constants(self.sink)
        lower = reader.rational(side.lower, LENGTH, unit)
        upper = reader.rational(side.upper, LENGTH, unit)
        if lower is None or upper is None:
            return []
        if lower > upper:
            self.sink.error(
                Code.EMPTY_INTERVAL,
                "this interval is empty: its lower bound exceeds its upper bound",
                side.span,
                "swap the bounds",
            )
            return []
        axis = tuple(Fraction(int(i == index)) for i in range(self.size))
        return [
            ir.HalfSpace(tuple(-c for c in axis), -lower, side.lower.span),
            ir.HalfSpace(axis, upper, side.upper.span),
        ]

    def _polytope(self, polytope: t.Polytope) -> ir.Inequalities | None:
        unit = list_unit(polytope.unit, LENGTH, self.sink)
        reader = Inequalities(self.sink, unit, self.size)
        rows = [reader.lower(row) for row in polytope.rows]
        found = tuple(row for row in rows if row is not None)
        return ir.Inequalities(found) if len(found) == len(rows) else None

    def _hull(self, hull: t.Hull) -> ir.Hull | None:
        found = self._points(hull.points)
        return None if found is None else ir.Hull(found)

    def _points(self, points: tuple[t.Point, ...]) -> tuple[tuple[Fraction, ...], ...] | None:
        """The exact points; None if an error was reported."""
        units = self._units(tuple(point.unit for point in points))
        reader = Constants(self.sink)
        read = [
            coordinates(reader, point.items, unit, LENGTH, self.size, point.span)
            for point, unit in zip(points, units, strict=True)
        ]
        found = tuple(p for p in read if p is not None)
        return found if len(found) == len(read) else None

    def _round(self, shape: t.Round, kind: ir.RegionKind) -> ir.Round | None:
        if kind == "bounds":
            message = f"the bounds must be a polytope, not a {shape.kind}"
            hint = "write a box, a polytope or a hull"
            self.sink.error(Code.BAD_VALUE, message, shape.span, hint)
            return None
        found = self._points(shape.points)
        radius = Constants(self.sink).rational(shape.radius, LENGTH)
        if radius is not None and radius <= 0:
            message = "the radius is not positive"
            self.sink.error(Code.BAD_VALUE, message, shape.radius.span, "write more than zero")
            radius = None
        if radius is None or found is None:
            return None
        if len(set(found)) < len(found):
            message = f"both ends of the {shape.kind} are the same point"
            self.sink.error(Code.BAD_VALUE, message, shape.span, "write a `ball`, or another end")
            return None
        return ir.Round(shape.kind, found, radius, kind == "obstacle")


# --- Linear inequalities in x, y, z with exact rational coefficients ------------------------------


Coefficients: TypeAlias = tuple[Fraction, Fraction, Fraction]

_UNITS: dict[str, Coefficients] = {
    "x": (Fraction(1), Fraction(0), Fraction(0)),
    "y": (Fraction(0), Fraction(1), Fraction(0)),
    "z": (Fraction(0), Fraction(0), Fraction(1)),
}
_NONE: Coefficients = (Fraction(0), Fraction(0), Fraction(0))


@dataclass(frozen=True, slots=True)
class Form:
    """``coefficients . (x, y, z) + constant``, with its dimension, in SI; None: a bare constant.

    ``inexact`` is the place of a constant that is not rational.
    """

    coefficients: Coefficients
    constant: Fraction
    dimension: Dimension | None
    inexact: Span | None = None

    def times(self, factor: Fraction, dimension: Dimension) -> Form:
        """The form multiplied by a constant of that dimension."""
        x, y, z = (c * factor for c in self.coefficients)
        return Form((x, y, z), self.constant * factor, (self.dimension or ONE) * dimension)

    def plus(self, other: Form) -> Form:
        """The sum of two forms of one dimension."""
        pairs = zip(self.coefficients, other.coefficients, strict=True)
        x, y, z = (a + b for a, b in pairs)
        return Form((x, y, z), self.constant + other.constant, self.dimension or other.dimension)


def _representable(q: Fraction) -> bool:
    """Whether a number does not overflow in floating point."""
    try:
        return math.isfinite(float(q))
    except OverflowError:
        return False


def has_axis(expr: s.Expr) -> bool:
    """Whether a coordinate occurs in an expression."""
    match expr:
        case s.AxisName():
            return True
        case s.Negate(operand=operand) | s.Scaled(operand=operand):
            return has_axis(operand)
        case s.Binary(left=left, right=right):
            return has_axis(left) or has_axis(right)
        case s.Tuple(items=items):
            return any(has_axis(item) for item in items)
        case s.Call(arguments=arguments):
            return any(has_axis(argument.value) for argument in arguments)
        case _:
            return False


@dataclass(frozen=True, slots=True)
class Inequalities:
    """Reads inequalities; ``unit`` is the unit of bare constants."""

    sink: Sink
    unit: ListUnit
    size: Literal[2, 3]

    def lower(self, row: t.Inequality) -> ir.HalfSpace | None:
        """The half-space of an inequality; None if an error was reported."""
        if not self._sign(row):
            return None
        if not has_axis(row.left) and not has_axis(row.right):
            self._not_linear("no coordinate occurs in this inequality", row.span)
            return None
        form = self._sum(row.left, row.right, Fraction(-1))
        if form is None:
            return None
        if form.coefficients == _NONE:
            self._not_linear("the coordinates cancel in this inequality", row.span)
            return None
        if not all(_representable(q) for q in (*form.coefficients, form.constant)):
            message = "a number in this inequality is too large"
            self.sink.error(Code.BAD_NUMBER, message, row.span, "use smaller ones")
            return None
        sign = Fraction(1 if row.comparison == "<=" else -1)
        normal = tuple(sign * c for c in form.coefficients[: self.size])
        return ir.HalfSpace(normal, -sign * form.constant, row.span)

    def _sign(self, row: t.Inequality) -> bool:
        if row.comparison in {"<=", ">="}:
            return True
        if row.comparison == "==":
            self._not_linear("an equation is not an inequality", row.span)
            return False
        self.sink.error(
            Code.STRICT_INEQUALITY,
            f"strict inequality `{row.comparison}`: sets are closed",
            row.span,
            f"write `{row.comparison}=`",
        )
        return False

    def _not_linear(self, message: str, at: Span) -> None:
        hint = "write a linear inequality such as `2*x + 3*(y - 1) <= 4`"
        self.sink.error(Code.NOT_LINEAR, message, at, hint)

    def _form(self, expr: s.Expr) -> Form | None:
        """The linear form of an expression that contains a coordinate; None after an error."""
        match expr:
            case s.AxisName(axis=axis):
                if axis == "z" and self.size == 2:
                    message = "there is no z in the plane"
                    hint = "use x and y, or `space xyz;`"
                    self.sink.error(Code.OUT_OF_PLANE, message, expr.span, hint)
                    return None
                return Form(_UNITS[axis], Fraction(0), LENGTH)
            case s.Negate(operand=operand):
                form = self._form(operand)
                return None if form is None else form.times(Fraction(-1), ONE)
            case s.Binary(operator="+", left=left, right=right):
                return self._sum(left, right, Fraction(1))
            case s.Binary(operator="-", left=left, right=right):
                return self._sum(left, right, Fraction(-1))
            case s.Binary(operator="*" | "/"):
                return self._product(expr)
            case _:
                self._not_linear("this is not linear in the coordinates", expr.span)
                return None

    def _term(self, expr: s.Expr) -> Form | None:
        """A summand; a bare constant is in the trailing unit."""
        if has_axis(expr):
            return self._form(expr)
        value = Constants(self.sink).typed(expr, self.unit)
        if value.sort is not Sort.SCALAR:
            return None
        exact = constants.rational(value.expr)
        inexact = expr.span if exact is None else None
        return Form(_NONE, exact or Fraction(0), value.dimension, inexact)

    def _factor(self, expr: s.Expr) -> tuple[Fraction, Dimension] | None:
        """A constant by which a form is multiplied or divided."""
        reader = Constants(self.sink)
        value = reader.typed(expr, NO_UNIT)
        if value.sort is not Sort.SCALAR:
            return None
        exact = reader.exact(value.expr, expr.span)
        return None if exact is None else (exact, value.dimension or ONE)

    def _sum(self, left: s.Expr, right: s.Expr, sign: Fraction) -> Form | None:
        a, b = self._term(left), self._term(right)
        if a is None or b is None:
            return None
        if a.dimension is not None and b.dimension not in {None, a.dimension}:
            at, wrong, due = right.span, b, a.dimension
            if a.coefficients == _NONE and b.dimension is not None:
                at, wrong, due = left.span, a, b.dimension
            typed = Typed(ir.Num(Fraction(0)), Sort.SCALAR, wrong.dimension)
            mismatch(typed, due, at, self.sink)
            return None
        for inexact in (a.inexact, b.inexact):
            if inexact is not None:
                not_rational(inexact, self.sink)
                return None
        dimension = a.dimension or b.dimension
        for form, written in ((a, left), (b, right)):
            if form.dimension is None and dimension is not None:
                bare = Typed(ir.Num(form.constant), Sort.SCALAR, None)
                warn_implausible(bare, dimension, written, None, self.sink)
        total = a.plus(b.times(sign, ONE))
        return Form(total.coefficients, total.constant, dimension)

    def _product(self, expr: s.Binary) -> Form | None:
        factor, form = expr.right, expr.left
        if expr.operator == "*" and not has_axis(factor):
            pass
        elif expr.operator == "*" and not has_axis(form):
            factor, form = form, factor
        elif has_axis(factor):
            self._not_linear("this is not linear in the coordinates", expr.span)
            return None
        value, constant = self._form(form), self._factor(factor)
        if value is None or constant is None:
            return None
        number, dimension = constant
        if expr.operator == "*":
            return value.times(number, dimension)
        if not number:
            self.sink.error(
                Code.BAD_NUMBER, "division by zero", factor.span, "this divisor is exactly 0"
            )
            return None
        return value.times(1 / number, ONE / dimension)
