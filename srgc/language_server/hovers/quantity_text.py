"""Numbers and quantities as text for hovers."""

from __future__ import annotations

from fractions import Fraction

from grammar_lang import ir
from grammar_lang.ir import constants
from grammar_lang.ir.expression_text import expression_text, number_text
from grammar_lang.units import Unit, symbol

_DIGITS = 6


def rounded(value: float) -> str:
    """Six significant digits."""
    return f"{value:.{_DIGITS}g}"


def _exactly(value: Fraction, power: int) -> str:
    """``q * pi^k``."""
    pi = "pi" if power == 1 else f"pi^{power}"
    if not power:
        return number_text(value)
    return pi if value == 1 else f"{number_text(value)}*{pi}"


def in_si(value: Fraction, unit: Unit) -> str:
    """A number with a unit, in SI units: exactly, and rounded where that is not the same."""
    total = value * unit.factor
    exact = _exactly(total, unit.pi_power)
    si = symbol(unit.dimension, angular=unit.angular)
    near = rounded(float(total) * 3.141592653589793**unit.pi_power)
    shown = exact if exact == near else f"{exact} ≈ {near}"
    return shown if si == "1" else f"{shown} {si}"


def closed_text(expression: ir.Expr) -> str:
    """A closed expression: rounded, with its exact form where that is short."""
    exact = expression_text(expression, lambda _: "")
    exact = exact.replace("-1 * pi", "-pi")
    try:
        near = rounded(constants.to_float(expression))
    except ValueError:
        return exact
    return near if near == exact or len(exact) > 20 else f"{exact} ≈ {near}"


def domain_text(domain: ir.Interval | ir.Choices, unit: str) -> str:
    """An interval or a set, in SI units."""
    after = "" if unit in {"", "1"} else f" {unit}"
    if isinstance(domain, ir.Interval):
        return f"[{closed_text(domain.lower)}, {closed_text(domain.upper)}]{after}"
    return f"{{{', '.join(map(closed_text, domain.values))}}}{after}"
