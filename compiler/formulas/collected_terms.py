"""The terms of a trigonometric polynomial, collected by sine or cosine for a reader."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from compiler.expressions.trigonometric_polynomial import (
    CONSTANT,
    FLAT,
    Monomial,
    TrigonometricPolynomial,
    Wave,
    content_of,
)


@dataclass(frozen=True, slots=True)
class Product:
    """``coefficient * monomial * (sum of parts) * wave``; no parts stand for one."""

    coefficient: Fraction
    monomial: Monomial
    parts: tuple[tuple[Fraction, Monomial], ...]
    wave: Wave


def collected(number: TrigonometricPolynomial) -> tuple[Product, ...]:
    """A sum of products in the order of reading.

    What has no sine or cosine comes first, term by term; of the terms with one, what they have in
    common stands before a sum.
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
    """Higher degrees first, then higher powers of earlier symbols."""
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
