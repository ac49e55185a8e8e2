"""Draw words of one length uniformly: every word is equally likely, whatever its derivations.

A random number below the number of words is drawn, and the word with that number is the sample.
Words of a regular or LR(1) grammar are numbered in polynomial time; those of any other grammar are
numbered by the states that prefixes lead to, up to a budget.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from random import Random

from compiler.words.budget import (
    LENGTH_LIMIT,
    MOVE_BUDGET,
    BudgetExceededError,
    WordsTooLongError,
)
from compiler.words.counting import DerivationCounts, WordsOfLength
from compiler.words.language import QUICK_MOVES, Language


class WordSampler:
    """The ``number`` words of one length of a language.

    Raises:
        ValueError: the length is negative.
        BudgetExceededError: the language is neither evidently regular nor LR(1), and numbering its
            words needs more than ``budget`` moves.
    """

    def __init__(self, language: Language, length: int, budget: int = MOVE_BUDGET) -> None:
        if length < 0:
            raise ValueError(f"there are no words of {length} symbols")
        if length > LENGTH_LIMIT:
            raise WordsTooLongError
        self._language = language
        self._length = length
        words = _numbered(language, length, budget)
        self.number: int
        self._numbered: Callable[[int], tuple[int, ...]]
        if words is None:
            derivations = DerivationCounts(language.product, length)
            self.number = derivations.total(length)
            self._numbered = partial(derivations.word, length)
        else:
            self.number = words.number
            self._numbered = words.word

    def word(self, index: int) -> tuple[str, ...]:
        """The word with that number, from 0, in an order that depends on the grammar alone.

        Raises:
            IndexError: there are fewer words.
        """
        if not 0 <= index < self.number:
            raise IndexError(f"there are {self.number} words of length {self._length}")
        return self._language.srg.decode(self._numbered(index))

    def draw(self, random: Random) -> tuple[str, ...]:
        """A random word; all words have the same probability.

        Raises:
            IndexError: there is no word of that length.
        """
        if not self.number:
            raise IndexError(f"there is no word of length {self._length}")
        return self.word(random.randrange(self.number))


def _numbered(language: Language, length: int, budget: int) -> WordsOfLength | None:
    """The words numbered by prefixes; None if derivations of an LR(1) grammar should be used."""
    recogniser = language.recogniser(length)
    if language.finite_automaton is not None:
        return WordsOfLength(recogniser, length, None)
    try:
        return WordsOfLength(recogniser, length, min(budget, QUICK_MOVES))
    except BudgetExceededError:
        return None if language.is_lr else WordsOfLength(recogniser, length, budget)
