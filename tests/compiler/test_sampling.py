from __future__ import annotations

from collections import Counter
from itertools import pairwise
from random import Random

import pytest
from hypothesis import given, settings
from scipy.stats import chisquare

from compiler.words.budget import BudgetExceededError
from compiler.words.language import Language, language
from compiler.words.sampling import WordSampler
from grammar_lang import ir
from tests.oracles.brute_force_grammar import derivations, satisfies, words_of
from tests.oracles.grammars import ALPHABET, EVERY, TRAPS, grammar, random_grammars
from tests.oracles.some_cases import examples

AB = ("a", "b")
LENGTH = 6
ARITHMETIC = ("id", "+", "*", "(", ")")
SUMS = "E -> E + E | E * E | ( E ) | id"
DRAWS = 6_000
LIKELY, IMPOSSIBLE = 1e-3, 1e-12


def how_counted(lang: Language) -> str:
    """By what the words of a language are counted."""
    if lang.finite_automaton is not None:
        return "finite automaton"
    return "LR(1)" if lang.is_lr else "general"


def over(text: str, terminals: tuple[str, ...] = ALPHABET, accept: ir.Accept = EVERY) -> Language:
    return language(grammar(text, terminals, accept), terminals, frozenset(terminals))


def check_numbering(g: ir.Grammar, terminals: tuple[str, ...]) -> None:
    """Every length: word(0), word(1), ... are the words of that length, each once."""
    lang = language(g, terminals, frozenset(terminals))
    words = [word for word in words_of(g, LENGTH) if satisfies(g.accept, word)]
    for length in range(LENGTH + 1):
        sampler = WordSampler(lang, length)
        numbered = [sampler.word(index) for index in range(sampler.number)]
        assert sorted(numbered) == sorted(word for word in words if len(word) == length)
        for index in (-1, sampler.number):
            with pytest.raises(IndexError):
                sampler.word(index)


@settings(deadline=None, max_examples=examples(20, 40))
@given(random_grammars())
def test_numbers_stand_for_words_one_to_one(g: ir.Grammar) -> None:
    check_numbering(g, AB)


@pytest.mark.parametrize("accept", [EVERY, ir.Contains(("a",)), ir.NotAccept(ir.EndsWith(("b",)))])
@pytest.mark.parametrize("name", TRAPS)
def test_numbers_stand_for_words_in_known_traps(name: str, accept: ir.Accept) -> None:
    check_numbering(grammar(TRAPS[name], ALPHABET, accept), ALPHABET)


@pytest.mark.parametrize(
    ("text", "kind"),
    [
        ("S -> a S | b T\nT -> b T | c S | empty", "finite automaton"),
        ("S -> a S b S | c S | empty", "LR(1)"),
        ("S -> a S b | a S b c | S S | empty", "general"),
    ],
)
def test_long_samples_are_accepted(text: str, kind: str) -> None:
    lang = over(text, accept=ir.Contains(("b", "c")))
    assert how_counted(lang) == kind
    random = Random(1)
    length = 40
    sampler = WordSampler(lang, length)
    drawn = [sampler.draw(random) for _ in range(50)]
    assert len(set(drawn)) > 45
    for word in drawn:
        assert len(word) == length
        assert lang.accepts(word)
        assert any(pair == ("b", "c") for pair in pairwise(word))


def arithmetic_words(length: int) -> list[tuple[str, ...]]:
    words = words_of(grammar(SUMS, ARITHMETIC), length)
    return sorted(word for word in words if len(word) == length)


def uniformity(drawn: list[tuple[str, ...]], words: list[tuple[str, ...]]) -> float:
    """How likely such frequencies are where all words have the same chance."""
    counts = Counter(drawn)
    assert set(counts) <= set(words)
    return float(chisquare([counts[word] for word in words]).pvalue)


def test_words_are_uniform_where_derivations_are_not() -> None:
    words = arithmetic_words(7)
    sampler = WordSampler(over(SUMS, ARITHMETIC), 7)
    random = Random(7)
    assert uniformity([sampler.draw(random) for _ in range(DRAWS)], words) > LIKELY


def test_the_test_of_uniformity_notices_weights_by_derivations() -> None:
    words = arithmetic_words(7)
    weights = [sum(1 for _ in derivations(grammar(SUMS, ARITHMETIC), word)) for word in words]
    assert len(set(weights)) > 1
    drawn = Random(7).choices(words, weights, k=DRAWS)
    assert uniformity(drawn, words) < IMPOSSIBLE


@pytest.mark.parametrize("text", ["S -> a S b S | c S | empty", "S -> a S | b T | c\nT -> a | c S"])
def test_unambiguous_grammars_are_sampled_uniformly(text: str) -> None:
    length = 6
    words = sorted(w for w in words_of(grammar(text, ALPHABET), length) if len(w) == length)
    assert len(words) > 10
    random = Random(3)
    sampler = WordSampler(over(text), length)
    assert uniformity([sampler.draw(random) for _ in range(DRAWS)], words) > LIKELY


@pytest.mark.parametrize("text", ["S -> a S | b S | c", "S -> a S b S | c", "S -> S S | a | b"])
def test_a_seed_and_a_grammar_fix_the_sample(text: str) -> None:
    def drawn(seed: int) -> list[tuple[str, ...]]:
        sampler = WordSampler(over(text), 13)
        random = Random(seed)
        return [sampler.draw(random) for _ in range(20)]

    assert drawn(5) == drawn(5)
    assert drawn(5) != drawn(6)


@pytest.mark.parametrize("text", ["S -> a a S | a a", "S -> a S b | empty", "S -> S S | a b"])
def test_a_length_without_words(text: str) -> None:
    sampler = WordSampler(over(text), 7)
    assert sampler.number == 0
    with pytest.raises(IndexError, match="no word of length 7"):
        sampler.draw(Random(0))


@pytest.mark.parametrize("text", ["S -> a S | empty", "S -> a S b | empty", "S -> S S | a | empty"])
def test_the_empty_word(text: str) -> None:
    sampler = WordSampler(over(text), 0)
    assert (sampler.number, sampler.draw(Random(0))) == (1, ())
    assert WordSampler(over(text, accept=ir.Contains(("a",))), 0).number == 0


def test_the_budget_is_for_languages_neither_regular_nor_lr() -> None:
    palindromes = over("S -> a S a | b S b | c S c | a | b | c | empty")
    with pytest.raises(BudgetExceededError, match="more than 2000 moves"):
        WordSampler(palindromes, 100, budget=2000)
    assert WordSampler(palindromes, 7, budget=2000).number == 3**4
    assert WordSampler(over("S -> a S | b S | c S | empty"), 100, budget=1).number == 3**100
    # Catalan number 20
    assert WordSampler(over("S -> a S b S | empty"), 40, budget=1).number == 6_564_120_420
