"""Exact rationals and the texts that state them: in files a number is a decimal or a quotient."""

from __future__ import annotations

import re
from fractions import Fraction

MOST_PLACES = 1100
"""A double has 1074 places behind the point at most."""

_NUMBER = re.compile(r"-?[0-9]{1,300}(\.[0-9]{1,1100}|/[0-9]{1,300})?")
"""Decimals below 1e300, and quotients; no exponents, whose expansion has no bound."""


def shortest_decimal(value: float) -> Fraction:
    """The rational of the shortest decimal that reads back as this double."""
    return Fraction(repr(float(value)))


def decimal(value: float) -> str:
    """That decimal, without an exponent."""
    return exact_decimal(shortest_decimal(value))


def exact_decimal(value: Fraction) -> str:
    """A rational whose denominator divides a power of ten, as a decimal.

    Raises:
        ValueError: the value is no finite decimal.
    """
    digits, power = 0, 1
    while power % value.denominator:
        digits, power = digits + 1, power * 10
        if digits > MOST_PLACES:
            raise ValueError(f"{value} is no finite decimal")
    whole = str(abs(value.numerator) * (power // value.denominator)).rjust(digits + 1, "0")
    sign = "-" if value < 0 else ""
    return sign + (f"{whole[:-digits]}.{whole[-digits:]}" if digits else whole)


def exact_text(value: Fraction) -> str:
    """A rational as a finite decimal where it is one, else as a quotient."""
    try:
        return exact_decimal(value)
    except ValueError:
        return str(value)


def exact_number(text: str) -> Fraction:
    """The rational that a decimal or a quotient of whole numbers denotes.

    Raises:
        ValueError: the text is neither, or the quotient's denominator is zero.
    """
    if not _NUMBER.fullmatch(text):
        shown = text if len(text) <= 40 else f"{text[:40]}..."
        raise ValueError(f"{shown!r} is no exact number")
    try:
        return Fraction(text)
    except ZeroDivisionError:
        raise ValueError(f"{text!r} divides by zero") from None
