"""Identities that the canonical form has to know, and values against mpmath."""

from __future__ import annotations

import random
from fractions import Fraction

import mpmath as mp
import pytest

from compiler.expressions.trigonometric_polynomial import (
    Opaque,
    Pi,
    PolynomialRing,
    Root,
    TrigonometricPolynomial,
    Variable,
)
from tests.oracles.polynomial_values import value


class Algebra:
    """A ring with three coordinates a, b, c and two parameters l, m."""

    def __init__(self) -> None:
        self.ring = PolynomialRing()
        self.variables = [Variable("coordinate", i) for i in range(3)]
        self.variables += [Variable("parameter", i) for i in range(2)]
        self.a, self.b, self.c, self.l, self.m = map(self.ring.symbol, self.variables)
        self.pi = self.ring.symbol(Pi())

    def number(self, numerator: int, denominator: int = 1) -> TrigonometricPolynomial:
        return self.ring.rational(Fraction(numerator, denominator))

    def plus(self, *numbers: TrigonometricPolynomial) -> TrigonometricPolynomial:
        total = self.number(0)
        for number in numbers:
            total = self.ring.add(total, number)
        return total

    def times(self, *numbers: TrigonometricPolynomial) -> TrigonometricPolynomial:
        total = self.number(1)
        for number in numbers:
            total = self.ring.multiply(total, number)
        return total

    def minus(self, number: TrigonometricPolynomial) -> TrigonometricPolynomial:
        return self.times(self.number(-1), number)

    def turn(self, numerator: int, denominator: int) -> TrigonometricPolynomial:
        return self.times(self.number(numerator, denominator), self.pi)

    def cos(self, *numbers: TrigonometricPolynomial) -> TrigonometricPolynomial:
        return self.ring.cosine(self.plus(*numbers))

    def sin(self, *numbers: TrigonometricPolynomial) -> TrigonometricPolynomial:
        return self.ring.sine(self.plus(*numbers))


@pytest.fixture
def x() -> Algebra:
    return Algebra()


def test_pythagoras(x: Algebra) -> None:
    for angle in (x.a, x.plus(x.a, x.minus(x.b)), x.times(x.number(3, 2), x.l), x.turn(1, 5)):
        total = x.plus(x.times(x.cos(angle), x.cos(angle)), x.times(x.sin(angle), x.sin(angle)))
        assert total.constant == 1


def test_addition_theorems(x: Algebra) -> None:
    cosines, sines = x.times(x.cos(x.a), x.cos(x.b)), x.times(x.sin(x.a), x.sin(x.b))
    assert x.cos(x.a, x.b) == x.plus(cosines, x.minus(sines))
    mixed = x.plus(x.times(x.sin(x.a), x.cos(x.b)), x.times(x.cos(x.a), x.sin(x.b)))
    assert x.sin(x.a, x.b) == mixed
    assert x.sin(x.b, x.a) == mixed


def test_even_and_odd(x: Algebra) -> None:
    difference = x.plus(x.b, x.minus(x.a))
    assert x.cos(difference) == x.cos(x.minus(difference))
    assert x.sin(difference) == x.minus(x.sin(x.minus(difference)))
    assert x.sin(difference) != x.sin(x.minus(difference))


@pytest.mark.parametrize("twelfths", range(-30, 31))
def test_multiples_of_thirty_and_forty_five_degrees_are_exact(x: Algebra, twelfths: int) -> None:
    turn = x.turn(twelfths, 12)
    with mp.workdps(30):
        for found, function in ((x.cos(turn), mp.cos), (x.sin(turn), mp.sin)):
            expected = function(mp.pi * twelfths / 12)
            assert mp.almosteq(value(x.ring, found, {}), expected, 1e-25, 1e-25)
            if twelfths % 2 == 0 or twelfths % 3 == 0:
                waves = [wave for wave, _ in found.terms if wave[0]]
                assert waves == []
            if twelfths % 6 == 0:
                assert found.constant == round(expected)


def test_phases_are_no_symbols_of_their_own(x: Algebra) -> None:
    third, fourth = x.turn(1, 3), x.turn(-1, 4)
    assert x.plus(x.cos(x.a, third), x.cos(x.a, x.minus(third))) == x.cos(x.a)
    product = x.times(x.cos(x.a, fourth), x.cos(x.a, fourth))
    assert x.times(x.number(2), product) == x.plus(x.number(1), x.sin(x.a, x.a))
    assert x.cos(x.turn(3, 7)) == x.sin(x.turn(1, 14))
    odd = x.turn(2, 7)
    assert x.cos(x.a, odd, x.turn(7, 2)) == x.sin(x.a, odd)


def test_roots(x: Algebra) -> None:
    assert x.ring.root(x.number(9, 4)).constant == Fraction(3, 2)
    assert x.ring.root(x.number(0)).constant == 0
    assert x.times(x.ring.root(x.number(8)), x.ring.root(x.number(2))).constant == 4
    assert x.ring.root(x.number(6)) == x.times(x.ring.root(x.number(2)), x.ring.root(x.number(3)))
    assert x.ring.inverse(x.ring.root(x.number(2))) == x.times(
        x.number(1, 2), x.ring.root(x.number(2))
    )
    large = 10_007 * 10_009
    assert x.ring.root(x.number(4 * large)) == x.times(x.number(2), x.ring.symbol(Root(large)))
    negative = x.ring.root(x.number(-1))
    assert any(isinstance(symbol, Opaque) for symbol in x.ring.symbols)
    assert negative.constant is None


def test_equal_opaque_parts_merge(x: Algebra) -> None:
    one, other = x.plus(x.l, x.m), x.plus(x.times(x.number(-3), x.m), x.times(x.number(-3), x.l))
    assert x.ring.inverse(other) == x.times(x.number(-1, 3), x.ring.inverse(one))
    assert x.ring.absolute(other) == x.times(x.number(3), x.ring.absolute(one))
    assert x.ring.tangent(other) == x.minus(x.ring.tangent(x.minus(other)))
    assert x.times(x.l, x.ring.inverse(x.l)).constant == 1
    assert x.ring.absolute(x.number(-2, 3)).constant == Fraction(2, 3)
    assert x.ring.inverse(x.number(0)).constant is None


def random_number(
    x: Algebra, rng: random.Random, depth: int
) -> tuple[TrigonometricPolynomial, mp.mpf]:
    """A random expression with its value, computed beside it."""
    point = [mp.mpf(p) / 10 for p in (7, -4, 11, 13, 17)]
    if depth == 0:
        choice = rng.randrange(7)
        if choice < 5:
            return (x.a, x.b, x.c, x.l, x.m)[choice], point[choice]
        if choice == 5:
            return x.pi, +mp.pi
        q = Fraction(rng.randint(-9, 9), rng.randint(1, 4))
        return x.number(q.numerator, q.denominator), mp.mpf(q.numerator) / q.denominator
    (p, v), (q_, w) = (random_number(x, rng, depth - 1) for _ in range(2))
    operation = rng.choice(["add", "add", "mul", "mul", "cos", "sin", "abs", "tan"])
    match operation:
        case "add":
            return x.plus(p, q_), v + w
        case "mul":
            return x.times(p, q_), v * w
        case "cos":
            return x.cos(p), mp.cos(v)
        case "sin":
            return x.sin(p), mp.sin(v)
        case "abs":
            return x.ring.absolute(p), abs(v)
        case _:
            return x.ring.tangent(p), mp.tan(v)


@pytest.mark.parametrize("seed", range(60))
def test_random_expressions_keep_their_value(x: Algebra, seed: int) -> None:
    point = dict(zip(x.variables, (mp.mpf(p) / 10 for p in (7, -4, 11, 13, 17)), strict=True))
    with mp.workdps(40):
        point = {v: mp.mpf(p) / 10 for v, p in zip(x.variables, (7, -4, 11, 13, 17), strict=True)}
        found, expected = random_number(x, random.Random(seed), 3)
        assert mp.almosteq(value(x.ring, found, point), expected, 1e-25, 1e-25)
