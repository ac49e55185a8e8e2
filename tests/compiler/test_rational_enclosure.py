from fractions import Fraction

import mpmath
import pytest
from flint import arb

from compiler.expressions.evaluators.balls import working_precision
from compiler.expressions.exact_numbers import GRID, exact_rational, outward, rational_bounds
from grammar_lang import ir
from tests.oracles.arms import degrees, number


@pytest.mark.parametrize("text", ["0", "1/3", "-7/5", "1e30", "1e-30"])
def test_a_rational_is_its_own_bounds(text):
    assert rational_bounds(number(text)) == (Fraction(text), Fraction(text))


@pytest.mark.parametrize(
    ("expression", "value"),
    [
        (ir.Pi(), "pi"),
        (degrees(-180), "-pi"),
        (ir.Unary("sqrt", number(2)), "sqrt(2)"),
        (ir.Unary("cos", number(1)), "cos(1)"),
        (ir.Binary("+", ir.Pi(), number(1)), "pi+1"),
    ],
)
def test_an_irrational_lies_strictly_within(expression, value):
    with working_precision(128), mpmath.workdps(40):
        lower, upper = rational_bounds(expression)
        exact = eval(value, {name: getattr(mpmath, name) for name in ("pi", "sqrt", "cos")})
        assert mpmath.mpf(lower.numerator) / lower.denominator < exact
        assert exact < mpmath.mpf(upper.numerator) / upper.denominator
    assert upper - lower == Fraction(1, GRID)


def test_exact_values_are_seen_through_functions():
    half = ir.Unary("cos", degrees(60))
    assert exact_rational(half) == Fraction(1, 2)
    assert exact_rational(ir.Pi()) is None
    assert exact_rational(ir.Binary("^", number(10), number(10**6))) is None


def test_what_is_not_finite_has_no_bounds():
    assert outward(arb(0, float("inf"))) is None
    with pytest.raises(ValueError, match="no finite value"):
        rational_bounds(ir.Unary("sqrt", number(-1)))
