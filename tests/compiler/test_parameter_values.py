"""The values that are stated for parameters: always members of their domains."""

from __future__ import annotations

from fractions import Fraction
from math import pi

import pytest
from flint import arb
from hypothesis import given
from hypothesis import strategies as st

from compiler.expressions.evaluators.balls import ball, working_precision
from compiler.expressions.exact_numbers import exact_number
from compiler.robots.parameter_values import (
    ParameterValue,
    nearest_value,
    nearest_values,
    stated_value,
)
from compiler.robots.robot import RobotParameter
from grammar_lang import ir
from tests.oracles.robots import interval

Domain = ir.Interval | ir.Choices
values = st.fractions(-5, 5, max_denominator=60)


def parameter(domain: Domain) -> RobotParameter:
    return RobotParameter(4, "L", "length", domain, "m")


def nearest(domain: Domain, value: float) -> ParameterValue:
    found = nearest_value(parameter(domain), value)
    assert found is not None
    return found


def degrees(value: int) -> ir.Expr:
    return ir.Binary("*", ir.Num(Fraction(value, 180)), ir.Pi())


@given(st.lists(values, min_size=1, max_size=5), st.floats(-6, 6))
def test_choices_are_met_exactly(choices, value):
    found = nearest(ir.Choices(tuple(ir.Num(choice) for choice in choices)), value)
    chosen = found.exact
    assert chosen in choices
    assert found.stated == chosen
    assert abs(chosen - Fraction(value)) <= min(abs(c - Fraction(value)) for c in choices) + 1e-9
    assert Fraction(found.text) == chosen


@given(values, values, st.floats(-6, 6))
def test_intervals_are_never_left(a, b, value):
    low, high = min(a, b), max(a, b)
    chosen = nearest(interval(low, high), value).exact
    assert low <= chosen <= high
    if low <= value <= high:
        assert float(chosen) == pytest.approx(value, abs=1e-12)


def test_finite_decimals_are_written_as_decimals():
    assert nearest(interval(1, 2), 1.25).text == "1.25"
    assert nearest(interval(1, 2), 2.0000000000000004).text == "2"
    assert nearest(interval(Fraction(1, 3), 1), 0.2).text == "1/3"


@given(values, values, st.floats(-6, 6))
def test_the_text_is_read_back_as_the_same_value(a, b, value):
    found = nearest(interval(min(a, b), max(a, b)), value)
    assert stated_value(found.parameter, exact_number(found.text)) == found


def test_an_angle_that_no_decimal_is():
    """The double next to pi / 2 states it; the value is pi / 2 itself."""
    found = nearest(ir.Choices((ir.Num(Fraction(0)), degrees(90))), 1.5)
    assert found.exact == degrees(90)
    assert found.text == "1.5707963267948966"
    assert float(found) == pi / 2
    with working_precision(128):
        assert found.ball.overlaps(arb.pi() / 2)
        assert not found.ball.overlaps(ball(found.stated))


def test_the_entry_of_a_design():
    assert nearest(interval(1, 2), 1.25).describe() == {
        "symbol": 4, "module": "L", "name": "length", "value": 1.25, "unit": "m",
    }  # fmt: skip


def test_all_parameters_of_a_robot():
    known = [parameter(interval(0, 1)), parameter(ir.Choices((ir.Num(Fraction(1, 3)),)))]
    found = nearest_values(known, [0.5, 0.3])
    assert found is not None
    assert [value.exact for value in found] == [Fraction(1, 2), Fraction(1, 3)]
    beyond = parameter(ir.Interval(ir.Num(Fraction(0)), degrees(90)))
    assert nearest_values([*known, beyond], [0.5, 0.3, 1.6]) is None


def test_stated_values() -> None:
    def stated(domain: Domain, rational: Fraction) -> Fraction | ir.Expr | None:
        found = stated_value(parameter(domain), rational)
        return None if found is None else found.exact

    zero, right = ir.Num(Fraction(0)), degrees(90)
    choices = ir.Choices((zero, right))
    assert stated(choices, Fraction(0)) == 0
    assert stated(choices, Fraction(1, 10**12)) is None
    assert stated(choices, Fraction(repr(pi / 2))) == right
    assert stated(choices, Fraction(repr(pi / 2)) + Fraction(1, 10**8)) is None
    assert stated(ir.Interval(right, right), Fraction(repr(pi / 2))) == right
    span = ir.Interval(zero, right)
    assert stated(span, Fraction(3, 2)) == Fraction(3, 2)
    assert stated(span, Fraction("1.57079632680")) == right
    assert stated(span, Fraction("1.5708")) is None
