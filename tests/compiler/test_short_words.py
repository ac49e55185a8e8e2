from __future__ import annotations

import pytest
from hypothesis import given, settings

from compiler.words.ambiguity import short_words
from compiler.words.grammar import cyclic, srg, trimmed
from grammar_lang import ir
from tests.oracles.brute_force_grammar import derivations, words_of
from tests.oracles.grammars import ALPHABET, TRAPS, grammar, random_grammars
from tests.oracles.some_cases import examples


@settings(max_examples=examples(40, 150), deadline=None)
@given(random_grammars())
def test_words_and_numbers_of_derivations(g: ir.Grammar) -> None:
    rules = srg(g, ("a", "b"), "ab")
    cfg = trimmed(rules.cfg)
    if cyclic(cfg):
        return
    found = short_words(cfg, 20_000, 4)
    if found.length < 4:
        return
    if sum(found.derivations.values()) >= 300:  # more takes brute force too long
        return
    expected = sorted(words_of(g, 4), key=lambda word: (len(word), word))
    assert [rules.decode(word) for word in found.derivations] == expected
    for word, number in found.derivations.items():
        assert number == sum(1 for _ in derivations(g, rules.decode(word)))


def catalan(n: int) -> int:
    return 1 if n == 0 else catalan(n - 1) * 2 * (2 * n - 1) // (n + 1)


def test_bracketings_are_counted_by_catalan() -> None:
    cfg = srg(grammar("E -> E b E | a", ALPHABET), ALPHABET, ALPHABET).cfg
    found = short_words(cfg, 10_000, 21)
    assert found.length == 21
    assert list(found.derivations.values()) == [catalan(n) for n in range(11)]


@pytest.mark.parametrize("text", [TRAPS["branching"], "S -> a S | b S | c S | a", "S -> a"])
def test_the_budget_bounds_the_length(text: str) -> None:
    cfg = srg(grammar(text, ALPHABET), ALPHABET, ALPHABET).cfg
    lengths = [short_words(cfg, steps, 12).length for steps in (0, 10, 100, 1_000, 10_000)]
    assert lengths == sorted(lengths)
    assert lengths[0] == -1
    assert short_words(cfg, 0, 12).derivations == {}


def test_a_product_of_many_choices_is_not_begun() -> None:
    cfg = srg(grammar("S -> A A A A A A A A\nA -> a | b | c", ALPHABET), ALPHABET, ALPHABET).cfg
    assert short_words(cfg, 2_000, 8).length == 7  # the 6561 words have length 8
    assert len(short_words(cfg, 30_000, 8).derivations) == 3**8
