"""Whether two families have the same words, up to a length or, where both are regular, at all."""

from __future__ import annotations

from dataclasses import dataclass

from compiler.languages.budget import MOVE_BUDGET
from compiler.languages.difference import first_difference
from compiler.languages.language import Language


@dataclass(frozen=True, slots=True)
class Comparison:
    """``word``: the first one that exactly one of both has, the first one where ``in_first``.

    ``longest``: words of more symbols were not compared; None: all were.
    """

    word: tuple[str, ...] | None
    in_first: bool
    longest: int | None


def compare(
    first: Language, second: Language, longest: int, budget: int = MOVE_BUDGET
) -> Comparison:
    """Compare the words of at most ``longest`` symbols, or all where both languages are regular.

    Two minimal automata of m and n states that differ do so on a word of less than m + n symbols
    (Moore 1956).

    Raises:
        ValueError: the languages have different terminals.
        BudgetExceededError: more than ``budget`` moves are needed.
    """
    if first.srg.terminals != second.srg.terminals:
        raise ValueError("languages over different symbols")
    covered: int | None = longest
    horizon = longest
    most: int | None = budget
    if first.finite_automaton is not None and second.finite_automaton is not None:
        covered = None
        horizon = first.finite_automaton.size + second.finite_automaton.size
        most = None
    elif first.is_finite() and second.is_finite():
        all_words = max(first.longest() or 0, second.longest() or 0)
        if all_words <= longest:
            covered, horizon = None, all_words
    found = first_difference(first.reading(horizon), second.reading(horizon), horizon, most)
    word = None if found is None else first.srg.decode(found)
    return Comparison(word, word is not None and first.accepts(word), covered)
