from fractions import Fraction

import pytest
from flint import arb

from compiler.encodings.region_terms import (
    RealScript,
    add,
    all_of,
    any_of,
    at_most,
    between,
    constant,
    equal,
    multiply,
    negate,
    negation,
    numeral,
    subtract,
)


@pytest.fixture
def script():
    return RealScript()


def test_constants_fold_exactly():
    third = constant(Fraction(1, 3))
    assert add(third, third, third).value == 1
    assert multiply(third, constant(3)).value == 1
    assert subtract(third, third).value == 0


def test_zero_and_one_vanish(script):
    x = script.declare("x")
    assert multiply(constant(0), x).value == 0
    assert multiply(x, constant(1)) == x
    assert add(x, constant(0)) == x
    assert negate(negate(x)) == x


def test_factors_are_collected(script):
    x, y = script.declare("x"), script.declare("y")
    assert multiply(negate(x), negate(y)).text == "(* x y)"
    assert multiply(multiply(constant(2), x), multiply(constant(3), y)).text == "(* 6.0 (* x y))"
    assert negate(multiply(x, y)).text == "(- (* x y))"


@pytest.mark.parametrize(
    ("value", "text"),
    [("0", "0.0"), ("3", "3.0"), ("-3", "(- 3.0)"), ("1/2", "(/ 1 2)"), ("-7/5", "(- (/ 7 5))")],
)
def test_rationals_are_printed_exactly(value, text):
    assert numeral(Fraction(value)) == text


def test_what_is_decided_needs_no_solver(script):
    one, two = constant(1), constant(2)
    script.assertion(at_most(one, two))
    assert script.lines == []
    script.assertion(equal(one, two))
    assert script.lines == ["(assert false)"]
    assert negation("false") == "true"
    assert negation("(= x y)") == "(not (= x y))"


def test_formulas(script):
    x = script.declare("x")
    assert between((Fraction(1), Fraction(1)), x) == ["(= x 1.0)"]
    low, high = between((Fraction(-1, 2), Fraction(3)), x)
    assert (low, high) == ("(<= (- (/ 1 2)) x)", "(<= x 3.0)")
    assert all_of([low, "true", high]) == f"(and {low} {high})"
    assert all_of([]) == "true"
    assert any_of([]) == "false"
    assert any_of([low, "true"]) == "true"


def test_naming_keeps_leaves(script):
    x = script.declare("x")
    assert script.named("a", x) is x
    assert script.named("a", negate(x)) == negate(x)
    assert script.named("a", multiply(x, x)).text == "a1"
    assert script.lines[-1] == "(assert (= a1 (* x x)))"


def test_a_known_number_is_an_interval(script):
    assert script.number(arb(0, 1)) is None
    assert script.number(arb(0, float("inf"))) is None
    assert script.number(arb.pi()).text == "k1"
    assert script.lines == [
        "(declare-fun k1 () Real)",
        "(assert (<= (/ 3141592653 1000000000) k1))",
        "(assert (<= k1 (/ 1570796327 500000000)))",
    ]


def test_two_scripts_share_nothing():
    first, second = RealScript(), RealScript()
    assert first.fresh("a").text == second.fresh("a").text == "a1"
