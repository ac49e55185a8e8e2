"""Power series of balls: Taylor coefficients of an expression graph along a path."""

from __future__ import annotations

import operator
from fractions import Fraction
from typing import Any, ClassVar

from flint import arb, arb_series, ctx

from compiler.expressions.evaluator import Evaluator
from compiler.expressions.evaluators.balls import ball, double, inverse, sign_ball, square


class UncertainSignError(ValueError):
    """An absolute value has a kink within a ball: its Taylor coefficients end at the first."""


def _absolute(a: arb_series) -> arb_series:
    """The absolute value; where the sign is uncertain, up to the first order (Clarke's gradient).

    Of a Lipschitz function the Taylor polynomial of degree one with its integral remainder still
    holds, since its derivative exists almost everywhere and lies in the hull of both slopes.
    """
    sign = sign_ball(a[0])
    if sign.is_exact():
        return sign * a
    if len(a) > 1 and ctx.cap > 2:
        raise UncertainSignError("the sign under an absolute value is not certain")
    return arb_series([abs(a[0]), sign * a[1]])


def _slope(a: arb_series) -> arb_series:
    """The sign, piecewise constant."""
    sign = sign_ball(a[0])
    if not sign.is_exact() and len(a) > 1 and ctx.cap > 1:
        raise UncertainSignError("the sign under an absolute value is not certain")
    return arb_series([sign])


def _constant(value: Fraction | int) -> arb_series:
    return arb_series([value if isinstance(value, int) else ball(value)])


class SeriesEvaluator(Evaluator[arb_series]):
    """Values are series truncated at the working length, with balls as coefficients.

    ``UncertainSignError``: an absolute value, or its slope, is not smooth to the order asked.
    """

    neg: ClassVar[Any] = staticmethod(operator.neg)
    fabs: ClassVar[Any] = staticmethod(_absolute)
    sqrt: ClassVar[Any] = staticmethod(arb_series.sqrt)
    sin: ClassVar[Any] = staticmethod(arb_series.sin)
    cos: ClassVar[Any] = staticmethod(arb_series.cos)
    sin_cos: ClassVar[Any] = staticmethod(arb_series.sin_cos)
    tan: ClassVar[Any] = staticmethod(arb_series.tan)
    sign: ClassVar[Any] = staticmethod(_slope)
    sq: ClassVar[Any] = staticmethod(square)
    inv: ClassVar[Any] = staticmethod(inverse)
    twice: ClassVar[Any] = staticmethod(double)
    add: ClassVar[Any] = staticmethod(operator.add)
    sub: ClassVar[Any] = staticmethod(operator.sub)
    mul: ClassVar[Any] = staticmethod(operator.mul)
    div: ClassVar[Any] = staticmethod(operator.truediv)
    constant: ClassVar[Any] = staticmethod(_constant)

    def pi(self) -> arb_series:
        """The constant series pi."""
        return arb_series([arb.pi()])


SERIES = SeriesEvaluator()
