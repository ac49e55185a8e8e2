"""The validated reading of a robot's graph: ball arithmetic and truncated power series of balls.

Every ball contains the exact value; nothing here compares floats with a tolerance.
"""

from __future__ import annotations

import operator
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from fractions import Fraction
from threading import RLock
from typing import Any

from flint import arb, arb_series, ctx, fmpq

from compiler.arithmetic.scalars import (
    Apply,
    Constant,
    ParameterLeaf,
    PiConstant,
    ScalarNode,
    read_scalars,
)
from grammar_lang import ir

_CONTEXT = RLock()
"""flint has one context for all threads.  A series that another thread cuts short has coefficients
that are 0 and should not be: what is then computed contains nothing."""


@contextmanager
def working_precision(bits: int) -> Iterator[None]:
    """Ball arithmetic with so many bits within the block; other threads wait for theirs."""
    with _CONTEXT:
        before = ctx.prec, ctx.cap
        ctx.prec = bits
        try:
            yield
        finally:
            ctx.prec, ctx.cap = before


def ball(value: Fraction | int) -> arb:
    """A ball around a rational."""
    exact = Fraction(value)
    return arb(fmpq(exact.numerator, exact.denominator))


def constant_ball(constant: Constant | PiConstant) -> arb:
    """A ball around a constant of a graph."""
    return ball(constant.value) if isinstance(constant, Constant) else arb.pi()


def closed_ball(expression: ir.Expr) -> arb:
    """A ball around a closed scalar expression.

    Raises:
        ValueError: the expression is not a closed scalar.
    """
    match expression:
        case ir.Num(value):
            return ball(value)
        case ir.Pi():
            return arb.pi()
        case ir.Unary(function, operand):
            return _UNARY[function](closed_ball(operand))
        case ir.Binary("^", base, ir.Num(exponent)):
            return closed_ball(base) ** int(exponent)
        case ir.Binary(operator, left, right):
            a, b = closed_ball(left), closed_ball(right)
            return {"+": a.__add__, "-": a.__sub__, "*": a.__mul__, "/": a.__truediv__}[operator](b)
        case _:
            raise ValueError(f"not a closed scalar: {expression}")


def _sign(a: arb) -> arb:
    """The sign, which is also the slope of the absolute value; [-1, 1] where it is not certain."""
    if a > 0:
        return arb(1)
    return arb(-1) if a < 0 else arb(0, 1)


_UNARY: Mapping[str, Callable[[arb], arb]] = {
    "neg": operator.neg,
    "abs": abs,
    "fabs": abs,
    "sign": _sign,
    "sq": lambda a: a * a,
    "inv": lambda a: 1 / a,
    "twice": lambda a: a + a,
    "sqrt": arb.sqrt,
    "sin": arb.sin,
    "cos": arb.cos,
    "tan": arb.tan,
}
_SERIES: Mapping[str, Callable[[arb_series], arb_series]] = {
    "neg": operator.neg,
    "sq": lambda a: a * a,
    "inv": lambda a: 1 / a,
    "twice": lambda a: a + a,
    "sqrt": arb_series.sqrt,
    "sin": arb_series.sin,
    "cos": arb_series.cos,
    "tan": arb_series.tan,
}


class BallArithmetic:
    """Balls as the numbers of a tape."""

    def integer(self, value: int) -> arb:
        """An exact integer."""
        return arb(value)

    def unary(self, name: str, argument: arb) -> arb:
        """A function of one ball."""
        return _UNARY[name](argument)

    def binary(self, name: str, left: arb, right: arb) -> arb:
        """An operation on two balls."""
        if name == "add":
            return left + right
        if name == "sub":
            return left - right
        return left * right if name == "mul" else left / right


class UncertainSignError(ValueError):
    """An absolute value has a kink within a ball: its Taylor coefficients end at the first."""


def _absolute(a: arb_series) -> arb_series:
    """The absolute value; where the sign is uncertain, up to the first order (Clarke's gradient).

    Of a Lipschitz function the Taylor polynomial of degree one with its integral remainder still
    holds, since its derivative exists almost everywhere and lies in the hull of both slopes.
    """
    sign = _sign(a[0])
    if sign.is_exact():
        return sign * a
    if len(a) > 1 and ctx.cap > 2:
        raise UncertainSignError("the sign under an absolute value is not certain")
    return arb_series([abs(a[0]), sign * a[1]])


def _slope(a: arb_series) -> arb_series:
    """The sign, piecewise constant."""
    sign = _sign(a[0])
    if not sign.is_exact() and len(a) > 1 and ctx.cap > 1:
        raise UncertainSignError("the sign under an absolute value is not certain")
    return arb_series([sign])


class SeriesArithmetic:
    """Power series of balls, truncated at the working length, as the numbers of a tape."""

    def integer(self, value: int) -> arb_series:
        """A constant series."""
        return arb_series([value])

    def unary(self, name: str, argument: arb_series) -> arb_series:
        """A function of one series.

        Raises:
            UncertainSignError: an absolute value, or its slope, is not smooth to the order asked.
        """
        if name in ("fabs", "sign"):
            return _absolute(argument) if name == "fabs" else _slope(argument)
        return _SERIES[name](argument)

    def binary(self, name: str, left: arb_series, right: arb_series) -> arb_series:
        """An operation on two series."""
        if name == "add":
            return left + right
        if name == "sub":
            return left - right
        return left * right if name == "mul" else left / right


_BINARY: Mapping[str, Callable[..., Any]] = {
    "add": operator.add,
    "sub": operator.sub,
    "mul": operator.mul,
    "div": operator.truediv,
}
BALLS: Mapping[str, Callable[..., Any]] = {
    **_UNARY,
    **_BINARY,
    "sin_cos": arb.sin_cos,
    "integer": arb,
}
"""The operations of ``BallArithmetic`` by name."""
SERIES: Mapping[str, Callable[..., Any]] = {
    **_SERIES,
    **_BINARY,
    "fabs": _absolute,
    "sign": _slope,
    "sin_cos": arb_series.sin_cos,
    "integer": lambda value: arb_series([value]),
}
"""The operations of ``SeriesArithmetic`` by name."""


def scalar_balls(nodes: Sequence[ScalarNode], theta: Sequence[arb]) -> list[arb]:
    """A ball around every scalar of a robot, for parameters given as balls."""
    names = {"+": "add", "-": "sub", "*": "mul", "/": "div"}
    arithmetic = BallArithmetic()

    def leaf(node: Constant | PiConstant | ParameterLeaf) -> arb:
        return theta[node.index] if isinstance(node, ParameterLeaf) else constant_ball(node)

    def apply(node: Apply, arguments: list[arb]) -> arb:
        if node.operation == "^":
            return arguments[0] ** node.exponent
        if len(arguments) == 2:
            return arithmetic.binary(names[node.operation], *arguments)
        return arithmetic.unary(node.operation, arguments[0])

    return read_scalars(nodes, leaf, apply)
