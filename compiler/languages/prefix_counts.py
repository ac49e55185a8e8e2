"""Words counted by their prefixes, each once however many derivations it has.

The prefixes of one length are put together by the state that reading them leads to.  An automaton
has a bounded number of these; for an ambiguous grammar there may be exponentially many, hence the
budget.
"""

from __future__ import annotations

from compiler.languages.budget import MOVE_BUDGET, BudgetExceededError
from compiler.reading.reading import Reading, State
from compiler.time_limits.time_limit import check_time

QUESTION = "counting the words"
REASON = (
    "they are counted prefix by prefix, for the grammar is not known to be regular or "
    "unambiguous (LR(1))"
)


def count_by_length(
    reading: Reading[State], longest: int, budget: int | None = MOVE_BUDGET
) -> tuple[int, ...]:
    """The number of words of each length from 0 to ``longest``, at most the reading's horizon.

    Raises:
        BudgetExceededError: more than ``budget`` moves are needed; None: there is no bound.
    """
    level = {reading.root: 1} if reading.lengths(reading.root) else {}
    counts: list[int] = []
    moves = 0
    for rest in range(longest, -1, -1):
        counts.append(sum(n for state, n in level.items() if reading.accepting(state)))
        if not rest:
            break
        mask = (1 << rest) - 1
        following: dict[State, int] = {}
        for state, number in level.items():
            check_time()
            for _, target in reading.moves(state):
                moves += 1
                if budget is not None and moves > budget:
                    raise BudgetExceededError(QUESTION, budget, REASON)
                if reading.lengths(target) & mask:
                    following[target] = following.get(target, 0) + number
        level = following
    return tuple(counts)


class WordsOfLength:
    """The words of one length, numbered in lexicographic order: ``number`` of them.

    Raises:
        BudgetExceededError: more than ``budget`` moves are needed; None: there is no bound.
    """

    def __init__(
        self, reading: Reading[State], length: int, budget: int | None = MOVE_BUDGET
    ) -> None:
        self.length = length
        moves = 0
        place = {reading.root: 0} if reading.lengths(reading.root) >> length & 1 else {}
        self._moves: list[list[list[tuple[int, int]]]] = []
        for rest in range(length - 1, -1, -1):
            following: dict[State, int] = {}
            rows: list[list[tuple[int, int]]] = []
            for state in place:
                row: list[tuple[int, int]] = []
                for symbol, target in reading.moves(state):
                    moves += 1
                    if budget is not None and moves > budget:
                        raise BudgetExceededError(QUESTION, budget, REASON)
                    if reading.lengths(target) >> rest & 1:
                        row.append((symbol, following.setdefault(target, len(following))))
                rows.append(row)
            self._moves.append(rows)
            place = following
        self._ways = [[1] * len(place)]
        for rows in reversed(self._moves):
            below = self._ways[-1]
            self._ways.append([sum(below[target] for _, target in row) for row in rows])
        self._ways.reverse()
        self.number = sum(self._ways[0])

    def word(self, index: int) -> tuple[int, ...]:
        """The word with that number, from 0.

        Raises:
            IndexError: there are not so many words.
        """
        if not 0 <= index < self.number:
            raise IndexError(f"there are {self.number} words of length {self.length}")
        word: list[int] = []
        state = 0
        for rows, ways in zip(self._moves, self._ways[1:], strict=True):
            for symbol, target in rows[state]:
                if index < ways[target]:
                    word.append(symbol)
                    state = target
                    break
                index -= ways[target]
        return tuple(word)
