"""Monomials ``q * pi**k`` with rational q: what is seen of the value of a closed scalar."""

from __future__ import annotations

from fractions import Fraction
from typing import TypeAlias

from compiler.expressions.evaluator import Evaluator
from grammar_lang import ir
from grammar_lang.ir.constants import MagnitudeError, Monomial, apply, combine

Known: TypeAlias = Monomial | None


class MonomialEvaluator(Evaluator[Known]):
    """Values are monomials; None where a value is not seen to be one, or is too large a number."""

    def constant(self, value: Fraction | int) -> Known:
        """A rational."""
        return Fraction(value), 0

    def pi(self) -> Known:
        """The number pi."""
        return Fraction(1), 1

    def add(self, left: Known, right: Known, /) -> Known:
        """The sum."""
        return _combined("+", left, right)

    def sub(self, left: Known, right: Known, /) -> Known:
        """The difference."""
        return _combined("-", left, right)

    def mul(self, left: Known, right: Known, /) -> Known:
        """The product."""
        return _combined("*", left, right)

    def div(self, left: Known, right: Known, /) -> Known:
        """The quotient."""
        return _combined("/", left, right)

    def power(self, base: Known, exponent: int, /) -> Known:
        """An integer power."""
        return _combined("^", base, (Fraction(exponent), 0))

    def neg(self, argument: Known, /) -> Known:
        """The opposite."""
        return _applied("neg", argument)

    def fabs(self, argument: Known, /) -> Known:
        """The absolute value."""
        return _applied("abs", argument)

    def sqrt(self, argument: Known, /) -> Known:
        """The square root."""
        return _applied("sqrt", argument)

    def sin(self, argument: Known, /) -> Known:
        """The sine."""
        return _applied("sin", argument)

    def cos(self, argument: Known, /) -> Known:
        """The cosine."""
        return _applied("cos", argument)

    def tan(self, argument: Known, /) -> Known:
        """The tangent."""
        return _applied("tan", argument)


def _combined(operator: ir.Operator, left: Known, right: Known) -> Known:
    if left is None or right is None:
        return None
    try:
        return combine(operator, left, right)
    except MagnitudeError:
        return None


def _applied(function: ir.Function, argument: Known) -> Known:
    if argument is None:
        return None
    try:
        return apply(function, argument)
    except MagnitudeError:
        return None
