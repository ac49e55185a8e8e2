"""The words of a language in the order of their distance from a word: modules added or removed.

Each distance is the language intersected with an automaton, enumerated lazily.  Automata grow with
the distance; where they get large and the words are few, the rest of the words is sorted instead.
"""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

from compiler.automata.finite_automaton import STATE_LIMIT, AutomatonTooLargeError, intersection
from compiler.candidates.distance_levels import at_distance, distance_from
from compiler.languages.budget import WordsTooLongError
from compiler.languages.language import Language, restrict

SMALL_AUTOMATON = 500
FEW_WORDS = 20_000


def words_by_distance(
    language: Language, origin: tuple[str, ...], modules: int
) -> Iterator[tuple[str, ...]]:
    """The words of at most so many modules, by how many are added to or removed from ``origin``.

    ``origin`` itself comes first; words at one distance come by length, then in order of symbols.
    """
    count = sum(symbol in language.srg.modules for symbol in origin)
    if count <= modules and language.accepts(origin):
        yield origin
    longest, limit = _longest(language, modules), SMALL_AUTOMATON
    for distance in range(count + modules + 1):
        found = _at(language, origin, distance, limit)
        if found is None and limit < STATE_LIMIT:
            few = list(islice(language.words(max_modules=modules), FEW_WORDS + 1))
            if len(few) <= FEW_WORDS:
                yield from _sorted(language, few, origin, distance)
                return
            limit = STATE_LIMIT
            found = _at(language, origin, distance, limit)
        level = language if found is None else found
        for word in level.words(max_modules=modules, max_length=longest):
            near = found is not None or _distance(language, origin, word) == distance
            if near and word != origin:
                yield word


def _longest(language: Language, modules: int) -> int | None:
    """A length that no word exceeds; None where there is none, or none of use."""
    try:
        return language.longest(max_modules=modules)
    except WordsTooLongError:
        return None


def _at(language: Language, origin: tuple[str, ...], distance: int, limit: int) -> Language | None:
    """The words of a language at a distance; None where that takes more than ``limit`` states."""
    rules = language.srg
    try:
        level = at_distance(rules.terminals, rules.modules, origin, distance, limit)
        return restrict(rules, intersection(language.accept, level))
    except AutomatonTooLargeError:
        return None


def _distance(language: Language, origin: tuple[str, ...], word: tuple[str, ...]) -> int:
    return distance_from(language.srg.modules, origin, word)


def _sorted(
    language: Language, words: list[tuple[str, ...]], origin: tuple[str, ...], least: int
) -> Iterator[tuple[str, ...]]:
    """Those of some words, in order, that are at a distance of ``least`` or more, by distance."""
    levels: dict[int, list[tuple[str, ...]]] = {}
    for word in words:
        distance = _distance(language, origin, word)
        if distance >= least and word != origin:
            levels.setdefault(distance, []).append(word)
    for distance in sorted(levels):
        yield from levels[distance]
