"""Lines of a comment, as wide as a person writes them."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable

WIDTH = 97
"""Columns of a comment behind its slashes."""


def comment_lines(lines: Iterable[str]) -> str:
    """Lines as a comment; long ones are wrapped."""
    found = list[str]()
    for line in lines:
        indent = "  " if line.startswith("- ") else ""
        found += textwrap.wrap(
            printable(line), WIDTH, subsequent_indent=indent, break_on_hyphens=False
        ) or [""]
    return "\n".join(f"// {line}".rstrip() for line in found)


def printable(line: str) -> str:
    """A line without what would end the comment or upset a terminal."""
    return "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in line)
