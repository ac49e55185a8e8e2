"""Brute force for changes of words: all that could be kept, all that could be on the way.

Nothing here uses the algorithms of the compiler: no tables, no automata.
"""

from __future__ import annotations

from collections.abc import Callable, Container, Iterator
from itertools import combinations, permutations

Word = tuple[str, ...]
Slots = tuple[tuple[str, int], ...]
"""Modules with the word that they come from: ``("old", index)`` or ``("new", index)``."""


def cheapest(old: Word, new: Word, modules: Container[str]) -> tuple[int, int]:
    """The least number of modules, then of edges, that are not in a common subsequence."""
    return min(_cost(old, new, common, modules) for common in _common(old, new))


def _common(old: Word, new: Word) -> Iterator[Word]:
    for size in range(min(len(old), len(new)) + 1):
        yield from _parts(old, size) & _parts(new, size)


def _parts(word: Word, size: int) -> set[Word]:
    return set(combinations(word, size))


def _cost(old: Word, new: Word, common: Word, modules: Container[str]) -> tuple[int, int]:
    def number(word: Word) -> int:
        return sum(symbol in modules for symbol in word)

    apart = number(old) + number(new) - 2 * number(common)
    return apart, len(old) + len(new) - 2 * len(common) - apart


def distance(old: Word, new: Word, modules: Container[str]) -> int:
    """The least number of modules that are added or removed."""

    def bare(word: Word) -> Word:
        return tuple(symbol for symbol in word if symbol in modules)

    return cheapest(bare(old), bare(new), modules)[0]


def arrangements(
    kept: list[tuple[int, int]], removed: tuple[int, ...], added: tuple[int, ...]
) -> Iterator[Slots]:
    """All ways to arrange what is kept with some of the rest, in the order of either word."""
    fixed = [("old", i) for i, _ in kept]
    places = {("old", i): j for i, j in kept} | {("new", j): j for j in added}
    rest = [("old", i) for i in removed] + [("new", j) for j in added]
    for size in range(len(rest) + 1):
        for some in combinations(rest, size):
            for order in permutations(fixed + list(some)):
                olds = [i for source, i in order if source == "old"]
                news = [places[slot] for slot in order if slot in places]
                if olds == sorted(olds) and news == sorted(news):
                    yield order


def largest_step(
    states: list[Slots], first: Slots, last: Slots, allowed: Callable[[Slots], bool]
) -> int:
    """The least m such that steps of at most m modules lead from the first to the last."""
    good = [state for state in states if state in (first, last) or allowed(state)]
    most = 0
    while True:
        reached, todo = {first}, [first]
        for state in todo:
            for other in good:
                if other not in reached and _is_step(state, other, most):
                    reached.add(other)
                    todo.append(other)
        if last in reached:
            return most
        most += 1


def _is_step(before: Slots, after: Slots, most: int) -> bool:
    """One order of what stays, nothing old comes back, nothing new goes."""
    one, other = set(before), set(after)
    stays = [slot for slot in before if slot in other] == [slot for slot in after if slot in one]
    directed = all(s == "old" for s, _ in one - other) and all(s == "new" for s, _ in other - one)
    return stays and directed and len(one ^ other) <= most
