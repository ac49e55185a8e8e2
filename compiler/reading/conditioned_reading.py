"""The residuals of a grammar beside the states of an automaton: the words of both.

Unlike the residuals of the grammar of the intersection, these fall together as those of the grammar
alone do, so prefixes are counted by few states.  A state may be a dead end, though: the lengths
that each of both allows are known, not those that both allow together.
"""

from __future__ import annotations

from compiler.automata.finite_automaton import Dfa
from compiler.reading.finite_reading import FiniteReading
from compiler.reading.residuals import Residual, Residuals

Pair = tuple[Residual, int]


class ConditionedReading:
    """A reading (see :mod:`compiler.reading.reading`) of words that a condition accepts too.

    ``lengths`` has all lengths of words that may follow, and maybe more.
    """

    def __init__(self, residuals: Residuals, condition: Dfa) -> None:
        self._residuals = residuals
        self._condition = condition
        self._finite = FiniteReading(condition, residuals.horizon)

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
