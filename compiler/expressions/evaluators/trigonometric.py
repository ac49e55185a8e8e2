"""Trigonometric polynomials: an expression graph in canonical form, for readers.

Intermediate results get names if an expression would otherwise be too long. The result is then a
straight-line program whose steps are short polynomials.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction

from compiler.expressions.evaluator import Evaluator
from compiler.expressions.trigonometric_polynomial import (
    Abbreviation,
    Pi,
    PolynomialRing,
    TrigonometricPolynomial,
)

MOST_TERMS = 120
"""An entry with more terms is not shown as one polynomial."""
MOST_PRODUCTS = 10_000
"""The most products of terms formed in search of the canonical form of one function."""
MOST_TERMS_NAMED = 8
"""The most terms of a polynomial before intermediate results get names."""


class TooManyTerms(ArithmeticError):
    """The canonical form is too long to be read."""


@dataclass(slots=True)
class _RingEvaluator(Evaluator[TrigonometricPolynomial]):
    """The operations that do not depend on length."""

    ring: PolynomialRing

    def constant(self, value: Fraction | int) -> TrigonometricPolynomial:
        """A rational."""
        return self.ring.rational(value)

    def pi(self) -> TrigonometricPolynomial:
        """The symbol pi."""
        return self.ring.symbol(Pi())

    def neg(self, argument: TrigonometricPolynomial, /) -> TrigonometricPolynomial:
        """The negation."""
        return self.ring.multiply(argument, self.ring.rational(-1))

    def twice(self, argument: TrigonometricPolynomial, /) -> TrigonometricPolynomial:
        """Twice the argument."""
        return self.ring.multiply(argument, self.ring.rational(2))

    def inv(self, argument: TrigonometricPolynomial, /) -> TrigonometricPolynomial:
        """The reciprocal."""
        return self.ring.inverse(self._operand(argument))

    def sqrt(self, argument: TrigonometricPolynomial, /) -> TrigonometricPolynomial:
        """The square root."""
        return self.ring.root(self._operand(argument))

    def sin(self, argument: TrigonometricPolynomial, /) -> TrigonometricPolynomial:
        """The sine."""
        return self.ring.sine(argument)

    def cos(self, argument: TrigonometricPolynomial, /) -> TrigonometricPolynomial:
        """The cosine."""
        return self.ring.cosine(argument)

    def tan(self, argument: TrigonometricPolynomial, /) -> TrigonometricPolynomial:
        """The tangent."""
        return self.ring.tangent(self._operand(argument))

    def fabs(self, argument: TrigonometricPolynomial, /) -> TrigonometricPolynomial:
        """The absolute value."""
        return self.ring.absolute(self._operand(argument))

    def _operand(self, number: TrigonometricPolynomial) -> TrigonometricPolynomial:
        """The argument of a function that turns it into a symbol."""
        return number


@dataclass(slots=True)
class CanonicalEvaluator(_RingEvaluator):
    """Values are trigonometric polynomials in canonical form.

    Raises:
        TooManyTerms: a polynomial has too many terms, or there are too many products in total.
    """

    products: int = 0

    def add(
        self, left: TrigonometricPolynomial, right: TrigonometricPolynomial, /
    ) -> TrigonometricPolynomial:
        """The sum."""
        return _bounded(self.ring.add(left, right))

    def mul(
        self, left: TrigonometricPolynomial, right: TrigonometricPolynomial, /
    ) -> TrigonometricPolynomial:
        """The product.

        Raises:
            TooManyTerms: it has too many terms, or there were too many products of terms so far.
        """
        self.products += len(left.terms) * len(right.terms)
        if self.products > MOST_PRODUCTS:
            raise TooManyTerms
        return _bounded(self.ring.multiply(left, right))


@dataclass(slots=True)
class NamingEvaluator(_RingEvaluator):
    """Values are trigonometric polynomials; long intermediate results are named."""

    named: list[Abbreviation] = field(default_factory=list[Abbreviation])

    def add(
        self, left: TrigonometricPolynomial, right: TrigonometricPolynomial, /
    ) -> TrigonometricPolynomial:
        """The sum; if it is too long, the longer summand is named."""
        total = self.ring.add(left, right)
        if len(total.terms) <= MOST_TERMS_NAMED:
            return total
        longer, other = (left, right) if len(left.terms) >= len(right.terms) else (right, left)
        return self.ring.add(self._name(longer), other)

    def mul(
        self, left: TrigonometricPolynomial, right: TrigonometricPolynomial, /
    ) -> TrigonometricPolynomial:
        """The product; if it may be too long, the factors are named."""
        if 2 * len(left.terms) * len(right.terms) > MOST_TERMS_NAMED:
            left, right = self._operand(left), self._operand(right)
        return self.ring.multiply(left, right)

    def _operand(self, number: TrigonometricPolynomial) -> TrigonometricPolynomial:
        return self._name(number) if len(number.terms) > 1 else number

    def _name(self, number: TrigonometricPolynomial) -> TrigonometricPolynomial:
        known = len(self.ring.symbols)
        symbol = Abbreviation(len(self.named) + 1, number)
        if self.ring.number(symbol) == known:
            self.named.append(symbol)
        return self.ring.symbol(symbol)


def _bounded(number: TrigonometricPolynomial) -> TrigonometricPolynomial:
    if len(number.terms) > 4 * MOST_TERMS:
        raise TooManyTerms
    return number
