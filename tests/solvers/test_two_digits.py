"""Numbers of two significant digits against the decimals of the standard library."""

from __future__ import annotations

from decimal import ROUND_CEILING, ROUND_FLOOR, Context
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from solvers.explanation.two_digits import index_above, index_below, number_of, rounded_up

VALUES = st.decimals(min_value="1e-6", max_value="1e6", places=9)


@given(VALUES)
def test_they_are_the_nearest_decimals(value) -> None:  # type: ignore[no-untyped-def]
    above = Context(prec=2, rounding=ROUND_CEILING).plus(value)
    below = Context(prec=2, rounding=ROUND_FLOOR).plus(value)
    assert rounded_up(Fraction(value)) == Fraction(above)
    assert number_of(index_below(Fraction(value))) == Fraction(below)


@given(st.integers(-400, 400))
def test_indices_are_in_order(index: int) -> None:
    assert number_of(index) < number_of(index + 1)
    assert index_above(number_of(index)) == index == index_below(number_of(index))


def test_zero_has_no_index() -> None:
    with pytest.raises(ValueError, match="positive"):
        index_above(Fraction(0))
