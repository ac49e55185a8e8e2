"""The exact value of a parameter that a decimal states.

A decimal states a rational value exactly.  No decimal is an angle of 45 degrees in radians: such a
choice, or such an end of a range, is stated by a decimal near it, and the value is the exact one.
"""

from __future__ import annotations

from fractions import Fraction
from typing import TypeAlias

from flint import arb

from compiler.expressions.evaluators.balls import ball, closed_ball, working_precision
from grammar_lang import ir
from grammar_lang.ir.constants import rational

NEAR = Fraction(1, 10**9)
"""How closely a decimal must state a value that no decimal is, in SI."""
PRECISION = 128

ExactValue: TypeAlias = "Fraction | ir.Expr"
"""A rational, or a closed scalar expression."""


def value_ball(value: ExactValue) -> arb:
    """A ball around a value."""
    return ball(value) if isinstance(value, Fraction) else closed_ball(value)


def stated_value(domain: ir.Interval | ir.Choices, stated: Fraction) -> ExactValue | None:
    """The value of a domain that a rational states; None if it states none."""
    with working_precision(PRECISION):
        if isinstance(domain, ir.Choices):
            if any(rational(choice) == stated for choice in domain.values):
                return stated
            return _nearby(domain.values, stated)
        if _not_above(domain.lower, stated) and _not_above(stated, domain.upper):
            return stated
        return _nearby((domain.lower, domain.upper), stated)


def _nearby(values: tuple[ir.Expr, ...], stated: Fraction) -> ir.Expr | None:
    """The first irrational value that a rational states."""
    for value in values:
        if rational(value) is None and abs(closed_ball(value) - ball(stated)) < ball(NEAR):
            return value
    return None


def _not_above(a: ExactValue, b: ExactValue) -> bool:
    """Whether a <= b certainly, exactly where both are rational."""
    left, right = (item if isinstance(item, Fraction) else rational(item) for item in (a, b))
    if left is not None and right is not None:
        return left <= right
    return bool(value_ball(a) <= value_ball(b))
