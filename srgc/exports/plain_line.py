"""A text as one printable line, as comments need it."""

from __future__ import annotations


def plain_line(text: str) -> str:
    """The text with everything that is not printable spelt out."""
    return "".join(c if c.isprintable() else f"\\u{ord(c):04x}" for c in text)
