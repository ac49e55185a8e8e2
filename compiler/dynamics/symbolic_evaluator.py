"""CasADi expressions: the evaluator that builds the graph, and the conditions for its values.

Every literal that is not an integer, and pi, is a symbolic input of the graph, because CasADi folds
constants in doubles: a validated evaluator must be able to insert their exact values.

CasADi simplifies while a graph grows (x / x is 1, 0 * x is 0), so its values may exist where those
of the original expressions do not. The conditions are therefore kept separately, each taken from
its own operand before anything around it is simplified.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from fractions import Fraction

import casadi as ca

from compiler.expressions.evaluator import Evaluator
from compiler.expressions.scalars import Constant, PiConstant

NEVER_NEGATIVE = {ca.OP_SQ, ca.OP_FABS, ca.OP_SQRT}
CLOSED = {ca.OP_ADD, ca.OP_MUL, ca.OP_DIV}
"""Operations whose result is not negative if their arguments are not."""


@dataclass(slots=True)
class Conditions:
    """The operands on which the existence of a graph's values depends."""

    divisors: list[ca.SX] = field(default_factory=list[ca.SX])
    radicands: list[ca.SX] = field(default_factory=list[ca.SX])

    def divisor(self, operand: ca.SX) -> None:
        """Record a divisor; a literal other than zero needs no record."""
        if not operand.is_constant() or operand.is_zero():
            self.divisors.append(operand)

    def radicand(self, operand: ca.SX, is_positive: Callable[[ca.SX], bool]) -> None:
        """Record a radicand; a square, for example, needs no record."""
        if not never_negative(operand, is_positive):
            self.radicands.append(operand)

    def vector(self) -> ca.SX:
        """Divisors, then radicands, as one column."""
        both = [*self.divisors, *self.radicands]
        return ca.vertcat(*both) if both else ca.SX(0, 1)


def never_negative(expression: ca.SX, is_positive: Callable[[ca.SX], bool]) -> bool:
    """Whether an expression is recognised as non-negative wherever it has a value.

    ``is_positive`` decides this for the symbols of constants.
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


@dataclass(slots=True)
class SymbolicEvaluator(Evaluator[ca.SX]):
    """Values are CasADi expressions; the evaluator keeps the inputs that stand for constants.

    It also keeps the conditions under which the values exist.
    """

    symbols: dict[Constant | PiConstant, ca.SX] = field(
        default_factory=dict[Constant | PiConstant, ca.SX]
    )
    conditions: Conditions = field(default_factory=Conditions)

    def constant(self, value: Fraction | int) -> ca.SX:
        """A number if it is -1, 0 or 1, else an input.

        CasADi folds products of literals in doubles: only these numbers always stay exact.
        """
        return ca.SX(int(value)) if value in (-1, 0, 1) else self._input(Constant(Fraction(value)))

    def pi(self) -> ca.SX:
        """The input that stands for pi."""
        return self._input(PiConstant())

    def div(self, dividend: ca.SX, divisor: ca.SX, /) -> ca.SX:
        """A quotient, with the condition that it exists."""
        self.conditions.divisor(divisor)
        return self.unfolded(dividend) / self.unfolded(divisor)

    def power(self, base: ca.SX, exponent: int, /) -> ca.SX:
        """An integer power by repeated squaring, with the condition that it exists."""
        if exponent < 0:
            self.conditions.divisor(base)
        result, square, left = ca.SX(1), self.unfolded(base), abs(exponent)
        while left:
            if left & 1:
                result = result * square
            square, left = square * square, left >> 1
        return result if exponent >= 0 else 1 / result

    def sqrt(self, argument: ca.SX, /) -> ca.SX:
        """A square root, with the condition that it exists."""
        argument = self.unfolded(argument)
        self.conditions.radicand(argument, self._is_positive)
        return ca.sqrt(argument)

    def sin(self, argument: ca.SX, /) -> ca.SX:
        """The sine."""
        return ca.sin(self.unfolded(argument))

    def cos(self, argument: ca.SX, /) -> ca.SX:
        """The cosine."""
        return ca.cos(self.unfolded(argument))

    def tan(self, argument: ca.SX, /) -> ca.SX:
        """The tangent, with the condition that it exists."""
        argument = self.unfolded(argument)
        self.conditions.divisor(ca.cos(argument))
        return ca.tan(argument)

    def neg(self, argument: ca.SX, /) -> ca.SX:
        """The negation."""
        return -argument

    def fabs(self, argument: ca.SX, /) -> ca.SX:
        """The absolute value."""
        return ca.fabs(argument)

    def add(self, left: ca.SX, right: ca.SX, /) -> ca.SX:
        """The sum."""
        return left + right

    def sub(self, left: ca.SX, right: ca.SX, /) -> ca.SX:
        """The difference."""
        return left - right

    def mul(self, left: ca.SX, right: ca.SX, /) -> ca.SX:
        """The product."""
        return left * right

    def _is_positive(self, symbol: ca.SX) -> bool:
        """Whether a symbol stands for a constant that is not negative."""
        names = {str(entry): constant for constant, entry in self.symbols.items()}
        constant = names.get(str(symbol))
        return constant is not None and (isinstance(constant, PiConstant) or constant.value >= 0)

    def unfolded(self, expression: ca.SX) -> ca.SX:
        """The expression itself, but an input in place of a literal other than zero.

        Integers stay exact only under sums and products: CasADi folds 1 / 3 and sqrt(2) in doubles.
        A literal that is not finite stays: a condition on its divisor reports it.
        """
        if not expression.is_constant() or expression.is_zero() or not expression.is_regular():
            return expression
        return self._input(Constant(Fraction(float(expression))))

    def _input(self, constant: Constant | PiConstant) -> ca.SX:
        if constant not in self.symbols:
            self.symbols[constant] = ca.SX.sym(f"k{len(self.symbols)}")
        return self.symbols[constant]

    def vector(self) -> ca.SX:
        """All constant inputs as one column."""
        return ca.vertcat(*self.symbols.values()) if self.symbols else ca.SX(0, 1)
