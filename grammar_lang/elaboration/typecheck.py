"""Elaborate expressions: look up names, check sorts and dimensions, and fold constants exactly."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Literal

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.diagnostics.wording import did_you_mean
from grammar_lang.elaboration.frames import frame_call
from grammar_lang.elaboration.sorts import (
    UNKNOWN,
    ZERO,
    DimensionUse,
    Scope,
    Sort,
    Typed,
    finite,
    folded,
    mismatch,
    require_scalar,
    scale,
    unknown,
    wrong_sort,
)
from grammar_lang.ir import constants
from grammar_lang.source import Span
from grammar_lang.units import ONE, UNIT_NAMES, Dimension, Unit
from grammar_lang.units import unit as parse_unit

MAX_POWER = 12

_SCALAR_FUNCTIONS: dict[str, ir.Function] = {
    "sin": "sin",
    "cos": "cos",
    "tan": "tan",
    "sqrt": "sqrt",
    "abs": "abs",
}
FUNCTIONS = (*_SCALAR_FUNCTIONS, "rot", "move")
SHAPES = ("sphere", "capsule", "cylinder", "box", "hull")
EMISSIONS = ("rod", "point", "solid", "effector", *SHAPES, "visual")


def read_unit(ident: s.Ident, sink: Sink) -> Unit | None:
    """The unit that an identifier names; reported if it names none."""
    found = parse_unit(ident.text)
    if found is None:
        hint = f"the units are {' '.join(UNIT_NAMES)}, with exponents up to 12"
        sink.error(Code.UNKNOWN_UNIT, f"unknown unit `{ident.text}`", ident.span, hint)
    return found


def plain_name(ident: s.Ident, known: tuple[str, ...], sink: Sink) -> Typed:
    """The value of a name that is not declared in scope: ``pi``, or an error."""
    if ident.text == "pi":
        return Typed(ir.Pi(), Sort.SCALAR, None)
    hint = did_you_mean(ident.text, (*known, "pi"), "name", sink)
    if ident.text in UNIT_NAMES:
        hint = "a unit follows its number without blanks in it, as in `2 kg/m`"
    elif ident.text.lower() == "world":
        hint = "did you mean `world`?"
    sink.error(Code.UNKNOWN_NAME, f"unknown name `{ident.text}`", ident.span, hint)
    return UNKNOWN


@dataclass(frozen=True, slots=True)
class Checker:
    """Elaborates expressions in a scope and reports errors to the sink.

    ``functions`` are additional functions that are known only at the place of the expression.
    """

    scope: Scope
    sink: Sink
    functions: Mapping[str, Callable[[s.Call], Typed]] = field(
        default_factory=dict[str, Callable[[s.Call], Typed]]
    )

    def elaborate(self, expr: s.Expr) -> Typed:
        """The typed form of an expression; UNKNOWN if an error was reported."""
        match expr:
            case s.Number():
                return self._number(expr)
            case s.Name(ident=ident):
                return self.scope.name(ident, self.sink)
            case s.Member():
                return self.scope.member(expr, self.sink)
            case s.WorldName():
                return Typed(ir.World(), Sort.FRAME, None)
            case s.Call():
                return self._call(expr)
            case s.Negate(operand=operand):
                return self._negate(operand, expr.span)
            case s.Binary():
                return self._binary(expr)
            case _:
                return self._other(expr)

    def _other(self, expr: s.AxisName | s.Tuple | s.Scaled | s.Text) -> Typed:
        match expr:
            case s.Text():
                message = "the path of a file is not a value here"
                hint = 'a path may appear only in `file: "…"` of a `hull` or `visual`'
                self.sink.error(Code.SORT_MISMATCH, message, expr.span, hint)
                return UNKNOWN
            case s.AxisName(axis=axis):
                message = f"the axis `{axis}` is not a value here"
                hint = "axes may appear only in `rot(axis, …)`, `move(axis, …)` and `axis:`"
                self.sink.error(Code.SORT_MISMATCH, message, expr.span, hint)
                return UNKNOWN
            case s.Tuple():
                return self._vector(expr)
            case s.Scaled(operand=operand, unit=unit):
                value = self.elaborate(operand)
                found = read_unit(unit, self.sink)
                if found is None:
                    return UNKNOWN
                if not value.bare and value.sort is not Sort.UNKNOWN:
                    message = f"the unit `{unit.text}` follows a value that has a dimension already"
                    self.sink.error(Code.UNIT_MISMATCH, message, unit.span, "remove the unit")
                    return UNKNOWN
                return scale(value, found, expr.span, self.sink)

    def _number(self, number: s.Number) -> Typed:
        if number.value is None:
            self.sink.error(
                Code.BAD_NUMBER, "this number is too large or too long", number.span, "shorten it"
            )
            return UNKNOWN
        value = Typed(ir.Num(number.value), Sort.SCALAR, None)
        if number.unit is None:
            return finite(value, number.span, self.sink)
        unit = read_unit(number.unit, self.sink)
        return UNKNOWN if unit is None else scale(value, unit, number.span, self.sink)

    def _vector(self, expr: s.Tuple) -> Typed:
        if len(expr.items) not in {2, 3}:
            message = f"a vector has two or three components, not {len(expr.items)}"
            self.sink.error(Code.SORT_MISMATCH, message, expr.span, "write `(x, y, z)`")
            return UNKNOWN
        items = [self.elaborate(item) for item in expr.items]
        unit = None if expr.unit is None else read_unit(expr.unit, self.sink)
        if unit is not None:
            items = [scale(item, unit, expr.span, self.sink) for item in items]
        dimension: Dimension | None = None
        for item, part in zip(items, expr.items, strict=True):
            if item.sort in {Sort.VECTOR, Sort.FRAME}:
                wrong_sort(item, "a number", part.span, self.sink)
                return UNKNOWN
            dimension = self._same(dimension, item, part.span)
        x, y, *rest = (item.expr for item in items)
        z = rest[0] if rest else ZERO
        if z != ZERO:
            self.scope.uses.append(
                DimensionUse(3, expr.items[2].span, "this component leaves the plane")
            )
        vector = ir.Vector(x, y, z)
        if dimension is None and any(item.sort is Sort.UNKNOWN for item in items):
            return unknown(vector)
        return Typed(vector, Sort.VECTOR, dimension)

    def _same(self, dimension: Dimension | None, value: Typed, at: Span) -> Dimension | None:
        """The common dimension of the previous components and a value."""
        if dimension is None or value.dimension is None:
            return dimension or value.dimension
        if value.dimension != dimension:
            mismatch(value, dimension, at, self.sink)
        return dimension

    # --- Functions -----------------------------------------------------------------------------

    def _call(self, call: s.Call) -> Typed:
        match call.function.text:
            case "rot" | "move" as function:
                return frame_call(function, call, self.elaborate, self.scope, self.sink)
            case name if name in _SCALAR_FUNCTIONS:
                return self._function(_SCALAR_FUNCTIONS[name], call)
            case name if name in self.functions:
                return self.functions[name](call)
            case name:
                self._unknown_function(name, call)
                return UNKNOWN

    def _unknown_function(self, name: str, call: s.Call) -> None:
        """Report an unknown function; errors in its arguments are reported as well."""
        at = call.function.span
        if name in EMISSIONS:
            message = f"`{name}(…)` is an emission, not a value"
            hint = f"it is a statement of its own: `{name}(…);`"
            self.sink.error(Code.SORT_MISMATCH, message, at, hint)
            return
        hint = did_you_mean(name, (*FUNCTIONS, *self.functions), "function", self.sink)
        self.sink.error(Code.UNKNOWN_NAME, f"unknown function `{name}`", at, hint)
        for argument in call.arguments:
            value = argument.value
            if isinstance(value, s.Member | s.Name) and self.scope.dof(value) is not None:
                self.scope.use_dof(value)
            elif not isinstance(value, s.AxisName):
                self.elaborate(value)

    def _function(self, function: ir.Function, call: s.Call) -> Typed:
        if len(call.arguments) != 1 or call.arguments[0].name is not None:
            message = f"`{function}` takes one number"
            self.sink.error(
                Code.SORT_MISMATCH, message, call.span, f"write `{function}(…)` with one number"
            )
            return UNKNOWN
        argument = call.arguments[0].value
        value = self.elaborate(argument)
        if value.sort is not Sort.SCALAR:
            wrong_sort(value, "a number", argument.span, self.sink)
            return unknown(ir.Unary(function, value.expr))
        before = len(self.sink.found)
        dimension = self._image(function, value, argument.span)
        if Sink(self.sink.found[before:]).has_errors:
            return UNKNOWN
        return self._unary(function, value.expr, dimension, call.span)

    def _image(self, function: ir.Function, value: Typed, at: Span) -> Dimension | None:
        """The dimension of the function's value; None (bare) for a bare argument."""
        if value.dimension is None:
            return None
        if function in {"sin", "cos", "tan"}:
            require_scalar(value, ONE, at, self.sink)
            return ONE
        if function == "sqrt":
            root = value.dimension.root()
            if root is None:
                message = "no unit is the square root of this one"
                self.sink.error(
                    Code.UNIT_MISMATCH, message, at, "the root is taken of m^2, s^2, m^2/s^2, …"
                )
                return ONE
            return root
        return value.dimension

    def _unary(
        self, function: ir.Function, operand: ir.Expr, dimension: Dimension | None, at: Span
    ) -> Typed:
        known = constants.evident(operand)
        if function == "sqrt" and known is not None and known[0] < 0:
            self.sink.error(
                Code.BAD_NUMBER, "the root of a negative number", at, "numbers below 0 have no root"
            )
            return UNKNOWN
        if function == "tan" and known is not None and constants.is_right_angle(known):
            message = "the tangent of a right angle"
            self.sink.error(Code.BAD_NUMBER, message, at, "a tangent has no value there")
            return UNKNOWN
        expr = folded(lambda: constants.unary(function, operand), at, self.sink)
        if expr is None:
            return UNKNOWN
        return finite(Typed(expr, Sort.SCALAR, dimension), at, self.sink)

    def _negate(self, operand: s.Expr, at: Span) -> Typed:
        value = self.elaborate(operand)
        if value.sort is not Sort.SCALAR:
            wrong_sort(value, "a number", operand.span, self.sink)
            return unknown(ir.Unary("neg", value.expr))
        result = self._unary("neg", value.expr, value.dimension, at)
        return Typed(result.expr, result.sort, result.dimension, value.angular)

    # --- Operators -----------------------------------------------------------------------------

    def _binary(self, expr: s.Binary) -> Typed:
        left, right = self.elaborate(expr.left), self.elaborate(expr.right)
        if expr.operator == "*" and Sort.FRAME in {left.sort, right.sort}:
            return self._compose(left, right, expr)
        for value, part in ((left, expr.left), (right, expr.right)):
            if value.sort in {Sort.FRAME, Sort.VECTOR}:
                wrong_sort(value, "a number", part.span, self.sink)
                return UNKNOWN
        match expr.operator:
            case "+" | "-" as operator:
                return self._sum(operator, left, right, expr)
            case "*" | "/" as operator:
                return self._product(operator, left, right, expr)
            case "^":
                return self._raise(left, right, expr)

    def _compose(self, left: Typed, right: Typed, expr: s.Binary) -> Typed:
        for value, part in ((left, expr.left), (right, expr.right)):
            if value.sort is not Sort.FRAME:
                wrong_sort(value, "a frame", part.span, self.sink)
                if value.sort is not Sort.UNKNOWN:
                    return UNKNOWN
        return Typed(ir.Compose(left.expr, right.expr), Sort.FRAME, None)

    def _fold(
        self,
        operator: ir.Operator,
        left: ir.Expr,
        right: ir.Expr,
        dimension: Dimension | None,
        at: Span,
    ) -> Typed:
        expr = folded(lambda: constants.binary(operator, left, right), at, self.sink)
        if expr is None:
            return UNKNOWN
        return finite(Typed(expr, Sort.SCALAR, dimension), at, self.sink)

    def _sum(self, operator: Literal["+", "-"], left: Typed, right: Typed, at: s.Binary) -> Typed:
        dimension = left.dimension or right.dimension
        if Sort.UNKNOWN in {left.sort, right.sort} and dimension is None:
            return unknown(ir.Binary(operator, left.expr, right.expr))
        if left.dimension is not None:
            self._same(left.dimension, right, at.right.span)
        found = self._fold(operator, left.expr, right.expr, dimension, at.span)
        return replace(found, angular=left.angular and right.angular)

    def _product(
        self, operator: Literal["*", "/"], left: Typed, right: Typed, at: s.Binary
    ) -> Typed:
        if Sort.UNKNOWN in {left.sort, right.sort}:
            return unknown(ir.Binary(operator, left.expr, right.expr))
        if operator == "/" and constants.rational(right.expr) == 0:
            self.sink.error(
                Code.BAD_NUMBER, "division by zero", at.right.span, "this divisor is exactly 0"
            )
            return UNKNOWN
        dimension: Dimension | None = None
        if left.dimension is not None or right.dimension is not None:
            a, b = left.dimension or ONE, right.dimension or ONE
            dimension = a * b if operator == "*" else a / b
        found = self._fold(operator, left.expr, right.expr, dimension, at.span)
        # A multiple of an angle, or of an angular rate, is angular as well.
        multiple = left.angular and right.dimension is None
        multiple |= operator == "*" and right.angular and left.dimension is None
        return replace(found, angular=multiple)

    def _raise(self, left: Typed, right: Typed, at: s.Binary) -> Typed:
        exponent = constants.rational(require_scalar(right, ONE, at.right.span, self.sink))
        if exponent is None or exponent.denominator != 1:
            message = "the exponent is not a whole number"
            hint = "write a whole number, or `sqrt(…)`"
            self.sink.error(Code.NOT_CONSTANT, message, at.right.span, hint)
            return UNKNOWN
        symbolic = left.dimension is not None or not constants.is_closed(left.expr)
        too_high = symbolic and abs(exponent) > MAX_POWER
        if too_high or (exponent < 0 and constants.rational(left.expr) == 0):
            self.sink.error(
                Code.BAD_NUMBER,
                f"the exponent exceeds {MAX_POWER}" if too_high else "division by zero",
                at.right.span,
                "use a smaller exponent" if too_high else "use a positive exponent",
            )
            return UNKNOWN
        power = ir.Num(exponent)
        if left.sort is Sort.UNKNOWN:
            return unknown(ir.Binary("^", left.expr, power))
        dimension = None if left.dimension is None else left.dimension**exponent.numerator
        return self._fold("^", left.expr, power, dimension, at.span)
