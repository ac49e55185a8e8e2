"""Balls and series of balls contain the exact values (mpmath at 60 digits)."""

from __future__ import annotations

from fractions import Fraction
from threading import Event, Thread

import mpmath as mp
import pytest
from flint import arb, arb_series, ctx
from hypothesis import given
from hypothesis import strategies as st

from compiler.expressions.evaluators.balls import (
    SERIES,
    ball,
    closed_ball,
    constant_ball,
    working_precision,
)
from compiler.expressions.scalars import Constant, PiConstant
from grammar_lang import ir
from tests.oracles.exact_chain import DIGITS, contains

rationals = st.fractions(min_value=-99, max_value=99, max_denominator=999)


def multiprecision(expression: ir.Expr) -> mp.mpf:
    match expression:
        case ir.Num(value):
            return mp.mpf(value.numerator) / value.denominator
        case ir.Pi():
            return +mp.pi
        case ir.Unary("neg", operand):
            return -multiprecision(operand)
        case ir.Unary("abs", operand):
            return abs(multiprecision(operand))
        case ir.Unary(function, operand):
            return getattr(mp, function)(multiprecision(operand))
        case ir.Binary("^", base, ir.Num(exponent)):
            return multiprecision(base) ** int(exponent)
        case ir.Binary(operator, left, right):
            a, b = multiprecision(left), multiprecision(right)
            return {"+": a + b, "-": a - b, "*": a * b}[operator] if operator != "/" else a / b
    raise AssertionError(expression)


leaves = st.one_of(st.builds(ir.Num, rationals), st.just(ir.Pi()))


def compound(inner: st.SearchStrategy[ir.Expr]) -> st.SearchStrategy[ir.Expr]:
    return st.one_of(
        st.builds(ir.Unary, st.sampled_from(["neg", "abs", "sin", "cos"]), inner),
        st.builds(ir.Binary, st.sampled_from(["+", "-", "*"]), inner, inner),
        st.builds(
            ir.Binary,
            st.just("^"),
            inner,
            st.builds(lambda n: ir.Num(Fraction(n)), st.integers(0, 3)),
        ),
        st.builds(ir.Binary, st.just("/"), inner, st.builds(ir.Num, rationals.filter(bool))),
    )


@given(st.recursive(leaves, compound, max_leaves=8))
def test_closed_expressions_lie_in_their_balls(expression: ir.Expr) -> None:
    with mp.workdps(DIGITS), working_precision(80):
        expected = multiprecision(expression)
        found = closed_ball(expression)
        if abs(expected) < 10**9:
            assert contains(found, expected)


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        (ir.Binary("-", ir.Num(Fraction(1)), ir.Num(Fraction(3))), Fraction(-2)),
        (ir.Binary("/", ir.Num(Fraction(1)), ir.Num(Fraction(3))), Fraction(1, 3)),
        (ir.Binary("^", ir.Num(Fraction(-2)), ir.Num(Fraction(3))), Fraction(-8)),
        (ir.Binary("^", ir.Num(Fraction(-2)), ir.Num(Fraction(-2))), Fraction(1, 4)),
        (ir.Unary("sqrt", ir.Num(Fraction(9, 4))), Fraction(3, 2)),
        (ir.Unary("tan", ir.Num(Fraction(0))), Fraction(0)),
    ],
)
def test_closed_expressions_with_rational_values(expression: ir.Expr, value: Fraction) -> None:
    found = closed_ball(expression)
    assert (found - ball(value)).contains(0)
    assert found.rad() < 1e-12


@pytest.mark.parametrize("expression", [ir.World(), ir.ParameterOf(0, "length"), ir.DofOf(0, "q")])
def test_what_is_not_a_closed_scalar_is_refused(expression: ir.Expr) -> None:
    with pytest.raises(ValueError, match="closed"):
        closed_ball(expression)


@given(rationals, st.sampled_from([24, 53, 200]))
def test_a_rational_lies_in_its_ball(value: Fraction, bits: int) -> None:
    with working_precision(bits):
        found = ball(value)
        # Exactly: value * denominator is the numerator.
        assert (found * value.denominator).contains(arb(value.numerator))
        assert found.rad() <= abs(found.mid()) * arb(2) ** (2 - bits)


def test_constants() -> None:
    with mp.workdps(DIGITS), working_precision(150):
        assert contains(constant_ball(PiConstant()), +mp.pi)
        assert contains(constant_ball(Constant(Fraction("0.3"))), mp.mpf(3) / 10)
        assert not contains(constant_ball(Constant(Fraction("0.3"))), mp.mpf(0.1 + 0.2))


def test_working_precision_is_restored_even_after_an_error() -> None:
    before = ctx.prec, ctx.cap

    def fail() -> None:
        with working_precision(77):
            assert ctx.prec == 77
            ctx.cap = 3
            raise KeyError

    with pytest.raises(KeyError):
        fail()
    assert (ctx.prec, ctx.cap) == before


TAYLOR = {
    "neg": lambda x: -x, "sq": lambda x: x**2, "inv": lambda x: 1 / x, "twice": lambda x: 2 * x,
    "sqrt": mp.sqrt, "sin": mp.sin, "cos": mp.cos, "tan": mp.tan, "fabs": abs,
}  # fmt: skip


@pytest.mark.parametrize("name", sorted(TAYLOR))
@pytest.mark.parametrize("centre", ["0.7", "2.3"])
def test_series_of_functions_are_taylor_series(name: str, centre: str) -> None:
    """f(c + 3t - t^2) expanded by mpmath, coefficient by coefficient."""
    with mp.workdps(DIGITS), working_precision(120):
        ctx.cap = 8
        argument = arb_series([ball(Fraction(centre)), arb(3), arb(-1)])
        found = getattr(SERIES, name)(argument)
        expected = (
            mp.taylor(lambda t: TAYLOR[name](mp.mpf(centre) + 3 * t - t**2), 0, 7)
            if name != "fabs"
            else [mp.mpf(centre), 3, -1, 0, 0, 0, 0, 0]
        )
        for i, value in enumerate(expected):
            # Differences carry a dozen digits at least.
            assert abs(mp.mpf(str(found[i].mid().str(30, radius=False))) - value) < 1e-12 * (
                1 + abs(value)
            )
            assert found[i].rad() < 1e-25


def test_series_operations() -> None:
    with working_precision(80):
        ctx.cap = 4
        arithmetic = SERIES
        a, b = arb_series([1, 2, 3]), arb_series([2, 1])
        # (1 + 2t + 3t^2) / (2 + t) = 1/2 + 3/4 t + 9/8 t^2 - 9/16 t^3 + ...
        quotient = [Fraction(1, 2), Fraction(3, 4), Fraction(9, 8), Fraction(-9, 16)]
        expected = {
            "add": [3, 3, 3, 0], "sub": [-1, 1, 3, 0], "mul": [2, 5, 8, 3], "div": quotient,
        }  # fmt: skip
        for name, values in expected.items():
            found = getattr(arithmetic, name)(a, b)
            assert all(found[i].contains(ball(v)) for i, v in enumerate(values))
        assert (arithmetic.constant(5)[0], arithmetic.constant(5)[1]) == (5, 0)


def test_absolute_value_of_a_negative_series_and_of_an_unsure_one() -> None:
    arithmetic = SERIES
    found = arithmetic.fabs(arb_series([-2, 1]))
    assert found[0] == 2
    assert found[1] == -1
    with pytest.raises(ValueError, match=r"sign|fabs"):
        arithmetic.fabs(arb_series([arb(0, 1), 1]))


def test_other_threads_wait_for_the_working_precision() -> None:
    # flint's context is that of the process.  A thread that shortened the series of another one
    # would turn enclosures into numbers that enclose nothing.
    entered, leave = Event(), Event()

    def other() -> None:
        with working_precision(300):
            ctx.cap = 1
            entered.set()
            leave.wait(10)

    before = ctx.prec, ctx.cap
    thread = Thread(target=other)
    try:
        with working_precision(100):
            ctx.cap = 7
            thread.start()
            entered.wait(0.2)
            seen = ctx.prec, ctx.cap
            product = arb_series([1, 1, 1]) * arb_series([1, 1, 1])
            coefficients = [int(product[m].unique_fmpz()) for m in range(5)]
    finally:
        leave.set()
        thread.join()
    assert entered.is_set()
    assert seen == (100, 7)
    assert coefficients == [1, 2, 3, 2, 1]
    assert (ctx.prec, ctx.cap) == before
