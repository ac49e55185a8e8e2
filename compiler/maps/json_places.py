"""Where a value stands in a JSON text that is known to be well formed."""

from __future__ import annotations

import json
import re
from collections.abc import Sequence

_TOKEN = re.compile(r'[ \t\r\n]*("(?:[^"\\]|\\.)*"|[][{},:]|[^][{},:" \t\r\n]+)')


def place_of(text: str, path: Sequence[str | int]) -> tuple[int, int]:
    """The offsets of a value.

    Args:
        text: a JSON text.
        path: the names of members and the numbers of elements that lead to it, from the outside;
            of members with one name, the last one.

    Returns:
        Those of the value's first token; of the whole text's first where the path leads nowhere.
    """
    tokens = [(found[1], found.start(1)) for found in _TOKEN.finditer(text)]
    position = 0
    for step in path:
        found = _child(tokens, position, step)
        if found is None:
            position = 0
            break
        position = found
    word, start = tokens[position]
    return start, start + len(word)


def _child(tokens: list[tuple[str, int]], opening: int, step: str | int) -> int | None:
    """The position of an element or member of the array or object that opens at a position."""
    depth, number, named, found = 0, 0, isinstance(step, int), None
    for position in range(opening, len(tokens)):
        word = tokens[position][0]
        if depth == 1 and word not in "]},:":
            if isinstance(step, int):
                if number == step:
                    return position
            elif named:
                found, named = position, False
            else:
                is_key = word.startswith('"') and tokens[position + 1][0] == ":"
                named = is_key and json.loads(word, strict=False) == step
        depth += (word in "[{") - (word in "]}")
        number += depth == 1 and word == ","
        if not depth:
            break
    return found
