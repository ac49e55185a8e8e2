from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction
from itertools import islice, takewhile

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.words import weighted_words
from compiler.words.acceptance import accept_dfa, at_most
from compiler.words.finite_automaton import STATE_LIMIT, AutomatonTooLargeError
from compiler.words.language import Language, language
from compiler.words.weighted_words import weight_at_most, words_by_weight
from grammar_lang import ir
from tests.oracles.brute_force_grammar import all_words, satisfies, words_of
from tests.oracles.grammars import (
    ALPHABET,
    ARM_MODULES,
    ARM_TERMINALS,
    EVERY,
    TRAPS,
    accepts,
    arm,
    grammar,
    random_grammars,
)
from tests.oracles.limits import asked_by
from tests.oracles.some_cases import examples

AB = ("a", "b")
Word = tuple[str, ...]
Weights = dict[str, Fraction]
POSITIVE = [Fraction(1, 3), Fraction(1, 2), Fraction(2, 3), Fraction(1), Fraction(5, 4)]
SOME = [Fraction(0), *POSITIVE]
ONE, HALF = Fraction(1), Fraction(1, 2)


def over(text: str, accept: ir.Accept = EVERY) -> Language:
    return language(grammar(text, ALPHABET, accept), ALPHABET, frozenset(ALPHABET))


def total(word: Word, weights: Weights) -> Fraction:
    return sum((weights.get(symbol, Fraction(0)) for symbol in word), Fraction(0))


def sorted_words(
    words: Iterable[Word], weights: Weights, terminals: Word
) -> list[tuple[Fraction, Word]]:
    """With their weights, by weight, length and symbols."""
    weighed = [(total(word, weights), word) for word in words]
    return sorted(weighed, key=lambda w: (w[0], len(w[1]), [terminals.index(s) for s in w[1]]))


def weightings(values: list[Fraction]) -> st.SearchStrategy[Weights]:
    return st.dictionaries(st.sampled_from(AB), st.sampled_from(values))


def up_to(g: ir.Grammar, length: int) -> ir.Grammar:
    """The words of at most so many symbols."""
    accept = ir.AllOf((g.accept, ir.Count(None, "<=", length)))
    return ir.Grammar(g.name, g.start, g.nonterminals, g.productions, accept, None)


# --- Words in order -------------------------------------------------------------------------------


@settings(deadline=None, max_examples=examples(60, 400))
@given(random_grammars(), weightings(SOME))
def test_words_of_finite_languages_are_those_of_brute_force(
    g: ir.Grammar, weights: Weights
) -> None:
    lang = language(up_to(g, 6), AB, frozenset("a"))
    words = [word for word in words_of(g, 6) if satisfies(g.accept, word)]
    assert list(words_by_weight(lang, weights)) == sorted_words(words, weights, AB)
    few = [word for word in words if word.count("a") <= 2]
    bounded = words_by_weight(lang, weights, max_modules=2)
    assert list(bounded) == sorted_words(few, weights, AB)


@settings(deadline=None, max_examples=examples(40, 300))
@given(random_grammars(), st.tuples(*[st.sampled_from(POSITIVE)] * 2))
def test_the_first_words_of_any_language(g: ir.Grammar, values: tuple[Fraction, Fraction]) -> None:
    weights = dict(zip(AB, values, strict=True))
    limit = 8 * min(values)  # longer words than those of brute force weigh as much
    words = (word for word in words_of(g, 7) if satisfies(g.accept, word))
    found = words_by_weight(language(g, AB, frozenset(AB)), weights)
    assert list(takewhile(lambda w: w[0] < limit, found)) == [
        one for one in sorted_words(words, weights, AB) if one[0] < limit
    ]


@settings(deadline=None, max_examples=examples(40, 300))
@given(random_grammars(), weightings([Fraction(0), ONE]))
def test_words_without_weight_come_by_length(g: ir.Grammar, weights: Weights) -> None:
    words = (word for word in words_of(g, 7) if satisfies(g.accept, word))
    found = words_by_weight(language(g, AB, frozenset(AB)), weights)
    assert list(takewhile(lambda w: not w[0] and len(w[1]) <= 7, found)) == [
        one for one in sorted_words(words, weights, AB) if not one[0]
    ]


@pytest.mark.parametrize("b", [Fraction(0), HALF, ONE])
@pytest.mark.parametrize("name", TRAPS)
def test_known_traps(name: str, b: Fraction) -> None:
    g = grammar(TRAPS[name], ALPHABET)
    lang = language(up_to(g, 7), ALPHABET, frozenset(ALPHABET))
    weights = {"a": HALF, "b": b, "c": Fraction(3, 2)}
    assert list(words_by_weight(lang, weights)) == sorted_words(words_of(g, 7), weights, ALPHABET)


def test_ties_go_by_length_and_then_by_the_order_of_declaration() -> None:
    lang = over("S -> c | b | a | b b | b a")
    weights = {"a": ONE, "b": HALF, "c": ONE}
    assert list(words_by_weight(lang, weights)) == [
        (HALF, ("b",)),
        (ONE, ("a",)),
        (ONE, ("c",)),
        (ONE, ("b", "b")),
        (Fraction(3, 2), ("b", "a")),
    ]


def test_without_weights_the_order_is_that_of_the_words() -> None:
    lang = language(arm(), ARM_TERMINALS, ARM_MODULES)
    listed = [(Fraction(0), word) for word in lang.words(max_modules=8)]
    assert list(words_by_weight(lang, {}, max_modules=8)) == listed
    assert list(words_by_weight(lang, {"no symbol": ONE}, max_modules=8)) == listed


def test_one_weight_may_never_end() -> None:
    found = words_by_weight(over("S -> a S | b | empty"), {"b": ONE})
    assert list(islice(found, 500)) == [(Fraction(0), ("a",) * n) for n in range(500)]


def test_weights_are_exact() -> None:
    tiny = Fraction(1, 10**30)
    weights = {"a": Fraction(1, 3), "b": Fraction(1, 3) + tiny, "c": Fraction(1, 3) - tiny}
    assert list(words_by_weight(over("S -> a | b | c"), weights)) == [
        (weights["c"], ("c",)),
        (weights["a"], ("a",)),
        (weights["b"], ("b",)),
    ]


def test_negative_weights_are_refused_at_once() -> None:
    with pytest.raises(ValueError, match="the weight of `b` is negative"):
        words_by_weight(over("S -> a"), {"a": ONE, "b": -ONE})


# --- Little work for few words --------------------------------------------------------------------


@pytest.mark.parametrize("max_modules", [15, None])
def test_few_words_of_a_large_family_need_little_work(max_modules: int | None) -> None:
    lang = over("S -> a S | b S | c S | a")
    assert lang.count_words(15)[15] == 3**14 > 10**6
    weights = {"a": Fraction(1, 2), "b": Fraction(1, 3), "c": Fraction(1, 5)}
    found = words_by_weight(lang, weights, max_modules=max_modules)
    # Every choice that is made asks for the time, and so does every step towards the grammar.
    _, first = asked_by(lambda: next(found), most=1_000)
    _, others = asked_by(lambda: list(islice(found, 19)), most=500)
    words = (w for w in all_words(ALPHABET, 7) if w[-1:] == ("a",))
    assert [first, *others] == sorted_words(words, weights, ALPHABET)[:20]
    assert others[-1][0] < 7 * weights["c"] + weights["a"]  # no longer word weighs less


def test_words_of_two_thousand_symbols_need_no_recursion() -> None:
    long = 2_000
    lines = [f"N{n} -> a N{n + 1} | b N{n + 1}" for n in range(1, long)]
    lang = over("\n".join([*lines, f"N{long} -> a | b"]))
    words = [word for _, word in islice(words_by_weight(lang, {"a": ONE, "b": ONE}), 3)]
    assert words == [
        ("a",) * long,
        (*("a",) * (long - 1), "b"),
        (*("a",) * (long - 2), "b", "a"),
    ]


# --- Words up to a weight -------------------------------------------------------------------------


@settings(deadline=None, max_examples=examples(60, 300))
@given(weightings(SOME), st.fractions(-1, 2, max_denominator=6), st.booleans())
def test_the_automaton_of_a_bound_is_minimal_and_decides_it(
    weights: Weights, bound: Fraction, strict: bool
) -> None:
    dfa = weight_at_most(AB, weights, bound, strict=strict)
    words = all_words(AB, 7)
    totals = {word: total(word, weights) for word in words}
    for word, weight in totals.items():
        assert dfa.accepts(word) == (weight < bound if strict else weight <= bound), word
    # Words differ where a continuation tells them apart (Myhill, Nerode); seven symbols suffice.
    sums = sorted(set(totals.values()))
    rows = {tuple(s + t < bound if strict else s + t <= bound for t in sums) for s in sums}
    assert dfa.size == len(rows)


def test_bounds_that_count_symbols() -> None:
    for n in range(4):
        counted = at_most(ALPHABET, "ac", n)
        weights = {"a": ONE, "b": Fraction(0), "c": ONE}
        assert weight_at_most(ALPHABET, weights, Fraction(n)) == counted
        assert weight_at_most(ALPHABET, weights, Fraction(n) + HALF, strict=True) == counted
        assert weight_at_most(ALPHABET, weights, Fraction(n + 1), strict=True) == counted


def test_sums_with_the_same_continuations_are_one_state() -> None:
    # Of the sums 0, 2, 3 and 4 nothing is added to the last two.
    dfa = weight_at_most(AB, {"a": Fraction(3), "b": Fraction(2)}, Fraction(4))
    assert dfa.size == 4
    assert dfa.run("a") == (0, 1)
    assert dfa.run("bb") == (0, 2, 1)


def test_bounds_that_no_word_or_every_word_keeps() -> None:
    assert not weight_at_most(AB, {}, Fraction(0), strict=True).accepts(())
    assert not weight_at_most(AB, {}, -HALF).accepts(())
    every = weight_at_most(AB, {"c": ONE}, Fraction(0))
    assert every.accepting == (True,)
    with pytest.raises(ValueError, match="the weight of `a` is negative"):
        weight_at_most(AB, {"a": -ONE}, ONE)


def test_the_number_of_states_is_limited(monkeypatch: pytest.MonkeyPatch) -> None:
    small = {"a": Fraction(1, 1_000_000), "b": ONE}
    with pytest.raises(AutomatonTooLargeError, match=f"over {STATE_LIMIT} states"):
        weight_at_most(AB, small, ONE)
    monkeypatch.setattr(weighted_words, "STATE_LIMIT", 12)
    assert weight_at_most(AB, {"a": ONE}, Fraction(10)).size == 12
    with pytest.raises(AutomatonTooLargeError):
        weight_at_most(AB, {"a": ONE}, Fraction(11))


def test_sums_of_other_words_are_not_states() -> None:
    """Ten weights have millions of sums; the words of the condition have few."""
    symbols = tuple("abcdefghij")
    weights = {symbol: Fraction(1, n + 11) for n, symbol in enumerate(symbols)}
    condition = ir.Matches(ir.RSequence((ir.RSymbol("a"), ir.RRepeat(ir.RSymbol("b"), "*"))))
    inside = accept_dfa(condition, symbols)
    with pytest.raises(AutomatonTooLargeError):
        weight_at_most(symbols, weights, Fraction(3))
    dfa = weight_at_most(symbols, weights, Fraction(3), inside=inside)
    assert dfa.accepts(("a", *"b" * 34))
    assert not dfa.accepts(("a", *"b" * 35))
    assert not dfa.accepts(("b",))
    assert dfa.size == 37
    assert not weight_at_most(AB, {}, ONE, inside=at_most(AB, AB, -1)).accepts(())


@settings(deadline=None, max_examples=examples(40, 200))
@given(accepts(AB), weightings(SOME), st.sampled_from(SOME))
def test_weights_of_the_words_of_a_condition(
    condition: ir.Accept, weights: Weights, bound: Fraction
) -> None:
    dfa = weight_at_most(AB, weights, bound, inside=accept_dfa(condition, AB))
    for word in all_words(AB, 5):
        light = total(word, weights) <= bound
        assert dfa.accepts(word) == (light and satisfies(condition, word))
