"""Trigonometric polynomials at a point, in mpmath, term by term from their definition."""

from __future__ import annotations

from collections.abc import Callable

import mpmath as mp

from compiler.expressions.trigonometric_polynomial import (
    COSINE,
    ONE,
    Abbreviation,
    Monomial,
    Opaque,
    Pi,
    PolynomialRing,
    Root,
    Symbol,
    TrigonometricPolynomial,
    Variable,
)

FUNCTIONS: dict[str, Callable[[mp.mpf], mp.mpf]] = {
    "sqrt": mp.sqrt, "sin": mp.sin, "cos": mp.cos, "tan": mp.tan, "abs": abs,
    "inv": lambda x: 1 / x,
}  # fmt: skip


def value(
    ring: PolynomialRing,
    number: TrigonometricPolynomial,
    point: dict[Variable, mp.mpf],
    known: dict[int, mp.mpf] | None = None,
) -> mp.mpf:
    """The value at a point; ``known`` keeps those of intermediate results."""
    known = {} if known is None else known

    def of(symbol: Symbol) -> mp.mpf:
        match symbol:
            case Variable():
                return point[symbol]
            case Pi():
                return +mp.pi
            case Root(radicand):
                return mp.sqrt(radicand)
            case Opaque(function, argument):
                return FUNCTIONS[function](value(ring, argument, point, known))
            case Abbreviation(number, result):
                if number not in known:
                    known[number] = value(ring, result, point, known)
                return known[number]

    def product(monomial: Monomial) -> mp.mpf:
        return mp.fprod(of(ring.symbols[s]) ** exponent for s, exponent in monomial)

    total = mp.mpf(0)
    for ((kind, angle), monomial), factor in number.terms.items():
        turned = mp.fsum(mp.mpf(v.numerator) / v.denominator * product(m) for m, v in angle)
        wave = 1 if kind == ONE else (mp.cos(turned) if kind == COSINE else mp.sin(turned))
        total += mp.mpf(factor.numerator) / factor.denominator * product(monomial) * wave
    return total
