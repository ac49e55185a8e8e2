"""Which edge symbols of a word label which connection of its modules.

Each symbol is used once at most.  The symbols between two modules that follow each other in the
word label the connection of these two.  Where they are not connected, the symbols go to the
connection without a label that is the nearest to the later module on the way between the two; the
last such gap of the word chooses first.  Brackets that close a branch, and branches without
modules, are no labels.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import pairwise

from compiler.graphs.neighbours import BRACKETS, OPENING, bracket_partners


def edge_labels(
    word: Sequence[str], parents: Mapping[int, int | None]
) -> dict[int, tuple[str, ...]]:
    """The labels of the connections, by the place of their upper modules.

    ``parents`` says for the place of each module, in the order of the word, what it stands on.
    """
    places = list(parents)
    partners = bracket_partners(word)
    depth = _depths(parents)
    labels: dict[int, tuple[str, ...]] = {}
    apart: list[tuple[int, int, tuple[str, ...]]] = []
    for earlier, later in pairwise(places):
        symbols = _symbols(word, earlier + 1, later, partners)
        if parents[later] == earlier:
            labels[later] = symbols
        elif parents[earlier] == later:
            labels[earlier] = symbols
        elif symbols:
            apart.append((earlier, later, symbols))
    for earlier, later, symbols in reversed(apart):
        free = (edge for edge in _way(later, earlier, parents, depth) if edge not in labels)
        chosen = next(free, None)
        if chosen is not None:
            labels[chosen] = symbols
    return labels


def _symbols(
    word: Sequence[str], start: int, end: int, partners: Mapping[int, int]
) -> tuple[str, ...]:
    """The symbols of a gap, without brackets that close and without closed branches."""
    found: list[str] = []
    place = start
    while place < end:
        symbol, partner = word[place], partners.get(place)
        if symbol in BRACKETS and partner is not None and partner < end:
            place = partner
        elif symbol not in OPENING or partner is None:
            found.append(symbol)
        place += 1
    return tuple(found)


def _depths(parents: Mapping[int, int | None]) -> dict[int, int]:
    depth: dict[int, int] = {}
    for start in parents:
        climbed: list[int] = []
        module: int | None = start
        while module is not None and module not in depth:
            climbed.append(module)
            module = parents[module]
        below = -1 if module is None else depth[module]
        for above, each in enumerate(reversed(climbed), 1):
            depth[each] = below + above
    return depth


def _way(
    here: int, there: int, parents: Mapping[int, int | None], depth: Mapping[int, int]
) -> list[int]:
    """The connections from a module to another, by their upper modules; none if in two trees."""
    near: list[int] = []
    far: list[int] = []
    while here != there:
        side = near if depth[here] >= depth[there] else far
        top = here if side is near else there
        below = parents[top]
        if below is None:
            return []
        side.append(top)
        if side is near:
            here = below
        else:
            there = below
    return near + far[::-1]
