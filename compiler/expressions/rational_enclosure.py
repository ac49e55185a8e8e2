"""Rational intervals that contain real numbers: exact where seen to be, else rounded outwards.

Source: Moore, Kearfott & Cloud, *Introduction to Interval Analysis* (outward rounding).
"""

from __future__ import annotations

import math
from fractions import Fraction
from typing import TypeAlias

from flint import arb

from compiler.expressions.evaluators.balls import closed_ball
from grammar_lang import ir
from grammar_lang.ir.constants import MagnitudeError, monomial

GRID = 10**9

Bounds: TypeAlias = tuple[Fraction, Fraction]


def exact_rational(expression: ir.Expr) -> Fraction | None:
    """The value of a closed scalar expression where it is seen to be rational."""
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
    """Rationals below and above a closed scalar expression, equal where it is seen to be rational.

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
