"""Decide the ambiguity of a grammar without self-embedding.

Source: Book, Even, Greibach & Ott, *Ambiguity in graphs and expressions* (1971): a network is
ambiguous iff two different paths from the first state to the last read the same word, which is a
reachability question in the product of the network with itself.  The accept condition is
deterministic; it is a third factor of that product and adds no ambiguity.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeAlias

from compiler.words.finite_automaton import Dfa
from compiler.words.regular_automaton import Network

# The states of two paths, whether they have parted already, and the state of the accept automaton.
Pair: TypeAlias = tuple[int, int, bool, int]
Moves: TypeAlias = dict[int, dict[int, int]]

STEP_LIMIT = 20_000


@dataclass(frozen=True, slots=True)
class Decision:
    """The first of the shortest ambiguous words, as symbol numbers; None if there is none."""

    word: tuple[int, ...] | None


def decide_ambiguity(network: Network, accept: Dfa) -> Decision | None:
    """Whether some accepted non-empty word has two paths.

    None if the search would take more than ``STEP_LIMIT`` steps.
    """
    visible = _Visible.of(network)
    if visible is None:
        return None
    following = _explore(visible, accept)
    if following is None:
        return None
    distance = _distances(visible, accept, following)
    start: Pair = (0, 0, False, 0)
    if start not in distance:
        return Decision(None)
    return Decision(_first_word(start, following, distance))


@dataclass(frozen=True, slots=True)
class _Visible:
    """The moves under terminals, with the moves under the empty word merged into them.

    ``moves[p][a][q]`` is the number of ways from p to q that read a, and ``ends[p]`` is the number
    of ways to the last state that read nothing; 2 stands for more.  ``opening[p]`` is the bit set
    of the terminals that may come next, with the lowest bit for the end.
    """

    moves: dict[int, Moves]
    ends: dict[int, int]
    opening: dict[int, int]

    @staticmethod
    def of(network: Network) -> _Visible | None:
        """The visible moves of a network; None if there would be more than ``STEP_LIMIT``."""
        moves: dict[int, Moves] = {}
        ends: dict[int, int] = {}
        steps = 0
        for state in _by_empty_moves(network):
            own: Moves = {}
            end = int(state == 1)
            for symbol, target in network.moves[state]:
                if symbol is not None:
                    _count(own, symbol, target, 1)
                    continue
                end += ends[target]
                for a, row in moves[target].items():
                    steps += len(row)
                    for q, ways in row.items():
                        _count(own, a, q, ways)
            if steps > STEP_LIMIT:
                return None
            moves[state], ends[state] = own, min(end, 2)
        opening = {
            state: sum(1 << a + 1 for a in own) | (ends[state] > 0) for state, own in moves.items()
        }
        return _Visible(moves, ends, opening)


def _count(moves: Moves, symbol: int, target: int, ways: int) -> None:
    row = moves.setdefault(symbol, {})
    row[target] = min(row.get(target, 0) + ways, 2)


def _by_empty_moves(network: Network) -> Iterator[int]:
    """The states, each after those that its empty moves lead to (empty moves have no cycle)."""
    done: set[int] = set()
    for root in range(len(network.moves)):
        todo = [] if root in done else [root]
        while todo:
            state = todo[-1]
            waiting = [q for a, q in network.moves[state] if a is None and q not in done]
            if waiting:
                todo += waiting
                continue
            todo.pop()
            if state not in done:
                done.add(state)
                yield state


def _explore(visible: _Visible, accept: Dfa) -> dict[Pair, list[tuple[int, Pair]]] | None:
    """The pairs that a common word leads to, with their successors; None beyond the limit."""
    live = accept.live()
    start: Pair = (0, 0, False, 0)
    following: dict[Pair, list[tuple[int, Pair]]] = {}
    todo = [start] if live[0] else []
    steps = 0
    while todo:
        pair = todo.pop()
        if pair in following:
            continue
        row: list[tuple[int, Pair]] = []
        following[pair] = row
        for successor in _successors(pair, visible, accept, live):
            row.append(successor)
            todo.append(successor[1])
        steps += len(row) + 1
        if steps > STEP_LIMIT:
            return None
    return following


def _successors(
    pair: Pair, visible: _Visible, accept: Dfa, live: tuple[bool, ...]
) -> Iterator[tuple[int, Pair]]:
    p, q, parted, state = pair
    second = visible.moves[q]
    for symbol, targets in visible.moves[p].items():
        after = accept.step(state, symbol)
        if not live[after] or symbol not in second:
            continue
        found = _parted(targets, second[symbol], visible) if parted else _parting(targets, visible)
        for r, s, apart in found:
            yield symbol, (r, s, apart, after)


def _parted(
    first: dict[int, int], second: dict[int, int], visible: _Visible
) -> Iterator[tuple[int, int, bool]]:
    """Continue two paths that have parted, if they may agree on the next symbol."""
    opening = visible.opening
    for r in first:
        for s in second:
            if opening[r] & opening[s]:
                yield min(r, s), max(r, s), True


def _parting(targets: dict[int, int], visible: _Visible) -> Iterator[tuple[int, int, bool]]:
    """Continue one path, or part it into two that may agree on the next symbol."""
    opening = visible.opening
    seen: dict[int, list[int]] = {}
    for r, ways in targets.items():
        yield r, r, False
        if ways > 1:
            yield r, r, True
        rivals: set[int] = set()
        for bit in _bits(opening[r]):
            same = seen.setdefault(bit, [])
            rivals.update(same)
            same.append(r)
        for s in sorted(rivals):
            yield min(r, s), max(r, s), True


def _bits(mask: int) -> Iterator[int]:
    while mask:
        low = mask & -mask
        yield low.bit_length() - 1
        mask ^= low


def _distances(
    visible: _Visible, accept: Dfa, following: dict[Pair, list[tuple[int, Pair]]]
) -> dict[Pair, int]:
    """The pairs from which two different paths can end together, with the least word length."""
    before: dict[Pair, list[Pair]] = {}
    for pair, row in following.items():
        for _, successor in row:
            before.setdefault(successor, []).append(pair)
    level = [pair for pair in following if _ends_ambiguously(pair, visible, accept)]
    distance = dict.fromkeys(level, 0)
    length = 0
    while level:
        length += 1
        reached = dict.fromkeys(
            pair for later in level for pair in before.get(later, ()) if pair not in distance
        )
        distance.update(dict.fromkeys(reached, length))
        level = list(reached)
    return distance


def _ends_ambiguously(pair: Pair, visible: _Visible, accept: Dfa) -> bool:
    p, q, parted, state = pair
    if not accept.accepting[state] or p == 0:
        return False
    if parted:
        return visible.ends[p] > 0 and visible.ends[q] > 0
    return visible.ends[p] > 1


def _first_word(
    start: Pair, following: dict[Pair, list[tuple[int, Pair]]], distance: dict[Pair, int]
) -> tuple[int, ...]:
    """The lexicographically first of the shortest words."""
    word: list[int] = []
    here = {start}
    for rest in range(distance[start] - 1, -1, -1):
        closer = [
            (symbol, pair)
            for origin in here
            for symbol, pair in following[origin]
            if distance.get(pair) == rest
        ]
        symbol = min(symbol for symbol, _ in closer)
        word.append(symbol)
        here = {pair for other, pair in closer if other == symbol}
    return tuple(word)
