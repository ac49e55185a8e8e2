"""The numbers that are claimed for parameters: always members of their domains."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grammar_lang import ir
from solvers.parameters.parameter_space import exact_text, exact_value
from tests.oracles.robots import interval

values = st.fractions(-5, 5, max_denominator=60)


@given(st.lists(values, min_size=1, max_size=5), st.floats(-6, 6))
def test_choices_are_met_exactly(choices, value):
    domain = ir.Choices(tuple(ir.Num(choice) for choice in choices))
    chosen = exact_value(domain, value)
    assert chosen in choices
    assert abs(chosen - Fraction(value)) <= min(abs(c - Fraction(value)) for c in choices) + 1e-9
    assert Fraction(exact_text(domain, value)) == chosen


@given(values, values, st.floats(-6, 6))
def test_intervals_are_never_left(a, b, value):
    low, high = min(a, b), max(a, b)
    chosen = exact_value(interval(low, high), value)
    assert low <= chosen <= high
    if low <= value <= high:
        assert float(chosen) == pytest.approx(value, abs=1e-12)


def test_finite_decimals_are_written_as_decimals():
    assert exact_text(interval(1, 2), 1.25) == "1.25"
    assert exact_text(interval(1, 2), 2.0000000000000004) == "2"
    assert exact_text(interval(Fraction(1, 3), 1), 0.2) == "1/3"
