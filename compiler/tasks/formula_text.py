"""Formulas as text of the language."""

from __future__ import annotations

from fractions import Fraction
from typing import assert_never

from grammar_lang import ir

_TIGHT, _UNTIL, _AND, _OR, _IMPLIES = range(1, 6)
"""How tightly operators bind, as the language reference numbers them."""


def formula_text(formula: ir.Formula) -> str:
    """A formula with no more parentheses than it needs, times in seconds."""
    return _text(formula)[0]


def _within(formula: ir.Formula, level: int) -> str:
    """A formula in a place for operators that bind at least as tightly as ``level``."""
    text, own = _text(formula)
    return text if own <= level else f"({text})"


def _text(formula: ir.Formula) -> tuple[str, int]:
    """A formula and how tightly its operator binds."""
    match formula:
        case ir.Atom(region=region, effector=effector, numbered=numbered):
            return (f"{region} by effector {effector}" if numbered else region), 0
        case ir.And(operands=parts):
            return " and ".join(_within(part, _UNTIL) for part in parts), _AND
        case ir.Or(operands=parts):
            return " or ".join(_within(part, _AND) for part in parts), _OR
        case ir.Until(left=left, right=right):
            return f"{_within(left, _TIGHT)} until {_within(right, _UNTIL)}", _UNTIL
        case ir.Implies(left=left, right=right):
            return f"{_within(left, _OR)} implies {_within(right, _IMPLIES)}", _IMPLIES
        case _:
            operator, operand = _prefixed(formula)
            return f"{operator} {_within(operand, _TIGHT)}", _TIGHT


def _prefixed(
    formula: ir.Not | ir.Always | ir.Eventually | ir.Next | ir.Last,
) -> tuple[str, ir.Formula]:
    match formula:
        case ir.Not(operand=operand):
            return "not", operand
        case ir.Always(operand=operand, window=window):
            return f"always{_window(window)}", operand
        case ir.Eventually(operand=operand, window=window):
            return f"eventually{_window(window)}", operand
        case ir.Next(operand=operand):
            return "next", operand
        case ir.Last(operand=operand, duration=duration):
            return f"last[{_seconds(duration)}]", operand
        case _:
            assert_never(formula)


def _window(window: ir.Window) -> str:
    if window.upper is None:
        # No text denotes a window that begins later and has no end; this one people understand.
        return "" if window.lower == 0 else f"[{_seconds(window.lower)}, end]"
    return f"[{_seconds(window.lower)}, {_seconds(window.upper)}]"


def _seconds(time: Fraction) -> str:
    """A time as a decimal where it is one, else as a quotient."""
    rest = time.denominator
    digits = 0
    for prime in (2, 5):
        power = 0
        while rest % prime == 0:
            rest, power = rest // prime, power + 1
        digits = max(digits, power)
    if rest != 1:
        return f"{time.numerator} s / {time.denominator}"
    whole = str(time.numerator * 10**digits // time.denominator).rjust(digits + 1, "0")
    return (f"{whole[:-digits]}.{whole[-digits:]}" if digits else whole) + " s"
