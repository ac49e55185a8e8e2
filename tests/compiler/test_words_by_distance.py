"""The order of structures about an existing robot, against a list of all words."""

from __future__ import annotations

from itertools import islice

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.robots.candidate import at_distance, words_by_distance
from compiler.words.language import Language, language
from grammar_lang import ir
from tests.oracles.brute_force_grammar import satisfies, words_of
from tests.oracles.grammars import (
    ALPHABET,
    ARM_MODULES,
    ARM_TERMINALS,
    TRAPS,
    arm,
    grammar,
    random_grammars,
)
from tests.oracles.shaped_grammars import right_linear
from tests.oracles.some_cases import examples
from tests.oracles.word_changes import distance

AB = ("a", "b")
MOST = 5


def expected(
    g: ir.Grammar, symbols: tuple[str, ...], origin: tuple[str, ...]
) -> list[tuple[str, ...]]:
    """All accepted words of at most ``MOST`` symbols, each of which is a module."""
    words = [word for word in words_of(g, MOST) if satisfies(g.accept, word)]

    def key(word: tuple[str, ...]) -> tuple[int, bool, int, list[int]]:
        numbers = [symbols.index(symbol) for symbol in word]
        return distance(origin, word, symbols), word != origin, len(word), numbers

    return sorted(words, key=key)


@settings(deadline=None, max_examples=examples(20, 60))
@given(random_grammars() | right_linear(), st.lists(st.sampled_from(AB), max_size=5).map(tuple))
def test_random_grammars(g: ir.Grammar, origin: tuple[str, ...]) -> None:
    lang = language(g, AB, frozenset(AB))
    assert list(words_by_distance(lang, origin, MOST)) == expected(g, AB, origin)


@pytest.mark.parametrize("name", TRAPS)
def test_shapes_of_grammars(name: str) -> None:
    g = grammar(TRAPS[name], ALPHABET)
    lang = language(g, ALPHABET, frozenset(ALPHABET))
    for origin in sorted(words_of(g, 4))[:5]:
        assert list(words_by_distance(lang, origin, MOST)) == expected(g, ALPHABET, origin)


@pytest.mark.parametrize(
    ("small", "few", "most"),
    [(4, 10**6, 10**6), (12, 10**6, 10**6), (4, 3, 10**6), (10**6, 0, 10**6), (4, 3, 9)],
)
@pytest.mark.parametrize("name", ["left linear", "right linear", "hidden left recursion"])
def test_sorted_or_by_automata(
    name: str, small: int, few: int, most: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    module = "compiler.robots.candidate"
    monkeypatch.setattr(f"{module}.SMALL_AUTOMATON", small)
    monkeypatch.setattr(f"{module}.FEW_WORDS", few)
    monkeypatch.setattr(f"{module}.STATE_LIMIT", most)
    g = grammar(TRAPS[name], ALPHABET)
    lang = language(g, ALPHABET, frozenset(ALPHABET))
    origin = ("a", "b", "c")
    assert list(words_by_distance(lang, origin, MOST)) == expected(g, ALPHABET, origin)


def running_example() -> Language:
    return language(arm(), ARM_TERMINALS, ARM_MODULES)


def arm_of(modules: str) -> tuple[str, ...]:
    return tuple(f"B eps {' eps '.join(modules.split())}".split())


def test_the_running_example() -> None:
    """By hand: what an arm of two links is next to."""
    origin = arm_of("JO L EN")
    first = islice(words_by_distance(running_example(), origin, 12), 6)
    # Without the link; then one module more, wherever it fits.  The accept condition asks for the
    # base, a joint right behind it, and the tool.
    assert [" ".join(word) for word in first] == [
        "B eps JO eps L eps EN",
        "B eps JO eps EN",
        "B eps JO eps JO eps L eps EN",
        "B eps JO eps L eps JO eps EN",
        "B eps JO eps L eps L eps EN",
        "B eps JO eps L eps EN eps JO",
    ]


def test_every_word_once_up_to_the_bound() -> None:
    lang = running_example()
    origin = arm_of("JO L JO L EN")
    found = list(words_by_distance(lang, origin, 8))
    assert len(found) == len(set(found)) == sum(lang.count_words(max_modules=8))
    # An existing robot beyond the bound is no candidate; one that is not accepted neither.
    assert origin not in list(words_by_distance(lang, origin, 5))
    toolless = origin[:-2]
    assert next(words_by_distance(lang, toolless, 8)) != toolless


def test_edges_do_not_count_and_the_robot_itself_comes_first() -> None:
    terminals = ("B", "L", "eps", "[", "]")
    g = grammar("N -> B | N eps L | N [ L ]", terminals)
    lang = language(g, terminals, frozenset({"B", "L"}))
    found = islice(words_by_distance(lang, ("B", "[", "L", "]"), 3), 3)
    assert [" ".join(word) for word in found] == ["B [ L ]", "B eps L", "B"]


def test_the_automaton_of_a_distance() -> None:
    dfa = at_distance(AB, frozenset(AB), ("a", "b", "a"), 2)
    two = {"a", "aabba", "babba", "aba" + "bb", "bab", "aab", "baa", "abb", "bba", "abaab"}
    for word in ("", "b", "ab", "aba", "abab", "bbb", "ababab", *two):
        expected = distance(("a", "b", "a"), tuple(word), AB) == 2
        assert dfa.accepts(word) == expected, word
