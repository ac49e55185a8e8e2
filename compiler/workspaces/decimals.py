"""Numbers of maps: the exact rationals of their decimals, never converted through floats."""

from __future__ import annotations

import re
from fractions import Fraction

MAX_DIGITS = 300
"""The most characters of a number, and the greatest size of its power of ten."""

_LARGEST = 10**MAX_DIGITS
_DECIMAL = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eE]([+-]?[0-9]{1,9}))?")


def decimal(text: str) -> Fraction | None:
    """The value of a decimal such as ``-0.05``, ``.5`` or ``5e-2``; None for anything else.

    Infinities, NaN and numbers beyond ``MAX_DIGITS`` also give None, so every value has a finite
    float near it.
    """
    found = _DECIMAL.fullmatch(text)
    if found is None or len(text) > MAX_DIGITS or abs(int(found[1] or 0)) > MAX_DIGITS:
        return None
    value = Fraction(text)
    return value if abs(value) <= _LARGEST else None
