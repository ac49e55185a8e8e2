"""A number of things, in words."""

from __future__ import annotations


def counted(number: int, what: str) -> str:
    """``1 error``, ``2 errors``, ``1,200 errors``."""
    return f"{number:,} {what}{'' if number == 1 else 's'}"
