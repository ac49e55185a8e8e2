from __future__ import annotations

from dataclasses import replace

import pytest
from hypothesis import given, settings

from compiler.words.language import language, longest_word, number_of_words
from grammar_lang import ir
from tests.oracles.brute_force_grammar import satisfies, words_of
from tests.oracles.grammars import ALPHABET, grammar, random_grammars
from tests.oracles.some_cases import examples

BOUND = 5


def size(
    text: str, accept: ir.Accept, *, unambiguous: bool = False
) -> tuple[int | None, int | None]:
    lang = language(grammar(text, ALPHABET, accept), ALPHABET, ALPHABET)
    longest = longest_word(lang)
    return (
        None if longest is None else number_of_words(lang, longest, unambiguous=unambiguous),
        longest,
    )


@settings(max_examples=examples(40, 80), deadline=None)
@given(random_grammars())
def test_it_agrees_with_brute_force(g: ir.Grammar) -> None:
    short = replace(g, accept=ir.AllOf((g.accept, ir.Count(None, "<=", BOUND))))
    lang = language(short, ("a", "b"), "ab")
    if not lang.product.starts:
        return
    longest = longest_word(lang)
    assert longest is not None
    words = {w for w in words_of(g, BOUND) if w and satisfies(g.accept, w)}
    assert max(map(len, words)) == longest
    assert number_of_words(lang, longest, unambiguous=False) == len(words)
    assert (number_of_words(lang, longest, unambiguous=True) or 0) >= len(words)


@pytest.mark.parametrize("unambiguous", [True, False])
def test_counts_of_an_unambiguous_grammar(*, unambiguous: bool) -> None:
    every = "S -> a S | b S | c S | empty"
    for n in (1, 2, 5):
        expected = sum(3**k for k in range(1, n + 1))
        assert size(every, ir.Count(None, "<=", n), unambiguous=unambiguous) == (expected, n)


def test_infinite() -> None:
    assert size("S -> a S | b", ir.AllOf(())) == (None, None)
    assert size("S -> a S | b", ir.Count("b", "==", 1)) == (None, None)


@pytest.mark.slow
def test_a_large_number_is_counted_exactly_or_not_at_all() -> None:
    bound = ir.Count(None, "<=", 200)
    for every in ("S -> a S | b S | c S | empty", "S -> S a | S b | S c | empty"):
        for unambiguous in (True, False):
            found = size(every, bound, unambiguous=unambiguous)
            assert found == ((3**201 - 3) // 2, 200)
    # Neither regular nor LR(1): one state for every prefix.
    palindromes = "S -> a S a | b S b | c S c | a | b | c | empty"
    assert size(palindromes, bound) == (None, 200)
    short = sum(3 ** ((n + 1) // 2) for n in range(1, 6))
    assert size(palindromes, ir.Count(None, "<=", 5)) == (short, 5)
