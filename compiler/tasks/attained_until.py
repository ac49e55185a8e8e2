"""``F until G`` with G about closed regions, in an equivalent form that is easier to prove.

A point that moves from F straight into G is, at the instant of the change, on the boundary of
both, which no enclosure decides.  That it is in one of them can be decided.
"""

from __future__ import annotations

from grammar_lang import ir


def attained(formula: ir.Formula) -> ir.Formula:
    """The same formula with ``F or G until G`` for ``F until G`` where G is closed.

    If F or G holds up to an instant of G, there is a first instant of G from now on, since those
    instants make a closed set; before it F holds.
    """
    match formula:
        case ir.Until(left=left, right=right):
            left, right = attained(left), attained(right)
            return ir.Until(ir.Or((*_alternatives(left), right)) if _closed(right) else left, right)
        case ir.And(operands=parts) | ir.Or(operands=parts):
            return type(formula)(tuple(attained(part) for part in parts))
        case ir.Implies(left=left, right=right):
            return ir.Implies(attained(left), attained(right))
        case ir.Always(operand=part, window=window) | ir.Eventually(operand=part, window=window):
            return type(formula)(attained(part), window)
        case ir.Not(operand=part) | ir.Next(operand=part):
            return type(formula)(attained(part))
        case ir.Last(operand=part, duration=duration):
            return ir.Last(duration, attained(part))
        case ir.Atom():
            return formula


def _alternatives(formula: ir.Formula) -> tuple[ir.Formula, ...]:
    return formula.operands if isinstance(formula, ir.Or) else (formula,)


def _closed(formula: ir.Formula) -> bool:
    """Whether a formula certainly holds on a closed set of instants: regions are closed."""
    if isinstance(formula, ir.And | ir.Or):
        return all(_closed(part) for part in formula.operands)
    return isinstance(formula, ir.Atom)
