"""Ranges and finite sets of values as text."""

from __future__ import annotations

from collections.abc import Sequence

from grammar_lang import ir
from grammar_lang.ir.constants import MagnitudeError, Monomial, monomial
from grammar_lang.ir.expression_text import expression_text, number_text

DEGREES = 180


def domain_text(domain: ir.Interval | ir.Choices | None, unit: str) -> str:
    """``in [0.5, 5] m``, ``in {1, 2} m`` or ``unbounded``; multiples of pi in degrees.

    ``unit`` is that of the bare numbers, empty for none.
    """
    if domain is None:
        return "unbounded"
    ends = (domain.lower, domain.upper) if isinstance(domain, ir.Interval) else domain.values
    texts, unit = _values(ends, unit)
    inside = ", ".join(texts)
    bracketed = f"[{inside}]" if isinstance(domain, ir.Interval) else f"{{{inside}}}"
    return f"in {bracketed} {'' if unit == '1' else unit}".rstrip()


def _values(values: Sequence[ir.Expr], unit: str) -> tuple[list[str], str]:
    exact = [_exact(value) for value in values]
    if unit.startswith("rad") or not unit:
        known = [q for q, k in filter(None, exact) if k == 1 or not q]
        if len(known) == len(values) and any(known):
            degrees = unit.replace("rad", "deg", 1) or "deg"
            return [number_text(value * DEGREES) for value in known], degrees
    return [
        number_text(found[0]) if found is not None and found[1] == 0 else closed_text(value)
        for value, found in zip(values, exact, strict=True)
    ], unit


def _exact(value: ir.Expr) -> Monomial | None:
    try:
        return monomial(value)
    except MagnitudeError:
        return None


def closed_text(value: ir.Expr) -> str:
    """A closed expression."""
    return expression_text(value, str)
