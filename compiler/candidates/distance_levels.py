"""The words at a given number of modules added to or removed from a word, as a finite automaton.

A state is a row of the table of distances between a prefix that was read and all prefixes of the
word (Wagner & Fischer 1974, with deletions and insertions only), cut off above the distance asked
for (Schulz & Mihov 2002).  Edges are read and not counted.
"""

from __future__ import annotations

from collections.abc import Container, Sequence
from typing import TypeAlias

from compiler.automata.finite_automaton import STATE_LIMIT, AutomatonTooLargeError, Dfa, minimal
from compiler.time_limits.time_limit import check_time

Row: TypeAlias = tuple[int, ...]


def at_distance(
    alphabet: tuple[str, ...],
    modules: Container[str],
    word: Sequence[str],
    distance: int,
    limit: int = STATE_LIMIT,
) -> Dfa:
    """The words whose modules differ from those of ``word`` by so many, added or removed; minimal.

    Raises:
        AutomatonTooLargeError: there would be more than ``limit`` states.
    """
    aim = [symbol for symbol in word if symbol in modules]
    over = distance + 1
    first = tuple(min(i, over) for i in range(len(aim) + 1))
    rows, number = [first], {first: 0}
    table: list[int] = []
    for row in rows:
        check_time()
        for symbol in alphabet:
            following = _next(row, symbol, aim, over) if symbol in modules else row
            if following not in number:
                if len(rows) >= limit:
                    raise AutomatonTooLargeError(limit)
                number[following] = len(rows)
                rows.append(following)
            table.append(number[following])
    return minimal(Dfa(alphabet, tuple(table), tuple(row[-1] == distance for row in rows)))


def distance_from(modules: Container[str], word: Sequence[str], other: Sequence[str]) -> int:
    """The number of modules to be added to a word or removed from it to get those of another."""
    aim = [symbol for symbol in word if symbol in modules]
    over = len(aim) + len(other) + 1
    row = tuple(range(len(aim) + 1))
    for symbol in other:
        if symbol in modules:
            row = _next(row, symbol, aim, over)
    return row[-1]


def _next(row: Row, symbol: str, aim: Sequence[str], over: int) -> Row:
    """The row after one more module; ``over`` stands for all larger distances."""
    entries = [min(row[0] + 1, over)]
    for i, other in enumerate(aim, 1):
        found = row[i - 1] if symbol == other else min(row[i], entries[-1]) + 1
        entries.append(min(found, over))
    return tuple(entries)
