from __future__ import annotations

import tracemalloc
from collections.abc import Iterator
from itertools import islice, pairwise

import pytest
from hypothesis import given, settings

from compiler.words.counting import FIRST_HORIZON, words_in_order, words_of_length
from compiler.words.language import Language, language
from grammar_lang import ir
from tests.oracles.brute_force_grammar import satisfies, words_of
from tests.oracles.grammars import (
    ALPHABET,
    ARM_MODULES,
    ARM_TERMINALS,
    EVERY,
    arm,
    grammar,
    random_grammars,
)
from tests.oracles.some_cases import examples

AB = ("a", "b")
BEYOND = 2 * FIRST_HORIZON + 5


def over(text: str, accept: ir.Accept = EVERY) -> Language:
    return language(grammar(text, ALPHABET, accept), ALPHABET, frozenset(ALPHABET))


@settings(deadline=None, max_examples=examples(20, 40))
@given(random_grammars())
def test_words_of_a_length_are_those_of_brute_force(g: ir.Grammar) -> None:
    lang = language(g, AB, frozenset(AB))
    words = sorted(word for word in words_of(g, 6) if satisfies(g.accept, word))
    recogniser = lang.recogniser(6)
    for length in range(7):
        listed = list(map(lang.srg.decode, words_of_length(recogniser, length)))
        assert listed == [word for word in words if len(word) == length]


@pytest.mark.parametrize(
    "text",
    [
        "E -> E b E | c E c | a",
        "S -> S S | a | b | empty",
        "S -> a S a | b S b | c S c | a | b | c | empty",
        "S -> a S | b S | c S | empty",
    ],
)
def test_the_first_words_of_an_infinite_language(text: str) -> None:
    # All words are made one by one: the list would never end.
    words = list(islice(over(text).words(), 300))
    assert len(set(words)) == len(words) == 300
    assert all((len(u), u) < (len(v), v) for u, v in pairwise(words))
    assert len(words[-1]) > len(words[0])


def powers(left: str, middle: str, right: str) -> Iterator[tuple[str, ...]]:
    n = 0
    while True:
        yield ((left,) * n + (middle,) + (right,) * n) if right else (left,) * n + (middle,)
        n += 1


@pytest.mark.parametrize(
    ("text", "parts"),
    [
        ("S -> a S b | c", ("a", "c", "b")),
        ("S -> a S b | T\nT -> c | T | U\nU -> T", ("a", "c", "b")),
        ("S -> a S | c", ("a", "c", "")),
        ("S -> T S | c\nT -> a | T", ("a", "c", "")),
    ],
)
def test_words_longer_than_the_first_horizons(text: str, parts: tuple[str, str, str]) -> None:
    number = 2 * BEYOND
    expected = list(islice(powers(*parts), number))
    assert list(islice(over(text).words(), number)) == expected
    longest = len(expected[BEYOND])
    listed = list(over(text).words(max_length=longest))
    assert listed == [word for word in expected if len(word) <= longest]


@pytest.mark.parametrize("text", ["S -> a S | b S | empty", "S -> a S b | empty"])
def test_the_first_word_may_be_long(text: str) -> None:
    lang = over(text, ir.Count(None, ">=", 4 * FIRST_HORIZON))
    assert len(lang.shortest_word() or ()) == 4 * FIRST_HORIZON
    assert list(lang.words(max_length=4 * FIRST_HORIZON - 1)) == []


def test_horizons_double() -> None:
    asked: list[int] = []
    lang = over("S -> a S | empty")

    def recogniser(horizon: int) -> object:
        asked.append(horizon)
        return lang.recogniser(horizon)

    words = words_in_order(recogniser, 0, None, lambda: None)  # type: ignore[arg-type]
    assert next(words) == ()
    assert asked == [FIRST_HORIZON]
    assert len(next(islice(words, 4 * FIRST_HORIZON, None))) == 4 * FIRST_HORIZON + 1
    assert asked == [FIRST_HORIZON * 2**k for k in range(4)]
    asked.clear()
    some = words_in_order(recogniser, 0, FIRST_HORIZON + 2, lambda: None)  # type: ignore[arg-type]
    assert len(list(some)) == FIRST_HORIZON + 3
    assert asked == [FIRST_HORIZON, FIRST_HORIZON + 2]


@pytest.mark.slow
def test_memory_is_flat() -> None:
    words = language(arm(), ARM_TERMINALS, ARM_MODULES).words()
    tracemalloc.start()
    try:
        # CPython keeps tuples for use again: some thousands of each size, and never more.
        last = next(islice(words, 29_999, None))
        _, before = tracemalloc.get_traced_memory()
        tracemalloc.reset_peak()
        for last in islice(words, 70_000):  # noqa: B007
            pass
        _, peak = tracemalloc.get_traced_memory()
    finally:
        tracemalloc.stop()
    # 3^m - 2^m words have m modules more than the two first ones
    assert len(last) == 2 * (2 + next(m for m in range(20) if total(m) >= 100_000)) - 1
    # A list of the words would take more than 10 MB.
    assert peak < before + 100_000


def total(most: int) -> int:
    return sum(3**m - 2**m for m in range(most + 1))
