"""The parts of a formula."""

from __future__ import annotations

from collections.abc import Iterator
from typing import assert_never

from grammar_lang import ir


def operands(formula: ir.Formula) -> tuple[ir.Formula, ...]:
    """The direct subformulas, from left to right."""
    match formula:
        case ir.Atom():
            return ()
        case ir.And(operands=parts) | ir.Or(operands=parts):
            return parts
        case ir.Implies(left=left, right=right) | ir.Until(left=left, right=right):
            return left, right
        case (
            ir.Not(operand=part)
            | ir.Always(operand=part)
            | ir.Eventually(operand=part)
            | ir.Next(operand=part)
            | ir.Last(operand=part)
        ):
            return (part,)
        case _:
            assert_never(formula)


def subformulas(formula: ir.Formula) -> Iterator[ir.Formula]:
    """The formula and all its parts, from the outside in and from left to right."""
    pending = [formula]
    while pending:
        found = pending.pop()
        yield found
        pending += reversed(operands(found))


def atoms(*formulas: ir.Formula) -> tuple[ir.Atom, ...]:
    """The different atoms of formulas, in the order of their first occurrence."""
    found = {
        part: None
        for formula in formulas
        for part in subformulas(formula)
        if isinstance(part, ir.Atom)
    }
    return tuple(found)
