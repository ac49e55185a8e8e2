"""Rational bounds of closed scalar expressions, including irrational ones.

Source: Moore, Kearfott & Cloud, *Introduction to Interval Analysis* (outward rounding).
"""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction
from operator import add, mul, sub, truediv
from typing import TYPE_CHECKING, TypeAlias

from grammar_lang import ir
from grammar_lang.ir import constants

if TYPE_CHECKING:
    from flint import arb

Bounds: TypeAlias = tuple[Fraction, Fraction]

PRECISION = 256
"""The precision, in bits, of enclosures of irrational numbers."""
DIGITS = 40
"""The number of significant decimal digits of the bounds."""


def rational_bounds(expr: ir.Expr) -> Bounds | None:
    """Rational bounds of a closed scalar expression; equal if it is evidently rational.

    None if the expression has no finite value, or if its sign cannot be determined.
    """
    exact = constants.evident(expr)
    if exact is not None and exact[0] > 0:
        return constants.rational_bounds(exact)
    if exact is not None:
        lower, upper = constants.rational_bounds((-exact[0], exact[1]))
        return -upper, -lower
    # Only irrational numbers need this library; without them, loading stays fast.
    from flint import ctx

    before, ctx.prec = ctx.prec, PRECISION
    try:
        value = _ball(expr)
        if not value.is_finite() or not (value > 0 or value < 0):
            return None
        lower, upper = _fraction(value.lower()), _fraction(value.upper())
    finally:
        ctx.prec = before
    grid = Fraction(10) ** (DIGITS - _magnitude(lower))
    return math.floor(lower * grid) / grid, math.ceil(upper * grid) / grid


def _magnitude(value: Fraction) -> int:
    """The least n with |value| <= 10^n, for a value that may be beyond the range of doubles."""
    size, ten = abs(value), Fraction(10)
    bits = size.numerator.bit_length() - size.denominator.bit_length() - 1  # size > 2^bits
    found = math.floor(bits * math.log10(2)) - 1
    while ten**found < size:
        found += 1
    return found


_OPERATORS: dict[ir.Operator, Callable[[arb, arb], arb]] = {
    "+": add,
    "-": sub,
    "*": mul,
    "/": truediv,
    "^": pow,
}


def _ball(expr: ir.Expr) -> arb:
    from flint import arb, fmpq

    match expr:
        case ir.Num(value=q):
            return arb(fmpq(q.numerator, q.denominator))
        case ir.Pi():
            return arb.pi()
        case ir.Unary(function="neg" | "abs" as function, operand=operand):
            return -_ball(operand) if function == "neg" else abs(_ball(operand))
        case ir.Unary(function=function, operand=operand):
            value: arb = getattr(_ball(operand), function)()
            return value
        case ir.Binary(operator=operator, left=left, right=right):
            return _OPERATORS[operator](_ball(left), _ball(right))
        case _:
            raise ValueError("the expression is not a closed scalar")


def _fraction(point: arb) -> Fraction:
    """The value of a ball of radius zero."""
    mantissa, exponent = point.man_exp()
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)
