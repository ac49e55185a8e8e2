"""Membership by the deterministic pushdown automaton of an LR(1) grammar, made as it is needed.

The stack of an LR parser is kept without the states that no reduction can go back to, those inside
a right side that has been read in part, so it is as high as the language nests.  It is cut into
*pieces* of bounded height.  What a symbol does to the topmost piece, all reductions and the shift
together, is worked out once per piece and symbol; then reading is one look-up per symbol, as with a
finite automaton.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Final, TypeAlias

from compiler.automata.lr_automaton import LrAutomaton

HIGHEST = 4
"""No piece has more entries than this when it becomes the topmost one."""
KEPT = 2
"""A piece that got too high keeps so many entries; the others go below."""
CACHE_LIMIT = 50_000
"""So many pieces are remembered; results never depend on it."""

Entries: TypeAlias = tuple[tuple[int, int], ...]

END: Final = object()
ACCEPTED: Final = object()
DEEPER: Final = object()
"""A reduction reaches below the piece."""


@dataclass(frozen=True, slots=True)
class _Push:
    """The piece is cut in two."""

    below: _Piece
    top: _Piece


class _Piece(dict[Any, Any]):
    """The top of a stack, the topmost entry last: states, each with how many it stands for.

    By symbol: the next topmost piece, a ``_Push``, or ``DEEPER``.  By ``END``: ``ACCEPTED`` or
    ``DEEPER``.  ``KeyError`` where no word goes on like that.
    """

    __slots__ = ("entries", "joined", "owner")

    def __init__(self, owner: PushdownReader, entries: Entries) -> None:
        self.owner = owner
        self.entries = entries
        self.joined: dict[Entries, _Piece] = {}

    def __missing__(self, symbol: object) -> object:
        found = self[symbol] = self.owner.move(self.entries, symbol)
        return found

    def under(self, top: _Piece) -> _Piece:
        """This piece and the one on top of it as one."""
        known = self.joined.get(top.entries)
        if known is None:
            known = self.joined[top.entries] = self.owner.piece(self.entries + top.entries)
        return known


class PushdownReader:
    """The words of an LR(1) grammar over terminals with these names."""

    def __init__(self, automaton: LrAutomaton, names: Sequence[str]) -> None:
        self._automaton = automaton
        self._number: dict[object, int] = {name: i for i, name in enumerate(names)}
        self._number[END] = automaton.end
        self._pieces: dict[Entries, _Piece] = {}
        self.initial = self.piece(((0, 1),))

    def accepts(self, word: Iterable[str]) -> bool:
        """Whether the word is in the language; a word with an unknown token is not."""
        below: list[_Piece] = []
        piece = self.initial
        try:
            for symbol in word:
                found = piece[symbol]
                while type(found) is not _Piece:
                    if found is DEEPER:
                        piece = below.pop().under(piece)
                        found = piece[symbol]
                    else:
                        below.append(found.below)
                        found = found.top
                piece = found
            while piece[END] is DEEPER:
                piece = below.pop().under(piece)
        except KeyError:
            return False
        return True

    def piece(self, entries: Entries) -> _Piece:
        """The piece with these entries."""
        known = self._pieces.get(entries)
        if known is None:
            if len(self._pieces) >= CACHE_LIMIT:
                self._pieces.clear()
                self.initial = self.piece(((0, 1),))
            known = self._pieces[entries] = _Piece(self, entries)
        return known

    def move(self, entries: Entries, symbol: object) -> object:
        """What a symbol does to the piece with these entries.

        Raises:
            KeyError: it may not come next.
        """
        lookahead = self._number[symbol]
        stack = list(entries)
        automaton = self._automaton
        while True:
            action = automaton.actions[stack[-1][0]][lookahead]
            if action >= 0:
                self._enter(action, stack)
                return self._cut(stack)
            if action == automaton.accept_action:
                return ACCEPTED
            left, right = automaton.rules[~action]
            rest = len(right)
            while rest and stack:
                rest -= stack.pop()[1]
            if not stack:
                return DEEPER
            self._enter(automaton.gotos[stack[-1][0]][left], stack)

    def _enter(self, state: int, stack: list[tuple[int, int]]) -> None:
        """Push a state; the one below is kept where a rule begins after it."""
        if self._automaton.opens[state]:
            stack.append((state, 1))
        else:
            stack[-1] = (state, stack[-1][1] + 1)

    def _cut(self, stack: list[tuple[int, int]]) -> object:
        if len(stack) <= HIGHEST:
            return self.piece(tuple(stack))
        return _Push(self.piece(tuple(stack[:-KEPT])), self.piece(tuple(stack[-KEPT:])))
