"""What may come first: the left corners of nonterminals, and where reading goes on after them.

A nonterminal that is called calls those at the left end of its right sides in turn (Rosenkrantz &
Lewis 1970).  All of it is known before any word is read, so it is laid out once per set of
nonterminals called together, and per terminal that may come next.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

from compiler.grammars.binary_normal_form import BinaryGrammar
from compiler.grammars.grammar import components

CACHE_LIMIT = 10_000


class Frame(NamedTuple):
    """After a call: go on with ``symbol``, and then where ``caller`` goes on."""

    symbol: int
    caller: int


@dataclass(frozen=True, slots=True)
class Group:
    """Nonterminals whose calls depend on each other, each with its frames.

    ``inner``: the frames of callers within the group; ``outer``: the others.
    """

    members: tuple[int, ...]
    outer: tuple[tuple[Frame, ...], ...]
    inner: tuple[tuple[Frame, ...], ...]


@dataclass(frozen=True, slots=True)
class Move:
    """What one terminal leads to.

    ``groups``: the groups that matter, callers before the called.  ``frames``: a symbol comes
    next, and then reading goes on after the nonterminal; ``ends``: these nonterminals end.
    """

    groups: tuple[Group, ...]
    frames: tuple[Frame, ...]
    ends: tuple[int, ...]


class LeftCorners:
    """The left corners of a grammar, remembered per set of nonterminals called together."""

    def __init__(self, grammar: BinaryGrammar) -> None:
        self.grammar = grammar
        self._known: dict[frozenset[int], dict[int, Move]] = {}

    def moves(self, called: frozenset[int]) -> dict[int, Move]:
        """The move under each terminal that may come next when these are called."""
        known = self._known.get(called)
        if known is None:
            if len(self._known) >= CACHE_LIMIT:
                self._known.clear()
            known = self._known[called] = self._lay_out(called)
        return known

    def _lay_out(self, called: frozenset[int]) -> dict[int, Move]:
        frames = self._frames(called)
        rank, groups = _groups(frames)
        first, rules = self.grammar.terminals, self.grammar.rules
        following: dict[int, dict[Frame, None]] = {}
        ends: dict[int, dict[int, None]] = {}
        for symbol in frames:
            for right in rules[symbol - first]:
                if right[0] >= first:
                    continue
                if len(right) == 1:
                    ends.setdefault(right[0], {})[symbol] = None
                else:
                    following.setdefault(right[0], {})[Frame(right[1], symbol)] = None
        moves: dict[int, Move] = {}
        for terminal in sorted({*following, *ends}):
            after = tuple(following.get(terminal, ()))
            last = tuple(ends.get(terminal, ()))
            needed = _above({*last, *(frame.caller for frame in after)}, frames)
            order = sorted({rank[symbol] for symbol in needed}, reverse=True)
            moves[terminal] = Move(tuple(groups[number] for number in order), after, last)
        return moves

    def _frames(self, called: frozenset[int]) -> dict[int, dict[Frame, None]]:
        """All nonterminals called, each with its frames."""
        first = self.grammar.terminals
        frames: dict[int, dict[Frame, None]] = {symbol: {} for symbol in sorted(called)}
        todo = list(frames)
        while todo:
            caller = todo.pop()
            for right in self.grammar.rules[caller - first]:
                if right[0] < first:
                    continue
                if right[0] not in frames:
                    frames[right[0]] = {}
                    todo.append(right[0])
                frames[right[0]][Frame(right[1], caller)] = None
        return frames


def _groups(frames: dict[int, dict[Frame, None]]) -> tuple[dict[int, int], dict[int, Group]]:
    """The number of the group of each nonterminal, callers having the larger ones, and the groups.

    They are the strongly connected components of the calls.
    """
    place = {symbol: i for i, symbol in enumerate(frames)}
    called: list[list[int]] = [[] for _ in place]
    for symbol, row in frames.items():
        for frame in row:
            called[place[frame.caller]].append(place[symbol])
    component = components(len(place), called.__getitem__)
    rank = {symbol: component[i] for symbol, i in place.items()}
    members: dict[int, list[int]] = {}
    for symbol in sorted(frames):
        members.setdefault(rank[symbol], []).append(symbol)
    groups = {
        number: Group(
            tuple(row),
            tuple(tuple(f for f in frames[s] if rank[f.caller] != number) for s in row),
            tuple(tuple(f for f in frames[s] if rank[f.caller] == number) for s in row),
        )
        for number, row in members.items()
    }
    return rank, groups


def _above(symbols: set[int], frames: dict[int, dict[Frame, None]]) -> set[int]:
    """The nonterminals, their callers, the callers of these, and so on."""
    found = set(symbols)
    todo = list(symbols)
    while todo:
        for frame in frames[todo.pop()]:
            if frame.caller not in found:
                found.add(frame.caller)
                todo.append(frame.caller)
    return found
