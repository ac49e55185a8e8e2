"""Markdown pages as their fenced blocks and the fragments of their headings."""

from __future__ import annotations

import re
from collections import Counter
from dataclasses import dataclass

_FENCE = re.compile(r"^```(\w+)[ ]*(\S*)\n(.*?)^```$", re.MULTILINE | re.DOTALL)
_HEADING = re.compile(r"^#+ (.+)$", re.MULTILINE)


@dataclass(frozen=True, slots=True)
class Block:
    """A fenced block; ``name`` is the file that it is, empty where it is none."""

    kind: str
    name: str
    body: str
    line: int


def blocks(text: str) -> tuple[Block, ...]:
    """The fenced blocks of a page in order; lines count from 1."""
    return tuple(
        Block(found[1], found[2], found[3], text.count("\n", 0, found.start()) + 1)
        for found in _FENCE.finditer(text)
    )


def files(text: str) -> dict[str, str]:
    """The files that a page shows, by name; no two have one name."""
    named = [block for block in blocks(text) if block.name]
    found = {block.name: block.body for block in named}
    assert len(found) == len(named), "two files of one name"
    return found


def prose(text: str) -> str:
    """A page without its blocks."""
    return _FENCE.sub("", text)


def anchors(text: str) -> set[str]:
    """The fragments of a page's headings, as GitHub makes them."""
    found: set[str] = set()
    seen: Counter[str] = Counter()
    for heading in _HEADING.findall(prose(text)):
        plain = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading).lower()
        fragment = re.sub(r"[^\w\- ]", "", plain).replace(" ", "-")
        found.add(f"{fragment}-{seen[fragment]}" if seen[fragment] else fragment)
        seen[fragment] += 1
    return found
