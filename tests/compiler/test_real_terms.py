from fractions import Fraction

import pytest

from compiler.real_terms import RealScript


@pytest.fixture
def script():
    return RealScript()


def test_constants_fold_exactly(script):
    third = script.constant(Fraction(1, 3))
    assert script.add(third, third, third).value == 1
    assert script.multiply(third, script.constant(3)).value == 1
    assert script.subtract(third, third).value == 0


def test_zero_and_one_vanish(script):
    x = script.declare("x")
    assert script.multiply(script.constant(0), x).value == 0
    assert script.multiply(x, script.constant(1)).term is x.term
    assert script.add(x, script.constant(0)).term is x.term
    assert script.negate(script.negate(x)).term is x.term


def test_factors_are_collected(script):
    x, y = script.declare("x"), script.declare("y")
    script.assertion(script.equal(script.multiply(script.negate(x), script.negate(y)), x))
    assert script.lines[-1] == "(assert (= (* x y) x))"


def test_rationals_are_printed_as_quotients(script):
    x = script.declare("x")
    script.assertion(script.between((Fraction(-1, 2), Fraction(3)), x))
    assert script.lines[-2:] == ["(assert (<= (- (/ 1 2)) x))", "(assert (<= x 3.0))"]


def test_what_is_decided_needs_no_solver(script):
    one, two = script.constant(1), script.constant(2)
    script.assertion(script.at_most(one, two))
    assert script.lines == []
    script.assertion(script.equal(one, two))
    assert script.lines == ["(assert false)"]


def test_naming_keeps_leaves(script):
    x = script.declare("x")
    assert script.named("a", x) is x
    assert script.named("a", script.negate(x)).term.is_times()
    square = script.multiply(x, x)
    assert script.named("a", square).term.symbol_name() == "a1"
    assert script.lines[-1] == "(assert (= a1 (* x x)))"


def test_two_scripts_share_nothing():
    first, second = RealScript(), RealScript()
    assert first.fresh("a").term.symbol_name() == second.fresh("a").term.symbol_name() == "a1"
    assert first.environment is not second.environment
