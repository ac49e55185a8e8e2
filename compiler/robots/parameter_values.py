"""The exact value of a parameter of a robot, as a search claims it and a verifier checks it.

A decimal states a rational value exactly. No decimal equals an angle of 45 degrees in radians: a
choice or an end of a range with such a value is stated by a decimal near it, and the value is the
exact one.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from flint import arb

from compiler.expressions.evaluators.balls import ball, closed_ball, working_precision
from compiler.expressions.exact_numbers import exact_text, shortest_decimal
from compiler.robots.robot import RobotParameter
from grammar_lang import ir
from grammar_lang.ir.constants import rational, to_float

NEAR = Fraction(1, 10**9)
"""How closely a decimal must state a value that is not a decimal, in SI units."""
PRECISION = 128

ExactValue: TypeAlias = "Fraction | ir.Expr"
"""A rational, or a closed scalar expression."""


@dataclass(frozen=True, slots=True)
class ParameterValue:
    """A value of a parameter's domain, in SI units.

    ``exact`` is that value; ``stated`` is the rational that states it in files, equal to ``exact``
    unless that is irrational. As a float it is the double nearest to ``stated``.
    """

    parameter: RobotParameter
    stated: Fraction
    exact: ExactValue

    @property
    def text(self) -> str:
        """The text that states it in files: a finite decimal if there is one, else a quotient."""
        return exact_text(self.stated)

    @property
    def ball(self) -> arb:
        """A ball around it at the working precision."""
        return _ball(self.exact)

    def __float__(self) -> float:
        return float(self.stated)

    def describe(self) -> dict[str, str | int | float]:
        """Its entry in ``design.json``."""
        known = self.parameter
        return {
            "symbol": known.symbol,
            "module": known.module,
            "name": known.name,
            "value": float(self),
            "unit": known.unit,
        }


def stated_value(parameter: RobotParameter, stated: Fraction) -> ParameterValue | None:
    """The value of a parameter's domain that a rational states; None if it states no value."""
    exact = _stated(parameter.domain, stated)
    return None if exact is None else ParameterValue(parameter, stated, exact)


def nearest_value(parameter: RobotParameter, value: float) -> ParameterValue | None:
    """The value of a parameter's domain that a search means by a double; None if none is near.

    Of choices it is the nearest one. In a range it is the shortest decimal of the double, moved to
    the end if rounding has put it beyond. An irrational value is stated by the double next to it.
    """
    near, domain = shortest_decimal(value), parameter.domain
    if isinstance(domain, ir.Choices):
        stated = (_rational_near(choice) for choice in domain.values)
        return stated_value(parameter, min(stated, key=lambda choice: abs(choice - near)))
    lower, upper = rational(domain.lower), rational(domain.upper)
    if lower is not None:
        near = max(near, lower)
    return stated_value(parameter, near if upper is None else min(near, upper))


def nearest_values(
    parameters: Sequence[RobotParameter], theta: Iterable[float]
) -> tuple[ParameterValue, ...] | None:
    """The values that a search means by its array theta (p,); None if a value is not near."""
    pairs = zip(parameters, theta, strict=True)
    values = [nearest_value(parameter, value) for parameter, value in pairs]
    found = tuple(value for value in values if value is not None)
    return found if len(found) == len(values) else None


def _rational_near(value: ir.Expr) -> Fraction:
    exact = rational(value)
    return shortest_decimal(to_float(value)) if exact is None else exact


def _stated(domain: ir.Interval | ir.Choices, stated: Fraction) -> ExactValue | None:
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
    """Whether a <= b for certain, exactly if both are rational."""
    left, right = (item if isinstance(item, Fraction) else rational(item) for item in (a, b))
    if left is not None and right is not None:
        return left <= right
    return bool(_ball(a) <= _ball(b))


def _ball(value: ExactValue) -> arb:
    return ball(value) if isinstance(value, Fraction) else closed_ball(value)
