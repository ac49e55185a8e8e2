"""Decimals and quotients, and the rationals that they state."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from compiler.expressions.exact_numbers import (
    decimal,
    exact_decimal,
    exact_number,
    exact_text,
    shortest_decimal,
)


@given(st.floats(-1e299, 1e299))
def test_a_double_as_a_decimal(value):
    text = decimal(value)
    assert float(text) == value
    assert "e" not in text
    assert exact_number(text) == Fraction(text)


@given(st.one_of(st.floats(-1e299, 1e299), st.floats(-10, 10), st.integers(-100, 100).map(float)))
@example(-0.0)
def test_a_double_has_the_decimal_of_its_rational(value):
    assert decimal(value) == exact_decimal(shortest_decimal(value))


@given(st.integers(), st.integers(0, 40), st.integers(0, 40))
def test_exact_decimals(numerator, twos, fives):
    value = Fraction(numerator, 2**twos * 5**fives)
    assert Fraction(exact_decimal(value)) == value


def test_a_third_is_no_decimal():
    with pytest.raises(ValueError, match="1/3"):
        exact_decimal(Fraction(1, 3))


@given(st.fractions())
def test_texts_are_read_back(value):
    assert exact_number(exact_text(value)) == value


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_the_shortest_decimal_reads_back_as_the_double(value):
    assert float(shortest_decimal(value)) == value
    assert len(str(shortest_decimal(0.1).denominator)) == 2
