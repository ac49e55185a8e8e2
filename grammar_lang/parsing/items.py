"""Cuts tokens into top-level items, so that an error in one does not hide those in others.

An item ends with the ``;`` outside all braces or the ``}`` that closes its last brace.  Where a
brace is missing, ``KEYWORD NAME {`` at the beginning of a statement starts a new item: no
statement of the language looks like that.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

from grammar_lang.parsing.tokens import WORD, Tokens

BLOCK_KEYWORDS = frozenset({"module", "grammar", "semantics", "workspace", "task"})
KEYWORDS = BLOCK_KEYWORDS | {"edge", "include"}


@dataclass(frozen=True, slots=True)
class RawItem:
    """The tokens ``first <= i < stop`` of one item; ``braces`` are the ``{`` nothing closes."""

    first: int
    stop: int
    braces: tuple[int, ...]


def _starts_item(tokens: Tokens, here: int, *, inside: bool) -> bool:
    """Whether ``KEYWORD NAME {`` stands here, where a statement may begin."""
    kinds = tokens.kinds
    if here + 2 >= len(kinds) or kinds[here] != WORD or kinds[here + 2] != "{":
        return False
    if kinds[here + 1] != WORD or tokens.at(here) not in BLOCK_KEYWORDS:
        return False
    return not inside or kinds[here - 1] in {";", "{", "}"}


def cut(tokens: Tokens) -> Iterator[RawItem]:
    """The items in order; every token belongs to one."""
    kinds = tokens.kinds
    braces: list[int] = []
    first = 0
    for here, kind in enumerate(kinds):
        if kind == WORD:
            if here > first and _starts_item(tokens, here, inside=bool(braces)):
                yield RawItem(first, here, tuple(braces))
                first, braces = here, []
        elif kind == "{":
            braces.append(here)
        elif kind == "}" or kind == ";":
            if kind == "}" and braces:
                braces.pop()
            if not braces:
                yield RawItem(first, here + 1, ())
                first = here + 1
    if first < len(kinds):
        yield RawItem(first, len(kinds), tuple(braces))
