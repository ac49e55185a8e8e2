"""Intervals and exact numbers of a graph against mpmath at random points of the box."""

from __future__ import annotations

import random
from fractions import Fraction

import mpmath as mp
import pytest
from flint import arb

from compiler.expressions.evaluators.exact import ExactEvaluator, NotExact, PiLinear, exact_closed
from compiler.expressions.evaluators.intervals import Ends, IntervalEvaluator, between
from grammar_lang import ir
from tests.oracles.exact_chain import DIGITS, Multiprecision

UNARY = ("neg", "twice", "sq", "inv", "sqrt", "fabs", "sin", "cos", "tan")
PI = ir.Pi()


def value(number: arb) -> mp.mpf:
    return mp.mpf(number.str(DIGITS, radius=False))


def over(fraction: Fraction) -> mp.mpf:
    return mp.mpf(fraction.numerator) / fraction.denominator


def inside(ends: Ends, number: mp.mpf) -> bool:
    return bool(
        value(ends.low) - mp.mpf(10) ** -50 <= number <= value(ends.high) + mp.mpf(10) ** -50
    )


@pytest.mark.parametrize("name", UNARY)
def test_functions_of_intervals_contain_the_values(name: str) -> None:
    rng, run, known = random.Random(name), IntervalEvaluator(), 0
    with mp.workdps(DIGITS):
        for _ in range(300):
            low = Fraction(rng.randint(-800, 800), 100)
            high = low + Fraction(rng.choice([0, 1, 30, 200, 900]), 100)
            found = getattr(run, name)(between(low, high))
            known += not found.undefined
            for i in range(9):
                point = over(low + (high - low) * i / 8)
                if found.undefined or (name == "inv" and point == 0):
                    continue
                assert inside(found, getattr(Multiprecision(), name)(point)), (name, low, high)
    assert known > 100


@pytest.mark.parametrize("name", ["sin", "cos"])
def test_a_sine_is_as_wide_as_it_has_to_be(name: str) -> None:
    rng, run = random.Random(2), IntervalEvaluator()
    with mp.workdps(DIGITS):
        for _ in range(100):
            low = Fraction(rng.randint(-800, 800), 100)
            high = low + Fraction(rng.randint(1, 700), 100)
            found = getattr(run, name)(between(low, high))
            samples = [
                getattr(Multiprecision(), name)(over(low + (high - low) * i / 100))
                for i in range(101)
            ]
            assert value(found.low) > min(samples) - mp.mpf("1e-2")
            assert value(found.high) < max(samples) + mp.mpf("1e-2")


@pytest.mark.parametrize("name", ["add", "sub", "mul", "div"])
def test_operations_contain_the_values(name: str) -> None:
    rng, run = random.Random(name), IntervalEvaluator()
    with mp.workdps(DIGITS):
        for _ in range(300):
            a, b = (Fraction(rng.randint(-30, 30), 7) for _ in range(2))
            c, d = (Fraction(rng.choice([0, 1, 10, 40]), 7) for _ in range(2))
            found = getattr(run, name)(between(a, a + c), between(b, b + d))
            if found.undefined:
                assert name == "div"
                assert b <= 0 <= b + d
                continue
            for i in range(4):
                for j in range(4):
                    left, right = over(a + c * i / 3), over(b + d * j / 3)
                    assert inside(found, getattr(Multiprecision(), name)(left, right))


def test_the_slopes_of_an_absolute_value() -> None:
    sign = IntervalEvaluator().sign
    for low, high, first, last in ((2, 3, 1, 1), (-3, -2, -1, -1), (-1, 2, -1, 1), (0, 2, -1, 1),
                                   (-2, 0, -1, 1), (0, 0, -1, 1)):  # fmt: skip
        assert sign(Ends(arb(low), arb(high))) == Ends(arb(first), arb(last))
    assert sign(Ends(arb("nan"), arb("nan"))).undefined


def test_what_is_undefined_stays_so() -> None:
    run = IntervalEvaluator()
    undefined = run.inv(between(Fraction(-1), Fraction(1)))
    zero, unlimited = run.constant(0), between(None, None)
    assert run.mul(zero, undefined).undefined
    assert run.cos(undefined).undefined
    assert run.fabs(undefined).undefined
    assert not undefined.low >= 0
    assert run.mul(zero, unlimited).high == 0
    assert run.sq(unlimited).low == 0


def test_a_wide_square_does_not_reach_below_zero() -> None:
    run, side = IntervalEvaluator(), between(Fraction(1, 2), Fraction(5))
    assert run.mul(side, side).low == 0.25


# --- exact numbers ------------------------------------------------------------------------------


def test_exact_values_agree_with_mpmath() -> None:
    run, known = ExactEvaluator(), 0
    with mp.workdps(DIGITS):
        for twelfths in range(-36, 37):
            angle = PiLinear(Fraction(0), Fraction(twelfths, 12))
            for name in ("sin", "cos", "tan"):
                try:
                    found = getattr(run, name)(angle)
                except NotExact:
                    continue
                known += 1
                expected = getattr(Multiprecision(), name)(over(angle.pis) * mp.pi)
                assert abs(over(found.rational) - expected) < mp.mpf(10) ** -40
    assert known > 50


def test_what_is_not_exact_is_refused() -> None:
    run, one = ExactEvaluator(), PiLinear(Fraction(1))
    pi = PiLinear(Fraction(0), Fraction(1))
    for name, argument in (("cos", one), ("sqrt", PiLinear(Fraction(2))), ("sq", pi)):
        with pytest.raises(NotExact):
            getattr(run, name)(argument)
    for name, left, right in (("mul", pi, pi), ("div", one, PiLinear(Fraction(0)))):
        with pytest.raises(NotExact):
            getattr(run, name)(left, right)
    assert run.sqrt(PiLinear(Fraction(9, 4))) == PiLinear(Fraction(3, 2))


def test_constants_of_the_language_are_exact() -> None:
    half_turn = ir.Binary("/", ir.Binary("*", ir.Num(Fraction(3)), PI), ir.Num(Fraction(2)))
    assert exact_closed(half_turn) == PiLinear(Fraction(0), Fraction(3, 2))
    with pytest.raises(NotExact):
        exact_closed(ir.Unary("sqrt", ir.Num(Fraction(2))))


def test_order_of_exact_numbers() -> None:
    pi, close = PiLinear(Fraction(0), Fraction(1)), PiLinear(Fraction(355, 113))
    assert pi.at_most(pi)
    assert pi.at_most(close)
    assert not close.at_most(pi)
