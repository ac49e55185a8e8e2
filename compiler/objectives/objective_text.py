"""Objectives in words."""

from __future__ import annotations

from decimal import ROUND_CEILING, Context, Decimal
from fractions import Fraction

from compiler.expressions.exact_numbers import exact_text
from grammar_lang import ir

LONGEST = 12
"""Numbers with more digits are rounded for readers."""
LEAST_GAP = Fraction(1, 10_000)
"""Gaps below this percentage are not distinguished."""
UNITS = {"modules": "", "mass": "kg", "time": "s", "energy": "J", "effort": ""}


def objective_text(objective: ir.Objective) -> str:
    """An objective as it is written, without its tolerance."""
    return f"sum({objective.attribute})" if objective.kind == "sum" else objective.kind


def objective_name(objective: ir.Objective) -> str:
    """The minimised quantity in a sentence: an attribute by its own name."""
    return objective.attribute or objective.kind


def objective_unit(objective: ir.Objective) -> str:
    """The SI unit of its values; "" if it has none."""
    return objective.unit if objective.kind == "sum" else UNITS[objective.kind]


def amount_text(objective: ir.Objective, value: Fraction, relation: str = "") -> str:
    """An objective with its value, as "price 120" or "mass 2.31 kg", joined by a ``relation``."""
    words = [objective_name(objective), relation, value_text(objective, value)]
    return " ".join(word for word in words if word)


def value_text(objective: ir.Objective, value: Fraction) -> str:
    """A value of an objective with its unit, as "2.31 kg"; a share in percent."""
    is_share = objective.kind == "effort"
    unit = "%" if is_share else objective_unit(objective)
    shown = 100 * value if is_share else value
    exact = exact_text(shown)
    number = exact if len(exact) <= LONGEST else f"{float(shown):.6g}"
    return f"{number}{' ' if unit else ''}{unit}"


def gap_text(gap: Fraction) -> str:
    """A gap in percent, rounded up to two digits, if it is not tiny."""
    percent = 100 * gap
    if 0 < percent < LEAST_GAP:
        return f"below {float(LEAST_GAP):g} %"
    digits = Context(prec=2, rounding=ROUND_CEILING)
    return f"{digits.divide(Decimal(percent.numerator), Decimal(percent.denominator)):f} %"
