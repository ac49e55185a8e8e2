"""Products of powers, written as people write them: ``1.2 * L.length^3 / 12``."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from grammar_lang import ir
from grammar_lang.ir import constants
from grammar_lang.ir.expression_text import Names, expression_text, number_text


@dataclass(frozen=True, slots=True)
class Product:
    """``factor`` times powers of expressions, each with its exponent."""

    factor: Fraction
    powers: tuple[tuple[ir.Expr, int], ...]

    def __mul__(self, other: Product) -> Product:
        exponents: dict[ir.Expr, int] = dict(self.powers)
        for expression, exponent in other.powers:
            exponents[expression] = exponents.get(expression, 0) + exponent
        kept = tuple((e, n) for e, n in exponents.items() if n)
        return Product(self.factor * other.factor, kept)

    def __pow__(self, exponent: int) -> Product:
        return Product(self.factor**exponent, tuple((e, n * exponent) for e, n in self.powers))

    def text(self, names: Names) -> str:
        """The product; a quotient where its factor is one of small integers."""
        if not self.powers or not self.factor:
            return number_text(self.factor)
        over = [e for e in self.powers if e[1] > 0]
        under = [(e, -n) for e, n in self.powers if n < 0]
        top = [_power(e, n, names) for e, n in over]
        bottom = [_power(e, n, names) for e, n in under]
        factor, divisor = self.factor, 1
        if "/" in number_text(factor):
            factor, divisor = Fraction(factor.numerator), factor.denominator
        if factor != 1 or not top:
            top.insert(0, number_text(factor))
        if divisor > 1:
            bottom.insert(0, str(divisor))
        return " / ".join([" * ".join(top), *bottom])


def _power(expression: ir.Expr, exponent: int, names: Names) -> str:
    text = expression_text(expression, names)
    if isinstance(expression, ir.Binary):
        text = f"({text})"
    return text if exponent == 1 else f"{text}^{exponent}"


def product_of(expression: ir.Expr) -> Product:
    """An expression as a product; a sum is one factor of it."""
    known = constants.evident(expression)
    if known is not None and not known[1]:
        return Product(known[0], ())
    if isinstance(expression, ir.Unary) and expression.function == "neg":
        return Product(Fraction(-1), ()) * product_of(expression.operand)
    if isinstance(expression, ir.Binary) and expression.operator == "*":
        return product_of(expression.left) * product_of(expression.right)
    if isinstance(expression, ir.Binary) and expression.operator == "/":
        below = product_of(expression.right)
        if below.factor:
            return product_of(expression.left) * below**-1
    return Product(Fraction(1), ((expression, 1),))
