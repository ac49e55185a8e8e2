"""What every part of a page is put together with: escaped text, short numbers, data for scripts."""

from __future__ import annotations

import json
import re
from html import escape
from math import isfinite

_INVISIBLE = re.compile(
    "[\x00-\x08\x0b-\x1f\x7f-\x9f\ud800-\udfff\ufffe\uffff\u202a-\u202e\u2066-\u2069]"
)
"""What HTML does not allow, and what turns the direction of writing in a name."""


def text(content: object) -> str:
    """Text for an element or an attribute; what may not stand there is replaced by U+FFFD."""
    return escape(_INVISIBLE.sub("\ufffd", str(content)))


def number(value: float, digits: int = 4) -> str:
    """A number to so many significant digits, without an exponent where that is short."""
    if not isfinite(value):
        return "∞" if value > 0 else "-∞" if value < 0 else "none"
    short = f"{value:.{digits}g}"
    if "e" in short and 1e-6 <= abs(value) < 1e9:
        short = f"{float(short):.12f}".rstrip("0").rstrip(".")
    mantissa, mark, exponent = short.partition("e")
    if mark:
        return f"{mantissa}e{int(exponent)}"
    return "0" if short == "-0" else short


def with_unit(value: float, unit: str, digits: int = 4) -> str:
    """A number with its unit, a middle dot for the product; dimensionless ones stand alone."""
    shown = number(value, digits)
    return shown if unit in ("", "1") else f"{shown} {unit.replace('*', '·')}"


LONGEST_NAME = 24
"""Characters of a name that pictures have room for."""


def name_in_picture(name: str) -> str:
    """A name, its middle left out where it is too long for a picture."""
    if len(name) <= LONGEST_NAME:
        return name
    return f"{name[: LONGEST_NAME - 9]}…{name[-8:]}"


def many(count: int, thing: str) -> str:
    """How many of a thing there are, in words that fit the number."""
    plural = f"{thing}es" if thing.endswith("x") else f"{thing}s"
    return f"{count} {thing if count == 1 else plural}"


def json_script(name: str, data: object) -> str:
    """Data for a script of the page, in an element of that id; nothing in it can end that."""
    content = json.dumps(data, ensure_ascii=True, separators=(",", ":"), allow_nan=False)
    for character in "<>&":
        content = content.replace(character, f"\\u{ord(character):04x}")
    return f'<script type="application/json" id="{text(name)}">{content}</script>'
