from __future__ import annotations

import math
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grammar_lang import ir
from grammar_lang.ir import constants
from grammar_lang.ir.enclosures import rational_bounds

PI = ir.Pi()


def num(value: Fraction | int | str) -> ir.Num:
    return ir.Num(Fraction(value))


FRACTIONS = st.fractions(min_value=-50, max_value=50, max_denominator=40)


@given(FRACTIONS, FRACTIONS, st.sampled_from(["+", "-", "*", "/"]))
def test_arithmetic_of_rationals_is_exact(a: Fraction, b: Fraction, operator: str) -> None:
    expected = {
        "+": lambda: a + b,
        "-": lambda: a - b,
        "*": lambda: a * b,
        "/": lambda: a / b if b else None,
    }[operator]()
    expr = ir.Binary(operator, num(a), num(b))  # type: ignore[arg-type]
    assert constants.rational(expr) == expected


@pytest.mark.parametrize(
    ("expr", "value"),
    [
        (ir.Binary("/", PI, PI), Fraction(1)),
        (ir.Binary("/", ir.Binary("*", num(90), PI), ir.Binary("*", num(180), PI)), Fraction(1, 2)),
        (ir.Binary("*", num(0), PI), Fraction(0)),
        (ir.Unary("sqrt", num("9/4")), Fraction(3, 2)),
        (ir.Unary("sqrt", num(2)), None),
        (ir.Unary("sqrt", num(-4)), None),
        (ir.Unary("abs", num(-4)), Fraction(4)),
        (ir.Binary("^", num("2/3"), num(-2)), Fraction(9, 4)),
        (ir.Binary("^", num(0), num(-1)), None),
        (ir.Binary("/", num(1), num(0)), None),
        (PI, None),
        (ir.Binary("+", PI, num(1)), None),
        (ir.ParameterOf(0, "length"), None),
    ],
)
def test_rational(expr: ir.Expr, value: Fraction | None) -> None:
    assert constants.rational(expr) == value


@pytest.mark.parametrize("function", ["sin", "cos", "tan"])
def test_trigonometry_at_rational_angles(function: ir.Function) -> None:
    """Niven: rational values of sin and cos are 0, 1/2 and 1 in size, those of tan 0 and 1."""
    for twentyfourths in range(-48, 49):
        angle = ir.Binary("*", num(Fraction(twentyfourths, 12)), PI)
        real = getattr(math, function)(twentyfourths * math.pi / 12)
        found = constants.rational(ir.Unary(function, angle))
        nice = next((v for v in (-1, -0.5, 0, 0.5, 1) if abs(real - v) < 1e-9), None)
        if function == "tan" and nice in {-0.5, 0.5}:
            nice = None
        assert (None if found is None else float(found)) == nice


def test_large_powers_are_no_rationals() -> None:
    huge = ir.Binary("^", num(10), num(10**12))
    assert constants.rational(huge) is None
    assert constants.evident(huge) is None
    assert constants.evident(ir.Binary("*", num(2), PI)) == (2, 1)
    with pytest.raises(constants.MagnitudeError):
        constants.binary("^", num(10), num(10**12))


def test_to_float() -> None:
    assert constants.to_float(ir.Unary("cos", PI)) == -1.0
    assert constants.to_float(ir.Binary("+", PI, num("1/2"))) == math.pi + 0.5
    for expr in (
        ir.Binary("/", num(1), num(0)),
        ir.Unary("sqrt", num(-1)),
        ir.ParameterOf(0, "length"),
        num(10**400),
    ):
        with pytest.raises(ValueError, match=r"finite|closed|domain|nonnegative"):
            constants.to_float(expr)


def test_less_is_exact_on_like_monomials() -> None:
    tiny = Fraction(1, 10**40)
    assert constants.less(num(1), num(1 + tiny))
    assert not constants.less(num(1 + tiny), num(1))
    assert constants.less(ir.Binary("*", num(1 - tiny), PI), PI)
    assert constants.less(num(3), PI)


@pytest.mark.parametrize("power", [-800, -400, -1, 0, 3])
def test_bounds_of_irrational_numbers_of_any_size(power: int) -> None:
    """Of sqrt(2) * 10^power, whose square is rational."""
    root = ir.Unary("sqrt", ir.Num(Fraction(2)))
    bounds = rational_bounds(ir.Binary("*", root, ir.Num(Fraction(10) ** power)))
    assert bounds is not None
    low, high = bounds
    square = 2 * Fraction(10) ** (2 * power)
    assert 0 < low**2 < square < high**2
    assert high - low < Fraction(10) ** (power - 12)
