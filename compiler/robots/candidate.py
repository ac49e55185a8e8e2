"""The structures of a family as robots, in the order in which they are tried or refuted."""

from __future__ import annotations

from collections.abc import Container, Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import islice
from typing import TypeAlias

from compiler.robots.alignment import alignment
from compiler.robots.attributes import SemanticsError
from compiler.robots.normal_form import RobotFamily
from compiler.robots.robot import RobotModel
from compiler.time_limits.time_limit import check_time
from compiler.words.budget import WordsTooLongError
from compiler.words.derivation import Derivation
from compiler.words.finite_automaton import (
    STATE_LIMIT,
    AutomatonTooLargeError,
    Dfa,
    intersection,
    minimal,
)
from compiler.words.language import Language, restrict
from compiler.words.structures import structures, structures_of
from grammar_lang import ir


@dataclass(frozen=True, slots=True)
class Candidate:
    """A structure, ``number`` in order from 0, and its robot; None if there is a ``fault``."""

    number: int
    derivation: Derivation
    model: RobotModel | None
    fault: str = ""


def candidates(family: RobotFamily, modules: int, origin: ir.Origin | None) -> Iterator[Candidate]:
    """All structures of at most ``modules`` modules, lazily, in the order of section 2.

    If there is an existing robot (``origin``, Example 2), they are ordered by the number of modules
    added to it or removed from it, its own word first, and then as in section 2.

    Raises:
        InfiniteAmbiguityError: at once, if the grammar has a useful derivation A =>+ A.
    """
    language = family.language
    if origin is None:
        return _robots(family, structures(language, modules), None)
    nearest = words_by_distance(language, origin.word, modules)
    return candidates_of(family, nearest, origin)


def candidates_of(
    family: RobotFamily, words: Iterable[tuple[str, ...]], origin: ir.Origin | None
) -> Iterator[Candidate]:
    """All structures of the given words of a family, in the order of the words."""
    return _robots(family, structures_of(family.language, words), origin)


def _robots(
    family: RobotFamily, derivations: Iterator[Derivation], origin: ir.Origin | None
) -> Iterator[Candidate]:
    for number, derivation in enumerate(derivations):
        check_time()
        try:
            yield Candidate(number, derivation, robot_in_task(family, origin, derivation))
        except SemanticsError as error:
            yield Candidate(number, derivation, None, str(error))


# --------------------------------------------------------------------------------------------------
# The robot of a structure in a task: the fixed parameters of kept modules have one value.


def robot_in_task(
    family: RobotFamily, origin: ir.Origin | None, derivation: Derivation
) -> RobotModel:
    """The robot of a derivation; each fixed parameter of a kept module has only its one value.

    Args:
        family: the family of the task.
        origin: the existing robot of the task, None without one.
        derivation: the structure.

    Raises:
        SemanticsError: the derivation defines no robot.
    """
    model = family.robot(derivation)
    if origin is None or not origin.fixed:
        return model
    kept = dict(alignment(origin.word, derivation.word, family.language.srg.modules).kept)
    values = {(kept[f.symbol], f.name): f.value for f in origin.fixed if f.symbol in kept}
    parameters = (
        replace(p, domain=ir.Choices((values[p.symbol, p.name],)))
        if (p.symbol, p.name) in values
        else p
        for p in model.parameters
    )
    return replace(model, parameters=tuple(parameters))


# --------------------------------------------------------------------------------------------------
# The words of a language in the order of their distance from a word: modules added or removed.
#
# Each distance is the language intersected with an automaton, enumerated lazily. Automata grow with
# the distance; once they are large and few words remain, the remaining words are sorted instead.


SMALL_AUTOMATON = 500
FEW_WORDS = 20_000


def words_by_distance(
    language: Language, origin: tuple[str, ...], modules: int
) -> Iterator[tuple[str, ...]]:
    """The words of at most ``modules`` modules, by how many are added to ``origin`` or removed.

    ``origin`` itself comes first; words at one distance are ordered by length, then by symbols.
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
    """A length that no word exceeds; None if there is no bound, or none of use."""
    try:
        return language.longest(max_modules=modules)
    except WordsTooLongError:
        return None


def _at(language: Language, origin: tuple[str, ...], distance: int, limit: int) -> Language | None:
    """The words of a language at a distance; None if that takes more than ``limit`` states."""
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
    """The given words that are at a distance of at least ``least``, sorted by distance."""
    levels: dict[int, list[tuple[str, ...]]] = {}
    for word in words:
        distance = _distance(language, origin, word)
        if distance >= least and word != origin:
            levels.setdefault(distance, []).append(word)
    for distance in sorted(levels):
        yield from levels[distance]


# --------------------------------------------------------------------------------------------------
# The words at a given number of modules added to or removed from a word, as a finite automaton.
#
# A state is a row of the table of distances between the prefix read so far and all prefixes of the
# word (Wagner & Fischer 1974, with deletions and insertions only), cut off above the given distance
# (Schulz & Mihov 2002). Edges are read but not counted.


Row: TypeAlias = tuple[int, ...]


def at_distance(
    alphabet: tuple[str, ...],
    modules: Container[str],
    word: Sequence[str],
    distance: int,
    limit: int = STATE_LIMIT,
) -> Dfa:
    """The words that differ from ``word`` by ``distance`` modules, added or removed; minimal.

    Raises:
        AutomatonTooLargeError: the automaton would have more than ``limit`` states.
    """
    aim = [symbol for symbol in word if symbol in modules]
    over = distance + 1
    first = tuple(min(i, over) for i in range(len(aim) + 1))
    rows, number = [first], {first: 0}
    table: list[int] = []
    for row in rows:
        check_time()
        for symbol in alphabet:
            following = _next(row, symbol, aim, over) if symbol in modules else row
            if following not in number:
                if len(rows) >= limit:
                    raise AutomatonTooLargeError(limit)
                number[following] = len(rows)
                rows.append(following)
            table.append(number[following])
    return minimal(Dfa(alphabet, tuple(table), tuple(row[-1] == distance for row in rows)))


def distance_from(modules: Container[str], word: Sequence[str], other: Sequence[str]) -> int:
    """The number of modules to add to one word or remove from it to get the modules of another."""
    aim = [symbol for symbol in word if symbol in modules]
    over = len(aim) + len(other) + 1
    row = tuple(range(len(aim) + 1))
    for symbol in other:
        if symbol in modules:
            row = _next(row, symbol, aim, over)
    return row[-1]


def _next(row: Row, symbol: str, aim: Sequence[str], over: int) -> Row:
    """The row after one more module; ``over`` stands for all larger distances."""
    entries = [min(row[0] + 1, over)]
    for i, other in enumerate(aim, 1):
        found = row[i - 1] if symbol == other else min(row[i], entries[-1]) + 1
        entries.append(min(found, over))
    return tuple(entries)
