"""Exact values within the domains of parameters: rationals and rational multiples of pi."""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from compiler.expressions.exact_numbers import rational_bounds
from grammar_lang import ir
from grammar_lang.ir.constants import MagnitudeError, monomial
from grammar_lang.ir.expression_text import number_text

MULTIPLES = 100
"""The most multiples that are tried in one range, from its lower end."""


@dataclass(frozen=True, slots=True)
class MultipleOfPi:
    """The number ``factor * pi``; ``factor`` is not zero."""

    factor: Fraction


Value: TypeAlias = Fraction | MultipleOfPi
Domain: TypeAlias = ir.Interval | ir.Choices


def value_text(value: Value) -> str:
    """A value in SI units as text."""
    if isinstance(value, MultipleOfPi):
        return f"{number_text(value.factor)}*pi" if value.factor != 1 else "pi"
    return number_text(value)


def exact_value(expression: ir.Expr) -> Value | None:
    """The value of a closed scalar if recognised as rational or a multiple of pi, else None."""
    try:
        found = monomial(expression)
    except MagnitudeError:
        return None
    if found is None:
        return None
    coefficient, power = found
    if power == 0 or coefficient == 0:
        return coefficient
    return MultipleOfPi(coefficient) if power == 1 else None


def multiple_of_pi(factor: Fraction) -> Value:
    """``factor * pi``."""
    return MultipleOfPi(factor) if factor else Fraction(0)


def named_values(domain: Domain) -> list[Value]:
    """The elements of a finite set or the ends of a range, as far as they are recognised."""
    named = domain.values if isinstance(domain, ir.Choices) else (domain.lower, domain.upper)
    return [value for value in map(exact_value, named) if value is not None]


def contains(domain: Domain, value: Value) -> bool | None:
    """Whether a domain contains a value; None if its bounds are too close to decide."""
    if isinstance(domain, ir.Choices):
        signs = [_sign(choice, value) for choice in domain.values]
        return True if 0 in signs else (None if None in signs else False)
    below, above = _sign(domain.lower, value), _sign(domain.upper, value)
    if below in {-1, 0} and above in {0, 1}:
        return True
    return False if below == 1 or above == -1 else None


def multiples_within(domain: Domain, unit: Fraction) -> tuple[list[Value], bool]:
    """The multiples of ``unit * pi`` in a domain, and whether there are certainly no others."""
    ends = (
        [rational_bounds(choice) for choice in domain.values]
        if isinstance(domain, ir.Choices)
        else [rational_bounds(domain.lower), rational_bounds(domain.upper)]
    )
    low, high = min(least for least, _ in ends), max(most for _, most in ends)
    # 333/106 < pi < 355/113
    widths = [abs(unit) * Fraction(333, 106), abs(unit) * Fraction(355, 113)]
    first = min(math.floor(low / width) for width in widths)
    last = max(math.ceil(high / width) for width in widths)
    all_seen = last - first <= MULTIPLES
    seen = [multiple_of_pi(abs(unit) * k) for k in range(first, min(last, first + MULTIPLES) + 1)]
    answers = [(value, contains(domain, value)) for value in seen]
    sure = all_seen and all(answer is not None for _, answer in answers)
    return [value for value, answer in answers if answer], sure


def domain_text(domain: Domain) -> str:
    """A domain in SI units as text."""
    if isinstance(domain, ir.Choices):
        return "{" + ", ".join(_number(value) for value in domain.values) + "}"
    return f"[{_number(domain.lower)}, {_number(domain.upper)}]"


def _number(expression: ir.Expr) -> str:
    value = exact_value(expression)
    if isinstance(value, Fraction):
        return number_text(value)
    return f"{float(rational_bounds(expression)[0]):.6g}"


def _sign(expression: ir.Expr, value: Value) -> int | None:
    """The sign of a closed scalar minus a value; None if it cannot be decided."""
    if exact_value(expression) == value:
        return 0
    low, high = rational_bounds(expression)
    closed: ir.Expr
    if isinstance(value, MultipleOfPi):
        closed = ir.Binary("*", ir.Num(value.factor), ir.Pi())
    else:
        closed = ir.Num(value)
    least, most = rational_bounds(closed)
    if low > most:
        return 1
    return -1 if high < least else None
