"""The parts of a formula that speak of one instant only, and their value there."""

from __future__ import annotations

from collections.abc import Mapping

from compiler.specifications.monitor import AtomKey, key
from compiler.specifications.subformulas import operands
from grammar_lang import ir

_CONNECTIVES = ir.Not | ir.And | ir.Or | ir.Implies


def boolean_parts(formula: ir.Formula) -> tuple[ir.Formula, ...]:
    """The largest parts without operators of time, atoms excepted, from left to right."""
    found: dict[ir.Formula, None] = {}
    if _timeless(formula, found):
        found[formula] = None
    return tuple(part for part in found if not isinstance(part, ir.Atom))


def _timeless(formula: ir.Formula, found: dict[ir.Formula, None]) -> bool:
    """Whether a formula has no operator of time; if it has, its timeless operands are found."""
    parts = operands(formula)
    timeless = [_timeless(part, found) for part in parts]
    if isinstance(formula, ir.Atom) or (isinstance(formula, _CONNECTIVES) and all(timeless)):
        return True
    found.update((part, None) for part, alone in zip(parts, timeless, strict=True) if alone)
    return False


def boolean_value(formula: ir.Formula, values: Mapping[AtomKey, bool]) -> bool:
    """The value of a formula without operators of time, given those of its atoms.

    Raises:
        ValueError: it has such an operator.
    """
    if isinstance(formula, ir.Atom):
        return values[key(formula)]
    parts = (boolean_value(part, values) for part in operands(formula))
    match formula:
        case ir.Not():
            return not next(parts)
        case ir.And():
            return all(parts)
        case ir.Or():
            return any(parts)
        case ir.Implies():
            return not next(parts) or next(parts)
        case _:
            raise ValueError("the formula speaks of several instants")
