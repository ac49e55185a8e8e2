"""Numbers of two significant digits, for values that a person would write."""

from __future__ import annotations

from fractions import Fraction

DECADE = 90
"""The count of such numbers from one power of ten to the next."""


def number_of(index: int) -> Fraction:
    """The positive number with an index: 1, 1.1, …, 9.9 have 0 to 89, 10 has 90."""
    decade, place = divmod(index, DECADE)
    return Fraction(10 + place, 10) * Fraction(10) ** decade


def index_above(value: Fraction) -> int:
    """The index of the least such number that is at least ``value``, which is positive.

    Raises:
        ValueError: ``value`` is not positive.
    """
    if value <= 0:
        raise ValueError("a positive number is expected")
    decade = 0
    while value >= Fraction(10) ** (decade + 1):
        decade += 1
    while value < Fraction(10) ** decade:
        decade -= 1
    tenths = value * 10 / Fraction(10) ** decade
    return decade * DECADE + (-(-tenths.numerator // tenths.denominator) - 10)


def index_below(value: Fraction) -> int:
    """The index of the largest such number that is at most ``value``, which is positive."""
    index = index_above(value)
    return index if number_of(index) == value else index - 1


def rounded_up(value: Fraction) -> Fraction:
    """The least number of two digits that is at least ``value``, which is positive."""
    return number_of(index_above(value))
