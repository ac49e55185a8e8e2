"""Left corners of nonterminals: the terminals that may come first, and how reading goes on.

A called nonterminal in turn calls those at the left end of its right sides (Rosenkrantz & Lewis
1970).  All this is known before any word is read.  So it is computed once for each set of
nonterminals called together, and for each terminal that may come next.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import NamedTuple

from compiler.words.grammar import components
from compiler.words.intersection import BinaryGrammar

CACHE_LIMIT = 10_000


class Frame(NamedTuple):
    """After a call, read ``symbol``, and then go on as after ``caller``."""

    symbol: int
    caller: int


class Group(NamedTuple):
    """Nonterminals with mutually dependent calls; for each member, what comes after it.

    ``inner``: frames of callers within the group; ``outer``: frames of other callers.  ``above``:
    callers in other groups that end with the member; ``direct``: members that end with it,
    including itself.
    """

    members: tuple[int, ...]
    outer: tuple[tuple[Frame, ...], ...]
    inner: tuple[tuple[Frame, ...], ...]
    above: tuple[tuple[int, ...], ...]
    direct: tuple[tuple[int, ...], ...]


class Move(NamedTuple):
    """The effect of one terminal.

    ``groups``: the groups involved, callers first.  ``frames``: a symbol comes next, and then
    reading goes on as after the caller; ``ends``: these nonterminals end.
    """

    groups: tuple[Group, ...]
    frames: tuple[Frame, ...]
    ends: tuple[int, ...]


@dataclass(slots=True)
class _Called:
    """What comes after a nonterminal: ``frames``, and whatever comes after ``units``."""

    frames: dict[Frame, None] = field(default_factory=dict)
    units: dict[int, None] = field(default_factory=dict)

    def callers(self) -> Iterator[int]:
        """All callers, possibly with repetitions."""
        yield from self.units
        yield from (frame.caller for frame in self.frames)


class LeftCorners:
    """The left corners of a grammar in binary form, cached by the set of nonterminals called."""

    def __init__(self, grammar: BinaryGrammar) -> None:
        self.grammar = grammar
        self._known: dict[frozenset[int], dict[int, Move]] = {}

    def moves(self, called: frozenset[int]) -> dict[int, Move]:
        """The move under each terminal that may come next when these nonterminals are called."""
        known = self._known.get(called)
        if known is None:
            if len(self._known) >= CACHE_LIMIT:
                self._known.clear()
            known = self._known[called] = self._lay_out(called)
        return known

    def _lay_out(self, called: frozenset[int]) -> dict[int, Move]:
        calls = self._calls(called)
        rank, groups = _groups(calls)
        first, rules = self.grammar.terminals, self.grammar.rules
        following: dict[int, dict[Frame, None]] = {}
        ends: dict[int, dict[int, None]] = {}
        for symbol in calls:
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
            needed = _above({*last, *(frame.caller for frame in after)}, calls)
            order = sorted({rank[symbol] for symbol in needed}, reverse=True)
            moves[terminal] = Move(tuple(groups[number] for number in order), after, last)
        return moves

    def _calls(self, called: frozenset[int]) -> dict[int, _Called]:
        """All nonterminals called, each with what comes after it."""
        first = self.grammar.terminals
        calls = {symbol: _Called() for symbol in sorted(called)}
        todo = list(calls)
        while todo:
            caller = todo.pop()
            for right in self.grammar.rules[caller - first]:
                if right[0] < first:
                    continue
                if right[0] not in calls:
                    calls[right[0]] = _Called()
                    todo.append(right[0])
                if len(right) == 1:
                    calls[right[0]].units[caller] = None
                else:
                    calls[right[0]].frames[Frame(right[1], caller)] = None
        return calls


def _groups(calls: dict[int, _Called]) -> tuple[dict[int, int], dict[int, Group]]:
    """The group number of each nonterminal, larger for callers, and the groups.

    Groups are the strongly connected components of the calls.
    """
    place = {symbol: i for i, symbol in enumerate(calls)}
    called: list[list[int]] = [[] for _ in place]
    for symbol, after in calls.items():
        for caller in after.callers():
            called[place[caller]].append(place[symbol])
    component = components(len(place), called.__getitem__)
    rank = {symbol: component[i] for symbol, i in place.items()}
    members: dict[int, list[int]] = {}
    for symbol in sorted(calls):
        members.setdefault(rank[symbol], []).append(symbol)
    return rank, {number: _group(row, number, rank, calls) for number, row in members.items()}


def _group(
    members: list[int], number: int, rank: dict[int, int], calls: dict[int, _Called]
) -> Group:
    """The group of one component; a unit within it passes on what comes after the caller."""
    ends = [_ending_with(member, number, rank, calls) for member in members]
    frames = [dict.fromkeys(f for end in row for f in calls[end].frames) for row in ends]
    units = [dict.fromkeys(u for end in row for u in calls[end].units) for row in ends]
    return Group(
        tuple(members),
        tuple(tuple(f for f in row if rank[f.caller] != number) for row in frames),
        tuple(tuple(f for f in row if rank[f.caller] == number) for row in frames),
        tuple(tuple(u for u in row if rank[u] != number) for row in units),
        tuple(map(tuple, ends)),
    )


def _ending_with(
    symbol: int, number: int, rank: dict[int, int], calls: dict[int, _Called]
) -> list[int]:
    """The nonterminals of a group that end where ``symbol`` ends, itself first."""
    found = {symbol: None}
    todo = [symbol]
    while todo:
        for caller in calls[todo.pop()].units:
            if rank[caller] == number and caller not in found:
                found[caller] = None
                todo.append(caller)
    return list(found)


def _above(symbols: set[int], calls: dict[int, _Called]) -> set[int]:
    """The nonterminals and all their direct and indirect callers."""
    found = set(symbols)
    todo = list(symbols)
    while todo:
        for caller in calls[todo.pop()].callers():
            if caller not in found:
                found.add(caller)
                todo.append(caller)
    return found
