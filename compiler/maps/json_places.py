"""Where a value stands in a JSON text that is known to be well formed."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence

# Possessive, so that nothing is kept to come back to: a string may have millions of characters.
_TOKEN = re.compile(r'[ \t\r\n]*+("[^"\\]*+(?:\\.[^"\\]*+)*+"|[][{},:]|[^][{},:" \t\r\n]++)')


def place_of(text: str, path: Sequence[str | int]) -> tuple[int, int]:
    """The offsets of a value.

    Args:
        text: a JSON text.
        path: the names of members and the numbers of elements that lead to it, from the outside;
            of members with one name, the last one.

    Returns:
        Those of the value's first token; of the whole text's first where the path leads nowhere.
    """
    place = 0
    for step in path:
        child = _child(text, place, step)
        if child is None:
            place = 0
            break
        place = child
    found = _TOKEN.match(text, place)
    return found.span(1) if found else (0, 1)


def _child(text: str, opening: int, step: str | int) -> int | None:
    """Where an element or member begins of the array or object that begins at an offset."""
    depth, number, named, found = 0, 0, isinstance(step, int), None
    before = ""
    for token in _TOKEN.finditer(text, opening):
        word = token[1]
        if depth == 1:
            if word == ":":
                named = before.startswith('"') and json.loads(before) == step
                continue
            if word not in "]},":
                if isinstance(step, int):
                    if number == step:
                        return token.start(1)
                elif named:
                    found, named = token.start(1), False
        before = word
        depth += (word in "[{") - (word in "]}")
        number += depth == 1 and word == ","
        if not depth:
            break
    return found
