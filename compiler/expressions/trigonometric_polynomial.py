r"""Trigonometric polynomials with exact rational coefficients, in canonical form.

A number is a sum of terms ``coefficient * monomial * f(angle)`` where f is 1, cos or sin. Products
of sines and cosines become sums,

.. math:: 2 \cos a \cos b = \cos(a - b) + \cos(a + b),

the first coefficient of an angle is positive, and multiples of pi / 4 or pi / 6 in an angle are
evaluated exactly, so that equal expressions of a robot's kinematics get equal forms. Anything that
is not such a polynomial (a root, a tangent, a quotient by a sum) is a symbol of its own.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Literal, TypeAlias

Monomial: TypeAlias = tuple[tuple[int, int], ...]
"""Symbols with their non-zero exponents, in ascending order of symbols."""
Angle: TypeAlias = tuple[tuple[Monomial, Fraction], ...]
"""A polynomial without trigonometric terms."""
Wave: TypeAlias = tuple[int, Angle]
"""``ONE``, ``COSINE`` or ``SINE`` and the angle, empty for ``ONE``."""
Term: TypeAlias = tuple[Wave, Monomial]
Function: TypeAlias = Literal["sqrt", "sin", "cos", "tan", "abs", "inv"]

ONE, COSINE, SINE = 0, 1, 2
CONSTANT: Wave = (ONE, ())
HALF = Fraction(1, 2)
LARGEST_TRIAL_DIVISOR = 1000
FLAT: Monomial = ()


@dataclass(frozen=True, slots=True)
class Variable:
    """An input of the graph: the ``index``-th of its kind."""

    kind: Literal["coordinate", "rate", "parameter"]
    index: int


@dataclass(frozen=True, slots=True)
class Pi:
    """The number pi."""


@dataclass(frozen=True, slots=True)
class Root:
    """The square root of an integer that is not a square; a prime if it is small."""

    radicand: int


@dataclass(frozen=True, slots=True)
class TrigonometricPolynomial:
    """A sum of terms; equal polynomials over one table of symbols have equal terms."""

    terms: Mapping[Term, Fraction]

    @property
    def constant(self) -> Fraction | None:
        """The value if the polynomial is a rational constant, else None."""
        if not self.terms:
            return Fraction(0)
        return self.terms.get((CONSTANT, FLAT)) if len(self.terms) == 1 else None

    @property
    def key(self) -> tuple[tuple[Term, Fraction], ...]:
        """The terms in ascending order."""
        return tuple(sorted(self.terms.items()))


@dataclass(frozen=True, slots=True)
class Opaque:
    """A function of a polynomial that is not itself a polynomial."""

    function: Function
    argument: TrigonometricPolynomial


@dataclass(frozen=True, slots=True)
class Abbreviation:
    """The ``number``-th intermediate result, counted from 1."""

    number: int
    value: TrigonometricPolynomial


Symbol: TypeAlias = Variable | Pi | Root | Opaque | Abbreviation


@dataclass(slots=True)
class PolynomialRing:
    """The symbols of some polynomials, and sums, products and functions of these polynomials."""

    symbols: list[Symbol] = field(default_factory=list[Symbol])
    _numbers: dict[object, int] = field(default_factory=dict[object, int])
    _products: dict[tuple[Monomial, Monomial], tuple[Monomial, Fraction]] = field(
        default_factory=dict[tuple[Monomial, Monomial], tuple[Monomial, Fraction]]
    )
    _waves: dict[tuple[int, Angle], tuple[tuple[Term, Fraction], ...]] = field(
        default_factory=dict[tuple[int, Angle], tuple[tuple[Term, Fraction], ...]]
    )

    _wave_products: dict[tuple[Wave, Wave], tuple[tuple[Term, Fraction], ...]] = field(
        default_factory=dict[tuple[Wave, Wave], tuple[tuple[Term, Fraction], ...]]
    )

    # --- symbols -------------------------------------------------------------------------------

    def symbol(self, symbol: Symbol) -> TrigonometricPolynomial:
        """The polynomial that consists of one symbol."""
        return _sum([((CONSTANT, ((self.number(symbol), 1),)), Fraction(1))])

    def number(self, symbol: Symbol) -> int:
        """The number of a symbol; an unknown symbol gets a new one."""
        match symbol:
            case Opaque(function, argument):
                key: object = (function, argument.key)
            case Abbreviation(_, value):
                key = ("abbreviation", value.key)
            case _:
                key = symbol
        if key not in self._numbers:
            self._numbers[key] = len(self.symbols)
            self.symbols.append(symbol)
        return self._numbers[key]

    def rational(self, value: Fraction | int) -> TrigonometricPolynomial:
        """A rational number as a polynomial."""
        return _sum([((CONSTANT, FLAT), Fraction(value))])

    # --- ring operations -----------------------------------------------------------------------

    def add(
        self, left: TrigonometricPolynomial, right: TrigonometricPolynomial
    ) -> TrigonometricPolynomial:
        """The sum."""
        if len(left.terms) < len(right.terms):
            left, right = right, left
        return _sum(right.terms.items(), left.terms)

    def scaled(self, number: TrigonometricPolynomial, by: Fraction) -> TrigonometricPolynomial:
        """A rational multiple."""
        return _sum((term, value * by) for term, value in number.terms.items())

    def multiply(
        self, left: TrigonometricPolynomial, right: TrigonometricPolynomial
    ) -> TrigonometricPolynomial:
        """The product."""
        for one, other in ((left, right), (right, left)):
            if one.constant is not None:
                return self.scaled(other, one.constant)
        return _sum(
            item
            for (wave, monomial), value in left.terms.items()
            for (other_wave, other), factor in right.terms.items()
            for item in self._product(
                wave, other_wave, self._times(monomial, other), value * factor
            )
        )

    def _product(
        self, wave: Wave, other: Wave, monomial: tuple[Monomial, Fraction], value: Fraction
    ) -> Iterator[tuple[Term, Fraction]]:
        value *= monomial[1]
        if not wave[0] or not other[0]:
            yield (wave if wave[0] else other, monomial[0]), value
            return
        for (found, roots), factor in self._wave_product(wave, other):
            product, more = self._times(monomial[0], roots)
            yield (found, product), value * factor * more

    def _wave_product(self, wave: Wave, other: Wave) -> tuple[tuple[Term, Fraction], ...]:
        """The product of two waves as a sum."""
        if (wave, other) not in self._wave_products:
            self._wave_products[wave, other] = tuple(self._product_to_sum(wave, other))
        return self._wave_products[wave, other]

    def _product_to_sum(self, wave: Wave, other: Wave) -> Iterator[tuple[Term, Fraction]]:
        (kind, a), (other_kind, b) = wave, other
        if kind > other_kind:
            (kind, a), (other_kind, b) = (other_kind, b), (kind, a)
        function = COSINE if kind == other_kind else SINE
        outer = -HALF if kind == SINE else HALF
        # In the mixed case, sin b cos a = (sin(b + a) + sin(b - a)) / 2.
        for sign, factor in ((-1, HALF), (1, outer)):
            for term, value in self.wave(function, _combined(b, a, sign)):
                yield term, value * factor

    def _times(self, left: Monomial, right: Monomial) -> tuple[Monomial, Fraction]:
        """A product of monomials, in which roots occur at most once."""
        if not left or not right:
            return left or right, Fraction(1)
        known = self._products.get((left, right))
        if known is None:
            exponents = dict(left)
            for symbol, exponent in right:
                exponents[symbol] = exponents.get(symbol, 0) + exponent
            known = self._products[left, right] = self._reduced(exponents)
        return known

    def _reduced(self, exponents: dict[int, int]) -> tuple[Monomial, Fraction]:
        factor = Fraction(1)
        for number, exponent in exponents.items():
            symbol = self.symbols[number]
            if isinstance(symbol, Root):
                factor *= Fraction(symbol.radicand) ** (exponent // 2)
                exponents[number] = exponent % 2
        return tuple(sorted((s, e) for s, e in exponents.items() if e)), factor

    # --- functions -----------------------------------------------------------------------------

    def inverse(self, number: TrigonometricPolynomial) -> TrigonometricPolynomial:
        """The reciprocal: for a monomial one with negative exponents, else a symbol."""
        if not number.terms:
            return self.symbol(Opaque("inv", number))
        if len(number.terms) == 1:
            ((((kind, _), monomial), value),) = number.terms.items()
            if kind == ONE:
                negative, factor = self._reduced({s: -e for s, e in monomial})
                return _sum([((CONSTANT, negative), factor / value)])
        content, primitive = self._primitive(number)
        return self.scaled(self.symbol(Opaque("inv", primitive)), 1 / content)

    def absolute(self, number: TrigonometricPolynomial) -> TrigonometricPolynomial:
        """The absolute value."""
        if number.constant is not None:
            return self.rational(abs(number.constant))
        content, primitive = self._primitive(number)
        return self.scaled(self.symbol(Opaque("abs", primitive)), abs(content))

    def _primitive(
        self, number: TrigonometricPolynomial
    ) -> tuple[Fraction, TrigonometricPolynomial]:
        """A rational factor, and the rest with coprime integers, the last positive; not for 0."""
        content = content_of(number.terms.values())
        if number.key[-1][1] < 0:
            content = -content
        return content, self.scaled(number, 1 / content)

    def root(self, number: TrigonometricPolynomial) -> TrigonometricPolynomial:
        """The square root: for a rational as roots of primes, else a symbol."""
        value = number.constant
        if value is None or value < 0:
            return self.symbol(Opaque("sqrt", number))
        outside, radicands = _squares(value.numerator * value.denominator)
        found = self.rational(Fraction(outside, value.denominator))
        for radicand in radicands:
            found = self.multiply(found, self.symbol(Root(radicand)))
        return found

    def tangent(self, number: TrigonometricPolynomial) -> TrigonometricPolynomial:
        """The tangent, as a symbol."""
        if not number.terms:
            return number
        if number.key[0][1] < 0:
            return self.scaled(
                self.symbol(Opaque("tan", self.scaled(number, Fraction(-1)))), Fraction(-1)
            )
        return self.symbol(Opaque("tan", number))

    def cosine(self, number: TrigonometricPolynomial) -> TrigonometricPolynomial:
        """The cosine."""
        return self._function(COSINE, "cos", number)

    def sine(self, number: TrigonometricPolynomial) -> TrigonometricPolynomial:
        """The sine."""
        return self._function(SINE, "sin", number)

    def _function(
        self, kind: int, name: Function, number: TrigonometricPolynomial
    ) -> TrigonometricPolynomial:
        if any(wave[0] for wave, _ in number.terms):
            return self.symbol(Opaque(name, number))
        angle = tuple(sorted((monomial, value) for (_, monomial), value in number.terms.items()))
        return _sum(self.wave(kind, angle))

    def wave(self, kind: int, angle: Angle) -> tuple[tuple[Term, Fraction], ...]:
        """The canonical terms of a sine or a cosine."""
        if (kind, angle) not in self._waves:
            self._waves[kind, angle] = tuple(self._wave(kind, angle))
        return self._waves[kind, angle]

    def _wave(self, kind: int, angle: Angle) -> Iterator[tuple[Term, Fraction]]:
        pi: Monomial = ((self.number(Pi()), 1),)
        rest = tuple(item for item in angle if item[0] != pi)
        turns, sign = dict(angle).get(pi, Fraction(0)), Fraction(1)
        if (rest[0][1] if rest else turns) < 0:
            rest, turns = tuple((m, -v) for m, v in rest), -turns
            sign = Fraction(-1 if kind == SINE else 1)
        quarters, part = divmod(turns, HALF)
        function, turned = _quarter(kind, int(quarters))
        if not rest and part > Fraction(1, 4):
            function, part = COSINE + SINE - function, HALF - part
        if part in EXACT_TURNS:
            yield from self._exact(function, rest, EXACT_TURNS[part], sign * turned)
        else:
            whole = tuple(sorted([*rest, (pi, part)]))
            yield ((function, whole), FLAT), sign * turned

    def _exact(
        self, function: int, rest: Angle, turn: tuple[Surd, Surd], factor: Fraction
    ) -> Iterator[tuple[Term, Fraction]]:
        """The addition theorem for an angle with a known cosine and sine."""
        cosine, sine = turn
        other = COSINE + SINE - function
        signed = (-sine[0] if function == COSINE else sine[0], sine[1])
        for kind, (value, radicand) in ((function, cosine), (other, signed)):
            if not value or (not rest and kind == SINE):
                continue
            roots = ((self.number(Root(radicand)), 1),) if radicand > 1 else FLAT
            yield ((kind, rest) if rest else CONSTANT, roots), factor * value


Surd: TypeAlias = tuple[Fraction, int]
"""``(a, n)`` means a * sqrt(n)."""
EXACT_TURNS: Mapping[Fraction, tuple[Surd, Surd]] = {
    Fraction(0): ((Fraction(1), 1), (Fraction(0), 1)),
    Fraction(1, 6): ((HALF, 3), (HALF, 1)),
    Fraction(1, 4): ((HALF, 2), (HALF, 2)),
    Fraction(1, 3): ((HALF, 1), (HALF, 3)),
}
"""Maps multiples of pi to their cosine and sine."""


def content_of(values: Iterable[Fraction]) -> Fraction:
    """The positive rational such that these values are its multiples by coprime integers."""
    numerator, denominator = 0, 1
    for value in values:
        numerator = math.gcd(numerator, value.numerator)
        denominator = math.lcm(denominator, value.denominator)
    return Fraction(numerator, denominator)


def _sum(
    items: Iterable[tuple[Term, Fraction]], start: Mapping[Term, Fraction] | None = None
) -> TrigonometricPolynomial:
    terms = dict(start or {})
    for term, value in items:
        known = terms.get(term)
        total = value if known is None else known + value
        if total:
            terms[term] = total
        elif known is not None:
            del terms[term]
    return TrigonometricPolynomial(terms)


def _combined(left: Angle, right: Angle, sign: int) -> Angle:
    """``left + sign * right``."""
    total = dict(left)
    for monomial, value in right:
        total[monomial] = total.get(monomial, Fraction(0)) + sign * value
    return tuple(sorted(item for item in total.items() if item[1]))


def _quarter(kind: int, quarters: int) -> tuple[int, int]:
    """The function and sign that ``kind`` becomes at an angle increased by quarter turns."""
    turn = quarters % 4
    if kind == COSINE:
        return ((COSINE, 1), (SINE, -1), (COSINE, -1), (SINE, 1))[turn]
    return ((SINE, 1), (COSINE, 1), (SINE, -1), (COSINE, -1))[turn]


def _squares(value: int) -> tuple[int, list[int]]:
    """``(a, [p, ...])`` with value = a * a * p * ..., by trial division by small numbers."""
    outside, radicands, divisor = 1, list[int](), 2
    while divisor <= LARGEST_TRIAL_DIVISOR and divisor * divisor <= value:
        while value % (divisor * divisor) == 0:
            value, outside = value // (divisor * divisor), outside * divisor
        if value % divisor == 0:
            value //= divisor
            radicands.append(divisor)
        divisor += 1
    whole = math.isqrt(value)
    if whole * whole == value:
        return outside * whole, radicands
    return outside, [*radicands, value]
