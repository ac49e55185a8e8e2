"""Exact numbers: an expression graph at a point, in numbers a + b pi with rational a and b.

If all angles are multiples of pi/3 or pi/2, the entries of a mass matrix are usually rational.
Singularity, which no enclosure can prove, is then decided by algebra.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

from flint import arb

from compiler.expressions.evaluator import Evaluator, evaluate_expression
from compiler.expressions.evaluators.balls import ball
from grammar_lang import ir

_COSINES = {
    Fraction(0): Fraction(1),
    Fraction(1, 3): Fraction(1, 2),
    Fraction(1, 2): Fraction(0),
    Fraction(2, 3): Fraction(-1, 2),
    Fraction(1): Fraction(-1),
    Fraction(4, 3): Fraction(-1, 2),
    Fraction(3, 2): Fraction(0),
    Fraction(5, 3): Fraction(1, 2),
}
"""The rational cosines of rational multiples of pi (Niven's theorem: there are no others)."""


class NotExact(ArithmeticError):
    """A value is not recognised as being of the form a + b pi."""


@dataclass(frozen=True, slots=True)
class PiLinear:
    """The number ``rational + pis * pi``; the two are unique, because pi is irrational."""

    rational: Fraction
    pis: Fraction = Fraction(0)

    def ball(self) -> arb:
        """A ball around the number."""
        return ball(self.rational) + ball(self.pis) * arb.pi()

    def at_most(self, other: PiLinear) -> bool:
        """Whether the number is certainly at most another."""
        above, turns = self.rational - other.rational, self.pis - other.pis
        if turns == 0 or above == 0:
            return above <= 0 and turns <= 0
        return bool((self.ball() - other.ball()) < 0)

    def __str__(self) -> str:
        if not self.pis:
            return str(self.rational)
        return f"{self.pis}*pi" if not self.rational else f"{self.rational} + {self.pis}*pi"


class ExactEvaluator(Evaluator[PiLinear]):
    """Values are numbers a + b pi; raises ``NotExact`` if a value is not recognised as one."""

    def constant(self, value: Fraction | int) -> PiLinear:
        """A rational."""
        return PiLinear(Fraction(value))

    def pi(self) -> PiLinear:
        """The number pi."""
        return PiLinear(Fraction(0), Fraction(1))

    def neg(self, argument: PiLinear, /) -> PiLinear:
        """The negation."""
        return PiLinear(-argument.rational, -argument.pis)

    def add(self, left: PiLinear, right: PiLinear, /) -> PiLinear:
        """The sum."""
        return PiLinear(left.rational + right.rational, left.pis + right.pis)

    def mul(self, left: PiLinear, right: PiLinear, /) -> PiLinear:
        """The product, of which one factor must be rational.

        Raises:
            NotExact: neither factor is rational.
        """
        if left.pis:
            left, right = right, left
        factor = _rational(left)
        return PiLinear(factor * right.rational, factor * right.pis)

    def div(self, left: PiLinear, right: PiLinear, /) -> PiLinear:
        """The quotient by a non-zero rational.

        Raises:
            NotExact: the divisor is zero or irrational.
        """
        divisor = _rational(right)
        if divisor == 0:
            raise NotExact("division by zero")
        return PiLinear(left.rational / divisor, left.pis / divisor)

    def power(self, base: PiLinear, exponent: int, /) -> PiLinear:
        """A power of a rational.

        Raises:
            NotExact: the base is irrational, or zero with a negative exponent.
        """
        value = _rational(base)
        if exponent < 0 and not value:
            raise NotExact("division by zero")
        return PiLinear(value**exponent)

    def sq(self, argument: PiLinear, /) -> PiLinear:
        """The square of a rational."""
        return self.power(argument, 2)

    def sqrt(self, argument: PiLinear, /) -> PiLinear:
        """The square root of the square of a rational.

        Raises:
            NotExact: the argument is not such a square.
        """
        value = _rational(argument)
        if value >= 0:
            root = Fraction(math.isqrt(value.numerator), math.isqrt(value.denominator))
            if root * root == value:
                return PiLinear(root)
        raise NotExact("an inexact sqrt")

    def sin(self, argument: PiLinear, /) -> PiLinear:
        """The sine if it is rational."""
        return self.cos(PiLinear(argument.rational, argument.pis - Fraction(1, 2)))

    def cos(self, argument: PiLinear, /) -> PiLinear:
        """The cosine if it is rational."""
        return PiLinear(_cosine(argument))

    def fabs(self, argument: PiLinear, /) -> PiLinear:
        """The absolute value of a rational."""
        return PiLinear(abs(_rational(argument)))

    def sign(self, argument: PiLinear, /) -> PiLinear:
        """Raise NotExact: a sign depends on the neighbourhood of the point."""
        raise NotExact("an inexact sign")


def exact_closed(expression: ir.Expr) -> PiLinear:
    """The value of a closed scalar expression.

    Raises:
        NotExact: it is not recognised as being of the form a + b pi.
        ValueError: the expression is not a closed scalar.
    """
    return evaluate_expression(expression, ExactEvaluator())


def _rational(number: PiLinear) -> Fraction:
    if number.pis:
        raise NotExact("a product or function of pi")
    return number.rational


def _cosine(angle: PiLinear) -> Fraction:
    turns = angle.pis % 2
    if angle.rational or turns not in _COSINES:
        raise NotExact("an irrational cosine")
    return _COSINES[turns]
