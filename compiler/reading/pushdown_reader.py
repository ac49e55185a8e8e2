"""Membership by the deterministic pushdown automaton of an LR(1) grammar, made as it is needed.

The stack of an LR parser is kept in *pieces* of bounded height.  What a symbol does to the topmost
piece, all reductions and the shift together, is worked out once per piece and symbol; then reading
is one look-up per symbol, as with a finite automaton, and the list below grows only where the
language nests.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import Any, Final

from compiler.automata.lr_automaton import LrAutomaton

HIGHEST = 8
"""No piece is higher than this when it becomes the topmost one."""
KEPT = 3
"""A piece that got too high keeps so many states; the others go below."""
CACHE_LIMIT = 50_000
"""So many pieces are remembered; results never depend on it."""

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
    """The top of a stack: states, the topmost one last.

    By symbol: the next topmost piece, a ``_Push``, or ``DEEPER``.  By ``END``: ``ACCEPTED`` or
    ``DEEPER``.  ``KeyError`` where no word goes on like that.
    """

    __slots__ = ("joined", "owner", "states")

    def __init__(self, owner: PushdownReader, states: tuple[int, ...]) -> None:
        self.owner = owner
        self.states = states
        self.joined: dict[tuple[int, ...], _Piece] = {}

    def __missing__(self, symbol: object) -> object:
        found = self[symbol] = self.owner.move(self.states, symbol)
        return found

    def under(self, top: _Piece) -> _Piece:
        """This piece and the one on top of it as one."""
        known = self.joined.get(top.states)
        if known is None:
            known = self.joined[top.states] = self.owner.piece(self.states + top.states)
        return known


class PushdownReader:
    """The words of an LR(1) grammar over terminals with these names."""

    def __init__(self, automaton: LrAutomaton, names: Sequence[str]) -> None:
        self._automaton = automaton
        self._number: dict[object, int] = {name: i for i, name in enumerate(names)}
        self._number[END] = automaton.end
        self._pieces: dict[tuple[int, ...], _Piece] = {}
        self.initial = self.piece((0,))

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

    def piece(self, states: tuple[int, ...]) -> _Piece:
        """The piece with these states."""
        known = self._pieces.get(states)
        if known is None:
            if len(self._pieces) >= CACHE_LIMIT:
                self._pieces.clear()
                self.initial = self.piece((0,))
            known = self._pieces[states] = _Piece(self, states)
        return known

    def move(self, states: tuple[int, ...], symbol: object) -> object:
        """What a symbol does to the piece with these states.

        Raises:
            KeyError: it may not come next.
        """
        lookahead = self._number[symbol]
        stack = list(states)
        automaton = self._automaton
        while True:
            action = automaton.actions[stack[-1]][lookahead]
            if action >= 0:
                stack.append(action)
                return self._cut(stack)
            if action == automaton.accept_action:
                return ACCEPTED
            left, right = automaton.rules[~action]
            if len(right) >= len(stack):
                return DEEPER
            del stack[len(stack) - len(right) :]
            stack.append(automaton.gotos[stack[-1]][left])

    def _cut(self, stack: list[int]) -> object:
        if len(stack) <= HIGHEST:
            return self.piece(tuple(stack))
        return _Push(self.piece(tuple(stack[:-KEPT])), self.piece(tuple(stack[-KEPT:])))
