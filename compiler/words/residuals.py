"""Read words of a context-free grammar from left to right, deterministically.

A *residual* describes what may follow a prefix: a set of symbols, each with its continuation
(:mod:`compiler.words.continuations`).  Equal sets are one object, and the last symbol of a rule has
the continuation of the whole rule.  So a left- or right-linear grammar has finitely many residuals,
the states of a finite automaton.  Any other grammar is read like an automaton whose states are made
on demand.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from sys import intern
from typing import TypeAlias

from compiler.words.continuations import (
    Continuation,
    Continuations,
    Item,
    WordLengths,
    maximal,
    without_included,
)
from compiler.words.intersection import BinaryGrammar
from compiler.words.left_corners import LeftCorners, Move

CACHE_LIMIT = 50_000
"""The most residuals and continuations that are cached; results never depend on it."""

Name: TypeAlias = str


@dataclass(slots=True)
class _Calls:
    """The calls of a residual: nonterminals with their moves, and continuations of terminals."""

    direct: dict[int, list[Continuation]]
    after: dict[int, list[Continuation]]
    moves: Mapping[int, Move]
    points: dict[int, Continuation] = field(default_factory=dict)


class Residual(dict[Name, "Residual"]):
    """What may follow a prefix; maps each possible next symbol to its residual, made on demand.

    ``residual[name]`` raises ``KeyError`` if that symbol may not come next.

    ``accepting``: the word may end here.  Bit m of ``lengths`` is set if some word of length m may
    follow.
    """

    __slots__ = ("accepting", "agenda", "calls", "following", "lengths", "owner")

    def __init__(self, owner: Residuals, agenda: frozenset[Item], *, accepting: bool) -> None:
        self.owner = owner
        self.agenda = agenda
        self.accepting = accepting
        self.calls: _Calls | None = None
        self.following: tuple[tuple[int, Residual], ...] | None = None
        self.lengths = int(accepting)

    # A dictionary compared by identity: it is a state, whatever its entries.
    __hash__ = object.__hash__  # type: ignore[assignment]

    def __eq__(self, other: object) -> bool:
        return self is other

    def __missing__(self, name: Name) -> Residual:
        number = self.owner.number[name]
        following = self.owner.after(self, number)
        if following is None:
            raise KeyError(name)
        self[self.owner.names[number]] = following
        return following


class Residuals:
    """The residuals of a grammar over named terminals.

    Args:
        grammar: the grammar, in binary form.
        names: the names of its terminals; they are interned, like names in the text of a program.
        horizon: the greatest length for which lengths are exact; None if they are not needed.
    """

    def __init__(
        self, grammar: BinaryGrammar, names: Sequence[Name], horizon: int | None = None
    ) -> None:
        self.grammar = grammar
        self.names = tuple(map(intern, names))
        self.number = {name: i for i, name in enumerate(self.names)}
        self._lengths = None if horizon is None else WordLengths(grammar, horizon)
        self._corners = LeftCorners(grammar)
        self._start_over()

    def _start_over(self) -> None:
        self._known: dict[tuple[bool, frozenset[Item]], Residual] = {}
        self._continuations = Continuations(self._lengths)
        items = frozenset((s, self._continuations.end) for s in self.grammar.starts)
        self.root = self.of(items, accepting=self.grammar.empty_word)

    @property
    def horizon(self) -> int:
        """The greatest length for which lengths are exact."""
        return 0 if self._lengths is None else self._lengths.horizon

    def accepting(self, residual: Residual, /) -> bool:
        """Whether the word may end here."""
        return residual.accepting

    def lengths(self, residual: Residual, /) -> int:
        """Bit m is set if some word of m symbols may follow, up to the horizon."""
        return residual.lengths

    def moves(self, residual: Residual, /) -> Sequence[tuple[int, Residual]]:
        """The terminals that may come next, in order, with their residuals."""
        if residual.following is None:
            calls = self._calls(residual)
            symbols = sorted({*calls.after, *calls.moves})
            residual.following = tuple((s, residual[self.names[s]]) for s in symbols)
        return residual.following

    def after(self, residual: Residual, symbol: int) -> Residual | None:
        """The residual after one more terminal, by number; None if it may not come next."""
        calls = self._calls(residual)
        move = calls.moves.get(symbol)
        ends = calls.after.get(symbol, ())
        if move is None and not ends:
            return None
        last = list(ends)
        items: set[Item] = set()
        if move is not None:
            points = calls.points
            for group in move.groups:
                if group.members[0] not in points:
                    self._continuations.add(group, calls.direct, points)
            items.update((frame.symbol, points[frame.caller]) for frame in move.frames)
            last += [points[symbol] for symbol in move.ends]
        items.update(*(point.items for point in maximal(last)))
        final = any(point.final for point in last)
        return self.of(without_included(items), accepting=final)

    def of(self, items: frozenset[Item], *, accepting: bool) -> Residual:
        """The residual with these items."""
        known = self._known.get((accepting, items))
        if known is not None:
            return known
        if len(self._known) + len(self._continuations) >= CACHE_LIMIT:
            self._start_over()
        result = self._known[accepting, items] = Residual(self, items, accepting=accepting)
        if self._lengths is not None:
            for symbol, target in items:
                result.lengths |= self._lengths.before(symbol, target.lengths)
        return result

    def before(self, residual: Residual, following: Continuation) -> Residual:
        """The residual of what may follow if ``following`` comes after each end of a residual."""
        items = self._continuations.plugged(residual.agenda, following)
        if not residual.accepting:
            return self.of(items, accepting=False)
        return self.of(without_included(items | following.items), accepting=following.final)

    @property
    def end(self) -> Continuation:
        """The end of the word."""
        return self._continuations.end

    def _calls(self, residual: Residual) -> _Calls:
        if residual.calls is None:
            first = self.grammar.terminals
            direct: dict[int, list[Continuation]] = {}
            after: dict[int, list[Continuation]] = {}
            for symbol, target in residual.agenda:
                (after if symbol < first else direct).setdefault(symbol, []).append(target)
            residual.calls = _Calls(direct, after, self._corners.moves(frozenset(direct)))
        return residual.calls
