"""One protocol for all kinds of values of an expression graph.

Three representations are evaluated with it: the scalars of a robot (``scalars.py``), the equations
of motion (``tape.py``), and scalar expressions as they were written (``evaluate_expression``).
Source: Elliott, "Compiling to categories" (2017), for one program with many interpretations; the
additional operations are those of CasADi's instruction lists.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from typing import Protocol, TypeVar

from grammar_lang import ir

Value = TypeVar("Value")

METHODS: Mapping[str, str] = {
    "+": "add", "-": "sub", "*": "mul", "/": "div", "^": "power", "neg": "neg", "abs": "fabs",
    "sqrt": "sqrt", "sin": "sin", "cos": "cos", "tan": "tan",
}  # fmt: skip
"""Maps operations, as written in expressions, to methods."""


class UnsupportedOperation(ValueError):
    """An evaluator does not support an operation."""


class Evaluator(Protocol[Value]):
    """The operations on one kind of value.

    Evaluators subclass it. Methods with a body here are derived from the other operations; an
    evaluator overrides them if it can do better. A method is looked up once per evaluation, so that
    it may be a static method that is a compiled function.
    """

    def constant(self, value: Fraction | int) -> Value:
        """An exact rational."""
        ...

    def pi(self) -> Value:
        """The number pi."""
        ...

    def neg(self, argument: Value, /) -> Value:
        """The negation."""
        ...

    def add(self, left: Value, right: Value, /) -> Value:
        """The sum."""
        ...

    def sub(self, left: Value, right: Value, /) -> Value:
        """The difference."""
        return self.add(left, self.neg(right))

    def mul(self, left: Value, right: Value, /) -> Value:
        """The product."""
        ...

    def div(self, left: Value, right: Value, /) -> Value:
        """The quotient."""
        return self.mul(left, self.inv(right))

    def inv(self, argument: Value, /) -> Value:
        """The reciprocal."""
        return self.div(self.constant(1), argument)

    def twice(self, argument: Value, /) -> Value:
        """Twice the argument."""
        return self.add(argument, argument)

    def sq(self, argument: Value, /) -> Value:
        """The square."""
        return self.mul(argument, argument)

    def power(self, base: Value, exponent: int, /) -> Value:
        """An integer power, by repeated squaring."""
        result, square, left = self.constant(1), base, abs(exponent)
        while left:
            if left & 1:
                result = self.mul(result, square)
            left >>= 1
            if left:
                square = self.sq(square)
        return result if exponent >= 0 else self.inv(result)

    def sqrt(self, argument: Value, /) -> Value:
        """The non-negative square root."""
        ...

    def sin(self, argument: Value, /) -> Value:
        """The sine of an angle in rad."""
        ...

    def cos(self, argument: Value, /) -> Value:
        """The cosine of an angle in rad."""
        ...

    def sin_cos(self, argument: Value, /) -> tuple[Value, Value]:
        """The sine and cosine of one angle."""
        return self.sin(argument), self.cos(argument)

    def tan(self, argument: Value, /) -> Value:
        """The tangent of an angle in rad."""
        sine, cosine = self.sin_cos(argument)
        return self.div(sine, cosine)

    def fabs(self, argument: Value, /) -> Value:
        """The absolute value."""
        ...

    def sign(self, argument: Value, /) -> Value:
        """The slope of the absolute value: 1 above zero, -1 below.

        Raises:
            UnsupportedOperation: the evaluator has no such value.
        """
        raise UnsupportedOperation(f"{type(self).__name__} has no sign of {argument}")


def evaluate_expression(
    expression: ir.Expr,
    evaluator: Evaluator[Value],
    leaf: Callable[[ir.Expr], Value] | None = None,
) -> Value:
    """The value of a scalar expression; ``leaf`` gives the value of a leaf that is not a number.

    Raises:
        ValueError: the expression is not closed, and there is no ``leaf``.
    """
    values: list[Value] = []
    todo: list[ir.Expr | tuple[str, int]] = [expression]
    while todo:
        match todo.pop():
            case ("power", int(exponent)):
                values.append(evaluator.power(values.pop(), exponent))
            case (str(name), int(count)):
                arguments = values[-count:]
                values[-count:] = [getattr(evaluator, name)(*arguments)]
            case ir.Num(value):
                values.append(evaluator.constant(value))
            case ir.Pi():
                values.append(evaluator.pi())
            case ir.Unary(function, operand):
                todo += [(METHODS[function], 1), operand]
            case ir.Binary("^", base, ir.Num(exponent)):
                todo += [("power", int(exponent)), base]
            case ir.Binary(operator, left, right):
                todo += [(METHODS[operator], 2), right, left]
            case other:
                if leaf is None or isinstance(other, tuple):
                    raise ValueError(f"not a closed scalar: {expression}")
                values.append(leaf(other))
    return values.pop()
