"""Expression graphs in validated arithmetic: balls, matrices of balls and Taylor series."""

from __future__ import annotations

import math
import operator
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from fractions import Fraction
from threading import RLock
from typing import Any, ClassVar, TypeVar

from flint import arb, arb_mat, arb_series, ctx, fmpq

from compiler.expressions.evaluator import Evaluator, evaluate_expression
from compiler.expressions.scalars import (
    Constant,
    PiConstant,
    ScalarNode,
    evaluate_constant,
    evaluate_scalars,
)
from grammar_lang import ir

# --- Balls: expression graphs in validated arithmetic ---------------------------------------------
#
# Every ball contains the exact value; floats are never compared with a tolerance.


Value = TypeVar("Value")

_CONTEXT = RLock()
"""flint has one context for all threads; a lock keeps other threads from changing it.

If another thread cuts a series short, its coefficients are 0 where they should not be, and the
enclosures computed from it are wrong.
"""


def below(value: arb) -> float:
    """The largest double below all values of a ball; -inf if nothing is known about them."""
    low = value.lower()
    near = float(low)
    if math.isnan(near):
        return -math.inf
    return math.nextafter(near, -math.inf) if near > low else near


@contextmanager
def working_precision(bits: int) -> Iterator[None]:
    """Ball arithmetic with ``bits`` bits within the block; other threads wait until it ends."""
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


def sign_ball(a: arb) -> arb:
    """The sign, which is also the slope of the absolute value; [-1, 1] if it is not certain."""
    if a > 0:
        return arb(1)
    return arb(-1) if a < 0 else arb(0, 1)


def square(a: Any) -> Any:
    """The square, of a ball or of a series of balls."""
    return a * a


def inverse(a: Any) -> Any:
    """The reciprocal, of a ball or of a series of balls."""
    return 1 / a


def double(a: Any) -> Any:
    """Twice a ball or a series of balls."""
    return a + a


def _constant(value: Fraction | int) -> arb:
    return arb(value) if isinstance(value, int) else ball(value)


class _Operators(Evaluator[Value]):
    """The operations that flint writes the same way for balls and for series of balls."""

    neg: ClassVar[Any] = staticmethod(operator.neg)
    sq: ClassVar[Any] = staticmethod(square)
    inv: ClassVar[Any] = staticmethod(inverse)
    twice: ClassVar[Any] = staticmethod(double)
    add: ClassVar[Any] = staticmethod(operator.add)
    sub: ClassVar[Any] = staticmethod(operator.sub)
    mul: ClassVar[Any] = staticmethod(operator.mul)
    div: ClassVar[Any] = staticmethod(operator.truediv)


class BallEvaluator(_Operators[arb]):
    """Values are balls that contain the exact values; flint's functions are called directly."""

    fabs: ClassVar[Any] = staticmethod(abs)
    sqrt: ClassVar[Any] = staticmethod(arb.sqrt)
    sin: ClassVar[Any] = staticmethod(arb.sin)
    cos: ClassVar[Any] = staticmethod(arb.cos)
    sin_cos: ClassVar[Any] = staticmethod(arb.sin_cos)
    tan: ClassVar[Any] = staticmethod(arb.tan)
    sign: ClassVar[Any] = staticmethod(sign_ball)
    power: ClassVar[Any] = staticmethod(operator.pow)
    constant: ClassVar[Any] = staticmethod(_constant)
    pi: ClassVar[Any] = staticmethod(arb.pi)


BALLS = BallEvaluator()


def constant_ball(constant: Constant | PiConstant) -> arb:
    """A ball around a constant of a graph."""
    return evaluate_constant(constant, BALLS)


def closed_ball(expression: ir.Expr) -> arb:
    """A ball around a closed scalar expression.

    Raises:
        ValueError: the expression is not a closed scalar.
    """
    return evaluate_expression(expression, BALLS)


def scalar_balls(nodes: Sequence[ScalarNode], theta: Sequence[arb]) -> list[arb]:
    """A ball around every scalar of a robot, for parameters given as balls."""
    return evaluate_scalars(nodes, BALLS, theta)


# --- Matrices of balls, entry by entry ------------------------------------------------------------


SIGNS = arb(0, 1)
"""The ball [-1, 1]."""


def column(entries: Sequence[arb]) -> arb_mat:
    """A matrix of one column."""
    return arb_mat(len(entries), 1, list(entries))


def column_of_ones(size: int) -> arb_mat:
    """The column of ones, by which a matrix is multiplied to add up its columns."""
    return arb_mat(size, 1, [arb(1)] * size)


def identity(size: int) -> arb_mat:
    """The identity matrix."""
    return arb_mat([[arb(int(i == j)) for j in range(size)] for i in range(size)])


def diagonal(entries: Sequence[arb]) -> arb_mat:
    """A diagonal matrix."""
    size = len(entries)
    return arb_mat([[entries[i] if i == j else arb(0) for j in range(size)] for i in range(size)])


def beside(left: arb_mat, right: arb_mat) -> arb_mat:
    """Two matrices side by side."""
    return arb_mat([a + b for a, b in zip(left.tolist(), right.tolist(), strict=True)])


def absolute(matrix: arb_mat) -> arb_mat:
    """Exact upper bounds of the absolute values of the entries."""
    entries = [item.abs_upper() for item in matrix.entries()]
    return arb_mat(matrix.nrows(), matrix.ncols(), entries)


def both_signs(bounds: arb_mat) -> arb_mat:
    """A ball matrix that contains all matrices whose entries are within the bounds."""
    entries = [SIGNS * item for item in bounds.entries()]
    return arb_mat(bounds.nrows(), bounds.ncols(), entries)


def rows(matrix: arb_mat, first: int, last: int) -> arb_mat:
    """The rows ``first`` to ``last`` - 1."""
    width = matrix.ncols()
    return arb_mat(last - first, width, matrix.entries()[first * width : last * width])


def stacked(upper: arb_mat, lower: arb_mat) -> arb_mat:
    """One matrix above another."""
    height = upper.nrows() + lower.nrows()
    return arb_mat(height, upper.ncols(), upper.entries() + lower.entries())


# --- Power series of balls: Taylor coefficients of an expression graph along a path ---------------


class UncertainSignError(ValueError):
    """An absolute value has a kink within a ball, so no higher Taylor coefficients exist."""


def _absolute(a: arb_series) -> arb_series:
    """The absolute value; if the sign is uncertain, up to the first order (Clarke's gradient).

    For a Lipschitz function the Taylor polynomial of degree one with its integral remainder still
    holds, since its derivative exists almost everywhere and lies in the hull of both slopes.
    """
    sign = sign_ball(a[0])
    if sign.is_exact():
        return sign * a
    if len(a) > 1 and ctx.cap > 2:
        raise UncertainSignError("the sign under an absolute value is not certain")
    return arb_series([abs(a[0]), sign * a[1]])


def _slope(a: arb_series) -> arb_series:
    """The sign, which is piecewise constant."""
    sign = sign_ball(a[0])
    if not sign.is_exact() and len(a) > 1 and ctx.cap > 1:
        raise UncertainSignError("the sign under an absolute value is not certain")
    return arb_series([sign])


def _constant_series(value: Fraction | int) -> arb_series:
    return arb_series([value if isinstance(value, int) else ball(value)])


def _smooth_absolute(a: arb) -> arb:
    return a * _smooth_sign(a)


def _smooth_sign(a: arb) -> arb:
    sign = sign_ball(a)
    if not sign.is_exact():
        raise UncertainSignError("the sign under an absolute value is not certain")
    return sign


class SmoothBallEvaluator(BallEvaluator):
    """Balls on which every absolute value is smooth; otherwise raises ``UncertainSignError``."""

    fabs: ClassVar[Any] = staticmethod(_smooth_absolute)
    sign: ClassVar[Any] = staticmethod(_smooth_sign)


SMOOTH_BALLS = SmoothBallEvaluator()


class SeriesEvaluator(_Operators[arb_series]):
    """Values are series truncated at the working length, with balls as coefficients.

    Raises ``UncertainSignError`` if an absolute value, or its slope, is not smooth up to the order
    asked for.
    """

    fabs: ClassVar[Any] = staticmethod(_absolute)
    sqrt: ClassVar[Any] = staticmethod(arb_series.sqrt)
    sin: ClassVar[Any] = staticmethod(arb_series.sin)
    cos: ClassVar[Any] = staticmethod(arb_series.cos)
    sin_cos: ClassVar[Any] = staticmethod(arb_series.sin_cos)
    tan: ClassVar[Any] = staticmethod(arb_series.tan)
    sign: ClassVar[Any] = staticmethod(_slope)
    constant: ClassVar[Any] = staticmethod(_constant_series)

    def pi(self) -> arb_series:
        """The constant series pi."""
        return arb_series([arb.pi()])


SERIES = SeriesEvaluator()
