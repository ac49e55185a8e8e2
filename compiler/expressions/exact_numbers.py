"""Exact rationals and their texts: in files a number is a decimal or a quotient."""

from __future__ import annotations

import math
import re
from fractions import Fraction
from typing import TypeAlias

from flint import arb

from compiler.expressions.evaluators.balls import closed_ball
from grammar_lang import ir
from grammar_lang.ir.constants import MagnitudeError, monomial

MOST_PLACES = 1100
"""A double has at most 1074 decimal places."""

_NUMBER = re.compile(r"-?[0-9]{1,300}(\.[0-9]{1,1100}|/[0-9]{1,300})?")
"""Decimals below 1e300, and quotients; no exponents, since their expansion has no bound."""


def shortest_decimal(value: float) -> Fraction:
    """The rational of the shortest decimal that reads back as this double."""
    return Fraction(repr(float(value)))


def decimal(value: float) -> str:
    """The shortest decimal of a double, without an exponent.

    Raises:
        ValueError: the double is infinite or not a number.
    """
    text = repr(float(value)).removesuffix(".0")
    if "e" in text or "n" in text or text == "-0":
        return exact_decimal(shortest_decimal(value))
    return text  # as almost always: motions of thousands of steps have 100,000 numbers


def exact_decimal(value: Fraction) -> str:
    """The decimal of a rational whose denominator divides a power of ten.

    Raises:
        ValueError: the value is not a finite decimal.
    """
    digits, power = 0, 1
    while power % value.denominator:
        digits, power = digits + 1, power * 10
        if digits > MOST_PLACES:
            raise ValueError(f"{value} is not a finite decimal")
    whole = str(abs(value.numerator) * (power // value.denominator)).rjust(digits + 1, "0")
    sign = "-" if value < 0 else ""
    return sign + (f"{whole[:-digits]}.{whole[-digits:]}" if digits else whole)


def exact_text(value: Fraction) -> str:
    """A rational as a finite decimal if it is one, else as a quotient."""
    try:
        return exact_decimal(value)
    except ValueError:
        return str(value)


def exact_number(text: str) -> Fraction:
    """The rational that a decimal or a quotient of integers denotes.

    Raises:
        ValueError: the text is neither, or the quotient's denominator is zero.
    """
    if not _NUMBER.fullmatch(text):
        shown = text if len(text) <= 40 else f"{text[:40]}..."
        raise ValueError(f"{shown!r} is not an exact number")
    try:
        return Fraction(text)
    except ZeroDivisionError:
        raise ValueError(f"{text!r} divides by zero") from None


# --------------------------------------------------------------------------------------------------
# Rational intervals that contain real numbers: exact if recognised as rational, else rounded
# outwards.
#
# Source: Moore, Kearfott & Cloud, *Introduction to Interval Analysis* (outward rounding).


GRID = 10**9

Bounds: TypeAlias = tuple[Fraction, Fraction]


def exact_rational(expression: ir.Expr) -> Fraction | None:
    """The value of a closed scalar expression if it is recognised as rational, else None."""
    try:
        value = monomial(expression)
    except MagnitudeError:
        return None
    return value[0] if value is not None and value[1] == 0 else None


def outward(ball: arb) -> Bounds | None:
    """Multiples of ``1 / GRID`` below and above a ball; None if it is not finite."""
    if not ball.is_finite():
        return None
    lower, upper = _exact(ball.lower()) * GRID, _exact(ball.upper()) * GRID
    return Fraction(math.floor(lower), GRID), Fraction(math.ceil(upper), GRID)


def rational_bounds(expression: ir.Expr) -> Bounds:
    """Rationals below and above a closed scalar expression, equal if it is recognised as rational.

    Raises:
        ValueError: the expression has no finite value.
    """
    value = exact_rational(expression)
    if value is not None:
        return value, value
    bounds = outward(closed_ball(expression))
    if bounds is None:
        raise ValueError(f"no finite value: {expression}")
    return bounds


def _exact(point: arb) -> Fraction:
    """The value of a ball of radius zero."""
    mantissa, exponent = point.man_exp()
    return Fraction(int(mantissa)) * Fraction(2) ** int(exponent)
