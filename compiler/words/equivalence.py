"""Whether two families have the same words, and the first word that only one of them has."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from typing import TypeAlias, TypeVar

from compiler.words.budget import MOVE_BUDGET, BudgetExceededError
from compiler.words.language import Language
from compiler.words.recogniser import Recogniser

# --- The first word, in length-lexicographic order, that exactly one of two languages has ---------
#
# Both are read in parallel.  For two finite automata there are finitely many pairs of states, and
# the answer is exact for all lengths (Moore 1956).  Equivalence of context-free languages is
# undecidable, so they are compared up to a length.


REASON = "too many prefixes differ in what may follow them; compare shorter words"

Left = TypeVar("Left")
Right = TypeVar("Right")
Pair: TypeAlias = "tuple[Left | None, Right | None]"


def first_difference(
    left: Recogniser[Left], right: Recogniser[Right], longest: int, budget: int | None = MOVE_BUDGET
) -> tuple[int, ...] | None:
    """The first word of at most ``longest`` symbols that exactly one of both has; None if none has.

    Terminals have the same numbers in both.  Words are examined by length; a pair of states that
    was reached before cannot lead to anything new.

    Raises:
        BudgetExceededError: more than ``budget`` moves are needed; None means no bound.
    """
    start: Pair[Left, Right] = (left.root, right.root)
    before: dict[Pair[Left, Right], tuple[Pair[Left, Right], int] | None] = {start: None}
    level = [start]
    moves = 0
    for rest in range(longest, -1, -1):
        following: list[Pair[Left, Right]] = []
        for pair in level:
            if _differs(left, right, pair):
                return _word(before, pair)
        if not rest:
            break
        mask = (1 << rest) - 1
        for pair in level:
            for symbol, target in _moves(left, right, pair):
                moves += 1
                if budget is not None and moves > budget:
                    raise BudgetExceededError("comparing the languages", budget, REASON)
                if target not in before and _alive(left, right, target, mask):
                    before[target] = (pair, symbol)
                    following.append(target)
        level = following
    return None


def _differs(left: Recogniser[Left], right: Recogniser[Right], pair: Pair[Left, Right]) -> bool:
    p, q = pair
    return (p is not None and left.accepting(p)) != (q is not None and right.accepting(q))


def _moves(
    left: Recogniser[Left], right: Recogniser[Right], pair: Pair[Left, Right]
) -> Iterator[tuple[int, Pair[Left, Right]]]:
    p, q = pair
    first = {} if p is None else dict(left.moves(p))
    second = {} if q is None else dict(right.moves(q))
    for symbol in sorted({*first, *second}):
        yield symbol, (first.get(symbol), second.get(symbol))


def _alive(
    left: Recogniser[Left], right: Recogniser[Right], pair: Pair[Left, Right], mask: int
) -> bool:
    """Whether one of both has a word that is short enough."""
    p, q = pair
    first = 0 if p is None else left.lengths(p)
    second = 0 if q is None else right.lengths(q)
    return bool((first | second) & mask)


def _word(
    before: dict[Pair[Left, Right], tuple[Pair[Left, Right], int] | None],
    pair: Pair[Left, Right],
) -> tuple[int, ...]:
    word: list[int] = []
    step = before[pair]
    while step is not None:
        pair, symbol = step
        word.append(symbol)
        step = before[pair]
    return tuple(reversed(word))


# --------------------------------------------------------------------------------------------------
# Compare the words of two families, up to a length or, if both are regular, without a bound.


@dataclass(frozen=True, slots=True)
class Comparison:
    """The result of a comparison.

    ``word`` is the first word that exactly one language has (the first language if ``in_first``).
    ``longest`` is the greatest length compared; None if all words were.
    """

    word: tuple[str, ...] | None
    in_first: bool
    longest: int | None


def compare(
    first: Language, second: Language, longest: int, budget: int = MOVE_BUDGET
) -> Comparison:
    """Compare the words of at most ``longest`` symbols, or all words if both languages are regular.

    If two minimal automata of m and n states differ, they do so on a word of less than m + n
    symbols (Moore 1956).

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
    found = first_difference(first.recogniser(horizon), second.recogniser(horizon), horizon, most)
    word = None if found is None else first.srg.decode(found)
    return Comparison(word, word is not None and first.accepts(word), covered)
