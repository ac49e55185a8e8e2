"""Trigonometric polynomials in plain text or LaTeX, their terms in reading order."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Protocol

from compiler.expressions.trigonometric_polynomial import (
    CONSTANT,
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
    content_of,
)
from grammar_lang.ir.expression_text import number_text


@dataclass(frozen=True, slots=True)
class Product:
    """``coefficient * monomial * (sum of parts) * wave``; no parts stand for one."""

    coefficient: Fraction
    monomial: Monomial
    parts: tuple[tuple[Fraction, Monomial], ...]
    wave: Wave


def collected(number: TrigonometricPolynomial) -> tuple[Product, ...]:
    """A sum of products in reading order.

    Terms without a sine or cosine come first, one by one; terms with the same sine or cosine are
    collected, with their common factor before a sum.
    """
    by_wave: dict[Wave, dict[Monomial, Fraction]] = {}
    for (wave, monomial), value in number.terms.items():
        by_wave.setdefault(wave, {})[monomial] = value
    found: list[Product] = []
    for wave in sorted(by_wave, key=_wave_order):
        terms = sorted(by_wave[wave].items(), key=lambda item: monomial_order(item[0]))
        if wave == CONSTANT or len(terms) == 1:
            found += [Product(value, monomial, (), wave) for monomial, value in terms]
        else:
            found.append(_factored(terms, wave))
    return tuple(found)


def monomial_order(monomial: Monomial) -> tuple[int, list[tuple[int, int]]]:
    """A sort key: higher degrees first, then higher powers of earlier symbols."""
    return -sum(exponent for _, exponent in monomial), [(s, -e) for s, e in monomial]


def _wave_order(wave: Wave) -> tuple[int, int, Wave]:
    kind, angle = wave
    return (0 if wave == CONSTANT else 1), len(angle), (kind, angle)


def _factored(terms: list[tuple[Monomial, Fraction]], wave: Wave) -> Product:
    factor = content_of(value for _, value in terms)
    if terms[0][1] < 0:
        factor = -factor
    shared = _shared([monomial for monomial, _ in terms])
    parts = tuple((value / factor, _quotient(monomial, shared)) for monomial, value in terms)
    return Product(factor, shared, parts, wave)


def _shared(monomials: list[Monomial]) -> Monomial:
    """The greatest monomial that divides all of them."""
    first, *others = (dict(monomial) for monomial in monomials)
    least = {s: min(e, *(other.get(s, 0) for other in others)) for s, e in first.items()}
    return tuple((s, e) for s, e in sorted(least.items()) if e > 0)


def _quotient(monomial: Monomial, divisor: Monomial) -> Monomial:
    rest = dict(monomial)
    for symbol, exponent in divisor:
        rest[symbol] -= exponent
    return tuple((s, e) for s, e in sorted(rest.items()) if e) or FLAT


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
        """An expression in parentheses."""
        ...

    def named(self, number: int) -> str:
        """The name of an intermediate result, counted from 1."""
        ...


@dataclass(frozen=True, slots=True)
class ExpressionPrinter:
    """Writes polynomials over one ring; ``names`` gives the names of variables.

    ``numbers`` are the numbers under which intermediate results are shown.
    """

    ring: PolynomialRing
    notation: Notation
    names: Callable[[Variable], str]
    numbers: Mapping[int, int]

    def text(self, number: TrigonometricPolynomial) -> str:
        """An expression as one text."""
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
        """A power of a symbol, and whether it belongs in the numerator."""
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
    """A positive coefficient as numerator and denominator; a one is left out.

    It is a quotient if the denominator is small and its decimals are not shorter.
    """
    decimal = number_text(size)
    plain = size.denominator <= LARGEST_PLAIN_DENOMINATOR and size.denominator % 5 > 0
    if plain or "/" in decimal:
        above = [] if size.numerator == 1 else [number_text(Fraction(size.numerator))]
        return above, ([] if size.denominator == 1 else [str(size.denominator)])
    return [decimal], []


class TextNotation:
    """``l1^2*l2*cos(q2)/3``."""

    pi = "pi"

    def product(self, factors: Sequence[str]) -> str:
        """Factors joined by asterisks."""
        return "*".join(factors)

    def quotient(self, numerator: Sequence[str], denominator: Sequence[str]) -> str:
        """A quotient on one line; several divisors are in parentheses."""
        below = self.product(denominator)
        return f"{self.product(numerator)}/{below if len(denominator) == 1 else f'({below})'}"

    def power(self, base: str, exponent: int) -> str:
        """A power with a caret."""
        return f"{base}^{exponent}"

    def function(self, name: str, argument: str) -> str:
        """A function call."""
        return f"{name}({argument})"

    def grouped(self, expression: str) -> str:
        """In parentheses."""
        return f"({expression})"

    def named(self, number: int) -> str:
        """``w1``."""
        return f"w{number}"


FUNCTIONS = {"sin": r"\sin", "cos": r"\cos", "tan": r"\tan"}


class LatexNotation:
    r"""``\frac{\ell_{1}^{2} \ell_{2} \cos(q_{2})}{3}``."""

    pi = r"\pi"

    def product(self, factors: Sequence[str]) -> str:
        """Factors side by side."""
        return " ".join(factors)

    def quotient(self, numerator: Sequence[str], denominator: Sequence[str]) -> str:
        """A fraction; long factors stand beside it."""
        short = [part for part in numerator if "(" not in part]
        beside = [part for part in numerator if "(" in part]
        fraction = rf"\frac{{{self.product(short or ['1'])}}}{{{self.product(denominator)}}}"
        return self.product([fraction, *beside])

    def power(self, base: str, exponent: int) -> str:
        """A superscript; a base that has one itself is grouped."""
        return f"{{{base}}}^{{{exponent}}}" if "^" in base else f"{base}^{{{exponent}}}"

    def function(self, name: str, argument: str) -> str:
        """A function or a root."""
        if name == "sqrt":
            return rf"\sqrt{{{argument}}}"
        if name == "abs":
            return rf"\left\lvert {argument} \right\rvert"
        return rf"{FUNCTIONS[name]}\left({argument}\right)"

    def grouped(self, expression: str) -> str:
        """In parentheses."""
        return rf"\left({expression}\right)"

    def named(self, number: int) -> str:
        """``w_{1}``."""
        return f"w_{{{number}}}"
