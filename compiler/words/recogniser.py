"""Reading words from left to right, one state per prefix, with what may still follow.

Two kinds of automata do so: a finite one, and the residuals of a grammar, which are made when they
are first needed.  Enumeration, counting, sampling and comparison know this interface only.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, TypeVar

from compiler.words.binary_normal_form import BinaryGrammar
from compiler.words.finite_automaton import Dfa
from compiler.words.residuals import Residual, Residuals

State = TypeVar("State")


class Recogniser(Protocol[State]):
    """A deterministic automaton over terminals by number.

    ``horizon``: lengths are exact up to so many symbols.
    """

    @property
    def horizon(self) -> int:
        """The greatest length that is known of."""

    @property
    def root(self) -> State:
        """The state before the first symbol."""

    def moves(self, state: State, /) -> Sequence[tuple[int, State]]:
        """The terminals that may come next, in order, with the states that they lead to."""

    def accepting(self, state: State, /) -> bool:
        """Whether the word may end here."""

    def lengths(self, state: State, /) -> int:
        """Bit m is set where some word of m symbols may follow, up to the horizon."""


# --- A finite automaton read from left to right ---------------------------------------------------


class FiniteRecogniser:
    """The words of a finite automaton; states are numbers."""

    def __init__(self, dfa: Dfa, horizon: int) -> None:
        self.horizon = horizon
        self.root = 0
        self._marks = dfa.accepting
        width = len(dfa.alphabet)
        live = dfa.live()
        rows = [dfa.table[s * width : (s + 1) * width] for s in range(dfa.size)]
        self._moves = [
            [(symbol, target) for symbol, target in enumerate(row) if live[target]] for row in rows
        ]
        self._lengths = self._all_lengths()

    def moves(self, state: int, /) -> list[tuple[int, int]]:
        """The terminals that may come next, in order, with the states that they lead to."""
        return self._moves[state]

    def accepting(self, state: int, /) -> bool:
        """Whether the word may end here."""
        return self._marks[state]

    def lengths(self, state: int, /) -> int:
        """Bit m is set where some word of m symbols may follow, up to the horizon."""
        return self._lengths[state]

    def _all_lengths(self) -> list[int]:
        """By length: from which states some word of that length is accepted."""
        following = [sorted({target for _, target in row}) for row in self._moves]
        bits = [bytearray(self.horizon // 8 + 1) for _ in following]
        level = list(self._marks)
        for length in range(self.horizon + 1):
            place, bit = length >> 3, 1 << (length & 7)
            for state, reached in enumerate(level):
                if reached:
                    bits[state][place] |= bit
            level = [any(level[target] for target in row) for row in following]
        return [int.from_bytes(row, "little") for row in bits]


# --- The residuals of a grammar beside the states of an automaton: the words of both --------------
#
# Unlike the residuals of the grammar of the intersection, these fall together as those of the
# grammar alone do, so prefixes are counted by few states.  A state may be a dead end, though: the
# lengths that each of both allows are known, not those that both allow together.


Pair = tuple[Residual, int]


class ConditionedRecogniser:
    """A recogniser of the words that a condition accepts too.

    ``lengths`` has all lengths of words that may follow, and maybe more.
    """

    def __init__(self, residuals: Residuals, condition: Dfa) -> None:
        self._residuals = residuals
        self._condition = condition
        self._finite = FiniteRecogniser(condition, residuals.horizon)

    @property
    def horizon(self) -> int:
        """The greatest length that is known of."""
        return self._residuals.horizon

    @property
    def root(self) -> Pair:
        """The state before the first symbol."""
        return self._residuals.root, 0

    def moves(self, pair: Pair, /) -> list[tuple[int, Pair]]:
        """The terminals that may come next, in order, with the states that they lead to."""
        residual, state = pair
        step, lengths = self._condition.step, self._finite.lengths
        found = []
        for symbol, following in self._residuals.moves(residual):
            after = step(state, symbol)
            if lengths(after):
                found.append((symbol, (following, after)))
        return found

    def accepting(self, pair: Pair, /) -> bool:
        """Whether the word may end here."""
        return pair[0].accepting and self._finite.accepting(pair[1])

    def lengths(self, pair: Pair, /) -> int:
        """Bit m is set where some word of m symbols may follow, and maybe where none may."""
        return pair[0].lengths & self._finite.lengths(pair[1])


# --- How far a word is the beginning of a word of a grammar ---------------------------------------


def viable_prefix(grammar: BinaryGrammar, names: Sequence[str], word: Sequence[str]) -> int:
    """The length of the longest prefix of ``word`` with which some word of the grammar begins.

    ``names`` are those of the grammar's terminals.  For an empty language it is 0.
    """
    residual = Residuals(grammar, names).root
    for length, symbol in enumerate(word):
        try:
            residual = residual[symbol]
        except KeyError:
            return length
    return len(word)
