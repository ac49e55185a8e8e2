"""Trigonometric polynomials as text, in a notation."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Protocol

from compiler.expressions.trigonometric_polynomial import (
    COSINE,
    FLAT,
    ONE,
    Abbreviation,
    Angle,
    Monomial,
    Opaque,
    Pi,
    PolynomialRing,
    Root,
    TrigonometricPolynomial,
    Variable,
    Wave,
)
from compiler.formulas.collected_terms import collected, monomial_order
from grammar_lang.ir.expression_text import number_text

LARGEST_PLAIN_DENOMINATOR = 12
RANKS = {"parameter": 1, "coordinate": 3, "rate": 4}


class Notation(Protocol):
    """How the parts of an expression are written."""

    pi: str

    def product(self, factors: Sequence[str]) -> str:
        """Factors side by side; at least one."""
        ...

    def quotient(self, numerator: Sequence[str], denominator: Sequence[str]) -> str:
        """A fraction of products; the denominator is not empty."""
        ...

    def power(self, base: str, exponent: int) -> str:
        """A power with an exponent above one."""
        ...

    def function(self, name: str, argument: str) -> str:
        """``sqrt sin cos tan abs`` of an expression."""
        ...

    def grouped(self, expression: str) -> str:
        """In parentheses."""
        ...

    def named(self, number: int) -> str:
        """The name of an intermediate result, counted from 1."""
        ...


@dataclass(frozen=True, slots=True)
class ExpressionPrinter:
    """Writes polynomials over one ring; ``names`` are of variables.

    ``numbers`` are those under which intermediate results are shown.
    """

    ring: PolynomialRing
    notation: Notation
    names: Callable[[Variable], str]
    numbers: Mapping[int, int]

    def text(self, number: TrigonometricPolynomial) -> str:
        """An expression in one piece."""
        return joined(self.pieces(number))

    def pieces(self, number: TrigonometricPolynomial) -> list[tuple[bool, str]]:
        """The summands: whether each is subtracted, and its text without a sign."""
        found: list[tuple[bool, str]] = []
        for product in collected(number):
            extra: list[str] = []
            if product.parts:
                inner = [self._summand(value, part) for value, part in product.parts]
                extra.append(self.notation.grouped(joined(inner)))
            if product.wave[0] != ONE:
                extra.append(self._wave(product.wave))
            found.append(self._summand(product.coefficient, product.monomial, extra))
        return found or [(False, "0")]

    def _summand(
        self, coefficient: Fraction, monomial: Monomial, extra: Sequence[str] = ()
    ) -> tuple[bool, str]:
        size = abs(coefficient)
        above, below = _coefficient(size)
        ranked = sorted(monomial, key=lambda item: (self._rank(item[0]), item[0]))
        for symbol, exponent in ranked:
            text, positive = self._factor(symbol, exponent)
            (above if positive else below).append(text)
        above += extra
        if below:
            return coefficient < 0, self.notation.quotient(above or ["1"], below)
        return coefficient < 0, self.notation.product(above or ["1"])

    def _factor(self, symbol: int, exponent: int) -> tuple[str, bool]:
        """A power of a symbol, and whether it stands above the line."""
        value = self.ring.symbols[symbol]
        if isinstance(value, Opaque) and value.function == "inv":
            exponent = -exponent
        text = self._symbol(symbol)
        size = abs(exponent)
        return (text if size == 1 else self.notation.power(text, size)), exponent > 0

    def _symbol(self, symbol: int) -> str:
        match self.ring.symbols[symbol]:
            case Variable() as variable:
                return self.names(variable)
            case Pi():
                return self.notation.pi
            case Root(radicand):
                return self.notation.function("sqrt", str(radicand))
            case Abbreviation(number, _):
                return self.notation.named(self.numbers[number])
            case Opaque("inv", argument):
                return self.notation.grouped(self.text(argument))
            case Opaque(function, argument):
                return self.notation.function(function, self.text(argument))

    def _rank(self, symbol: int) -> int:
        match self.ring.symbols[symbol]:
            case Pi() | Root():
                return 0
            case Variable(kind, _):
                return RANKS[kind]
            case _:
                return 2

    def _wave(self, wave: Wave) -> str:
        kind, angle = wave
        return self.notation.function("cos" if kind == COSINE else "sin", self._angle(angle))

    def _angle(self, angle: Angle) -> str:
        items = sorted(angle, key=lambda item: (item[0] == FLAT, monomial_order(item[0])))
        return joined([self._summand(value, monomial) for monomial, value in items])


def joined(pieces: Sequence[tuple[bool, str]]) -> str:
    """A sum of signed texts."""
    (first_negative, first), *others = pieces
    signed = [("- " if negative else "+ ") + text for negative, text in others]
    return " ".join([("-" if first_negative else "") + first, *signed])


def _coefficient(size: Fraction) -> tuple[list[str], list[str]]:
    """A positive coefficient above and below the line; one is left out.

    A quotient where the denominator is small and its decimals are not shorter.
    """
    decimal = number_text(size)
    plain = size.denominator <= LARGEST_PLAIN_DENOMINATOR and size.denominator % 5 > 0
    if plain or "/" in decimal:
        above = [] if size.numerator == 1 else [number_text(Fraction(size.numerator))]
        return above, ([] if size.denominator == 1 else [str(size.denominator)])
    return [decimal], []
