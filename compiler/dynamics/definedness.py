"""Where expressions have a value: no divisor is zero, no radicand negative.

CasADi simplifies while a graph grows (x / x is 1, 0 * x is 0), so that its values may exist where
those of the expressions that were written do not.  The conditions are kept beside the graph, each
taken from its own operand before anything around it is simplified.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import casadi as ca

NEVER_NEGATIVE = {ca.OP_SQ, ca.OP_FABS, ca.OP_SQRT}
CLOSED = {ca.OP_ADD, ca.OP_MUL, ca.OP_DIV}
"""Operations on numbers that are not negative whose result is not."""


@dataclass(slots=True)
class Conditions:
    """The operands on which a graph's values depend for their existence."""

    divisors: list[ca.SX] = field(default_factory=list[ca.SX])
    radicands: list[ca.SX] = field(default_factory=list[ca.SX])

    def divisor(self, operand: ca.SX) -> None:
        """Take note of a divisor; a literal other than zero needs none."""
        if not operand.is_constant() or operand.is_zero():
            self.divisors.append(operand)

    def radicand(self, operand: ca.SX, is_positive: Callable[[ca.SX], bool]) -> None:
        """Take note of a radicand; a square, say, needs none."""
        if not never_negative(operand, is_positive):
            self.radicands.append(operand)

    def vector(self) -> ca.SX:
        """Divisors, then radicands, as one column."""
        both = [*self.divisors, *self.radicands]
        return ca.vertcat(*both) if both else ca.SX(0, 1)


def never_negative(expression: ca.SX, is_positive: Callable[[ca.SX], bool]) -> bool:
    """Whether an expression is seen not to be negative wherever it has a value.

    ``is_positive`` judges the symbols of constants.
    """
    todo = [expression]
    while todo:
        current = todo.pop()
        if current.is_constant():
            if float(current) < 0:
                return False
        elif current.is_symbolic():
            if not is_positive(current):
                return False
        elif current.op() in CLOSED:
            todo += [current.dep(0), current.dep(1)]
        elif current.op() not in NEVER_NEGATIVE:
            return False
    return True
