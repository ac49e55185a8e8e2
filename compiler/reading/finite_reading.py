"""A finite automaton read from left to right: see :mod:`compiler.reading.reading`."""

from __future__ import annotations

from compiler.automata.finite_automaton import Dfa


class FiniteReading:
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
