"""Comments of specs, wrapped to the usual width."""

from __future__ import annotations

import textwrap
from collections.abc import Iterable

WIDTH = 97
"""The most columns of a line of a comment, after its slashes."""


def comment_lines(lines: Iterable[str]) -> str:
    """A comment with these lines; long lines are wrapped."""
    found = list[str]()
    for line in lines:
        indent = "  " if line.startswith("- ") else ""
        found += textwrap.wrap(
            printable(line), WIDTH, subsequent_indent=indent, break_on_hyphens=False
        ) or [""]
    return "\n".join(f"// {line}".rstrip() for line in found)


def printable(line: str) -> str:
    """A line without characters that would end the comment or disturb a terminal."""
    return "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in line)
