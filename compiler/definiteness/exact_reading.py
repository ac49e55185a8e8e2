"""The exact reading of a graph at a point: numbers a + b pi with rational a and b.

Where all angles are multiples of pi/3 or pi/2 the entries of a mass matrix are rational as a
rule, so that singularity, which no enclosure can show, is decided by algebra.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from fractions import Fraction

from flint import arb

from compiler.arithmetic.balls import ball
from compiler.arithmetic.scalars import Constant, PiConstant
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
    """A value that is not seen to be of the form a + b pi."""


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


def exact_constant(constant: Constant | PiConstant) -> PiLinear:
    """A constant of a graph."""
    if isinstance(constant, Constant):
        return PiLinear(constant.value)
    return PiLinear(Fraction(0), Fraction(1))


def exact_closed(expression: ir.Expr) -> PiLinear:
    """The value of a closed scalar expression.

    Raises:
        NotExact: it is not seen to be of the form a + b pi.
    """
    arithmetic = ExactArithmetic()
    match expression:
        case ir.Num(value):
            return PiLinear(value)
        case ir.Pi():
            return PiLinear(Fraction(0), Fraction(1))
        case ir.Unary(function, operand):
            name = "fabs" if function == "abs" else function
            return arithmetic.unary(name, exact_closed(operand))
        case ir.Binary("^", base, ir.Num(exponent)):
            return PiLinear(_rational(exact_closed(base)) ** int(exponent))
        case ir.Binary(operator, left, right):
            names = {"+": "add", "-": "sub", "*": "mul", "/": "div"}
            return arithmetic.binary(names[operator], exact_closed(left), exact_closed(right))
        case _:
            raise NotExact(f"not a closed scalar: {expression}")


class ExactArithmetic:
    """Numbers a + b pi as the numbers of a tape; ``NotExact`` where a value is none."""

    def integer(self, value: int) -> PiLinear:
        """An integer."""
        return PiLinear(Fraction(value))

    def unary(self, name: str, argument: PiLinear) -> PiLinear:
        """A function of one number."""
        match name:
            case "neg":
                return PiLinear(-argument.rational, -argument.pis)
            case "twice":
                return PiLinear(2 * argument.rational, 2 * argument.pis)
            case "sin":
                return PiLinear(_cosine(PiLinear(argument.rational, argument.pis - Fraction(1, 2))))
            case "cos":
                return PiLinear(_cosine(argument))
            case "tan":
                sine, cosine = self.unary("sin", argument), self.unary("cos", argument)
                return self.binary("div", sine, cosine)
            case _:
                return PiLinear(_rational_function(name, _rational(argument)))

    def binary(self, name: str, left: PiLinear, right: PiLinear) -> PiLinear:
        """An operation on two numbers."""
        if name == "add":
            return PiLinear(left.rational + right.rational, left.pis + right.pis)
        if name == "sub":
            return PiLinear(left.rational - right.rational, left.pis - right.pis)
        if name == "mul":
            if left.pis:
                left, right = right, left
            factor = _rational(left)
            return PiLinear(factor * right.rational, factor * right.pis)
        divisor = _rational(right)
        if divisor == 0:
            raise NotExact("division by zero")
        return PiLinear(left.rational / divisor, left.pis / divisor)


def _rational(number: PiLinear) -> Fraction:
    if number.pis:
        raise NotExact("a product or function of pi")
    return number.rational


def _cosine(angle: PiLinear) -> Fraction:
    turns = angle.pis % 2
    if angle.rational or turns not in _COSINES:
        raise NotExact("an irrational cosine")
    return _COSINES[turns]


def _rational_function(name: str, value: Fraction) -> Fraction:
    if name == "sq":
        return value * value
    if name == "fabs":
        return abs(value)
    if name == "inv" and value:
        return 1 / value
    if name == "sqrt" and value >= 0:
        root = Fraction(math.isqrt(value.numerator), math.isqrt(value.denominator))
        if root * root == value:
            return root
    raise NotExact(f"an inexact {name}")
