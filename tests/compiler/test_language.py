from __future__ import annotations

from itertools import islice

import pytest
from hypothesis import given, settings

from compiler.words import residuals
from compiler.words.language import Language, language
from compiler.words.pushdown_automaton import accepts, sra
from grammar_lang import ir
from tests.oracles.brute_force_grammar import all_words, satisfies, sentential_words, words_of
from tests.oracles.grammars import (
    ALPHABET,
    ARM_MODULES,
    ARM_TERMINALS,
    TRAPS,
    arm,
    grammar,
    random_grammars,
)
from tests.oracles.some_cases import examples, some

AB = ("a", "b")


def expected_words(g: ir.Grammar, terminals: tuple[str, ...], n: int) -> list[tuple[str, ...]]:
    order = {name: i for i, name in enumerate(terminals)}
    words = [w for w in words_of(g, n) if satisfies(g.accept, w)]
    return sorted(words, key=lambda w: (len(w), [order[s] for s in w]))


def check_against_brute_force(g: ir.Grammar) -> None:
    n = 8
    expected = expected_words(g, AB, n)
    lang = language(g, AB, frozenset(AB))
    pda = sra(lang.srg, lang.accept)
    assert list(lang.words(max_length=n)) == expected
    counts = [0] * (n + 1)
    for word in expected:
        counts[len(word)] += 1
    assert list(lang.count_words(n)) == counts
    members = set(expected)
    for word in all_words(AB, n):
        assert lang.accepts(word) == (word in members)
        assert accepts(pda, word) == (word in members)
    if lang.is_empty():
        assert not expected


@settings(deadline=None, max_examples=examples(20, 40))
@given(random_grammars())
def test_the_fewest_modules_against_an_automaton_that_counts_them(g: ir.Grammar) -> None:
    lang = language(g, AB, frozenset("b"))
    fewest = lang.fewest_modules()
    few = [word.count("b") for word in expected_words(g, AB, 8) if word]
    if fewest is None:
        assert not few
    elif not lang.accepts(()):  # the empty word has the fewest
        assert fewest <= min(few, default=fewest)
        assert not lang.is_empty(max_modules=fewest)
        assert fewest == 0 or lang.is_empty(max_modules=fewest - 1)


@settings(deadline=None, max_examples=examples(10, 40))
@given(random_grammars())
def test_language_equals_brute_force_and_the_automaton(g: ir.Grammar) -> None:
    check_against_brute_force(g)


@pytest.mark.slow
@settings(deadline=None, max_examples=400)
@given(random_grammars())
def test_language_equals_brute_force_and_the_automaton_at_length(g: ir.Grammar) -> None:
    check_against_brute_force(g)


@settings(deadline=None, max_examples=examples(25, 60))
@given(random_grammars())
def test_module_bound_and_finiteness(g: ir.Grammar) -> None:
    lang = language(g, AB, frozenset({"a"}))
    expected = [w for w in expected_words(g, AB, 7) if w.count("a") <= 2]
    assert list(lang.words(max_length=7, max_modules=2)) == expected
    if lang.is_finite(max_modules=2):
        counts = lang.count_words(max_modules=2)
        assert sum(counts) == sum(1 for _ in lang.words(max_modules=2))
        assert list(counts[:8]) == [
            sum(len(w) == n for w in expected) for n in range(min(8, len(counts)))
        ]
    else:
        # The pumping lemma gives longer words without end.
        assert len(list(islice(lang.words(max_modules=2), 40))) == 40
        with pytest.raises(ValueError, match="infinite"):
            lang.count_words(max_modules=2)


@settings(deadline=None, max_examples=examples(20, 40))
@given(random_grammars())
def test_the_oracles_agree(g: ir.Grammar) -> None:
    found = sentential_words(g, 3, 6)
    assert found <= words_of(g, 3)


@pytest.mark.parametrize("name", TRAPS)
def test_known_traps(name: str) -> None:
    g = grammar(TRAPS[name], ALPHABET)
    lang = language(g, ALPHABET, frozenset(ALPHABET))
    pda = sra(lang.srg, lang.accept)
    expected = expected_words(g, ALPHABET, 7)
    assert list(lang.words(max_length=7)) == expected
    members = set(expected)
    for word in all_words(ALPHABET, 6):
        assert lang.accepts(word) == (word in members)
        assert accepts(pda, word) == (word in members)


def test_trap_language_properties() -> None:
    def of(name: str) -> Language:
        return language(grammar(TRAPS[name], ALPHABET), ALPHABET, frozenset(ALPHABET))

    assert of("empty language").is_empty()
    assert not of("empty word only").is_empty()
    assert list(of("empty word only").words()) == [()]
    assert of("not LALR").is_finite()
    assert of("nullable chain").is_finite()
    assert not of("empty cycle").is_finite()
    assert of("not LALR").count_words() == (0, 0, 0, 4)
    assert of("not LALR").count_words(5) == (0, 0, 0, 4, 0, 0)


def test_running_example_counts_follow_the_algebra() -> None:
    lang = language(arm(), ARM_TERMINALS, ARM_MODULES)
    counts = lang.count_words(199)
    for n in range(2, 101):
        # n modules: B eps JO, then n - 2 free choices of three, not all of them JO or L.
        assert counts[2 * n - 1] == 3 ** (n - 2) - 2 ** (n - 2)
        assert counts[2 * n - 2] == 0


def test_running_example_lists_all_words_of_twelve_modules() -> None:
    lang = language(arm(), ARM_TERMINALS, ARM_MODULES)
    words = list(lang.words(max_modules=12))
    assert len(words) == len(set(words)) == sum(3**k - 2**k for k in range(11))
    assert words[:2] == [
        ("B", "eps", "JO", "eps", "EN"),
        ("B", "eps", "JO", "eps", "JO", "eps", "EN"),
    ]
    assert words == sorted(words, key=lambda w: (len(w), [ARM_TERMINALS.index(s) for s in w]))


def test_enumeration_is_lazy() -> None:
    lang = language(arm(), ARM_TERMINALS, ARM_MODULES)
    first = list(islice(lang.words(), 5000))
    assert first == list(islice(lang.words(max_modules=12), 5000))


def test_counting_an_ambiguous_language_counts_words_not_derivations() -> None:
    # Motzkin-like counts by brute force up to 9, distinct words only.
    g = grammar("E -> E b E | c E c | a", ALPHABET)
    lang = language(g, ALPHABET, frozenset(ALPHABET))
    words = words_of(g, 9)
    assert lang.count_words(9) == tuple(sum(len(w) == n for w in words) for n in range(10))


def test_forgetting_remembered_residuals_changes_nothing(monkeypatch: pytest.MonkeyPatch) -> None:
    g = grammar("T -> a | a b T c | a b T c b T c | T b T", ALPHABET)
    lang = language(g, ALPHABET, frozenset(ALPHABET))
    words, counts = list(lang.words(max_length=11)), lang.count_words(11)
    monkeypatch.setattr(residuals, "CACHE_LIMIT", 3)
    assert list(lang.words(max_length=11)) == words
    assert lang.count_words(11) == counts


def long_word(name: str) -> tuple[str, tuple[str, ...], tuple[str, ...]]:
    text = {
        "left": "N -> a | N b",
        "right": "N -> b N | a",
        "counted": "S -> a S b | c",
        "unambiguous sums": "E -> E b T | T\nT -> a | c E c",
    }[name]
    word = {
        "left": ("a",) + ("b",) * 4999,
        "right": ("b",) * 4999 + ("a",),
        "counted": ("a",) * 2500 + ("c",) + ("b",) * 2500,
        "unambiguous sums": ("a", "b") * 2500 + ("a",),
    }[name]
    return text, word, (*word, "a", "b")


@pytest.mark.parametrize("name", some(["left", "unambiguous sums", "right", "counted"], 2))
def test_words_of_five_thousand_symbols(name: str) -> None:
    text, word, other = long_word(name)
    lang = language(grammar(text, ALPHABET), ALPHABET, frozenset(ALPHABET))
    pda = sra(lang.srg, lang.accept)
    assert lang.accepts(word)
    assert accepts(pda, word)
    assert not lang.accepts((*other, "b"))
    assert not accepts(pda, (*other, "b"))


def test_unknown_tokens_are_rejected() -> None:
    lang = language(arm(ir.AllOf(())), ARM_TERMINALS, ARM_MODULES)
    assert lang.accepts(("B",))
    for word in [("",), ("N",), ("b",), ("B", "eps", "X"), ("B eps JO",), ()]:
        assert not lang.accepts(word)


def test_tokens_spelt_like_other_things() -> None:
    # A terminal may be spelt like a nonterminal's neighbour, like the empty word, like a prefix.
    terminals = ("epsilon", "J", "O", "JO", "$", "empty word", "S'")
    g = grammar("S -> epsilon S $ | JO | J O", terminals)
    lang = language(g, terminals, frozenset(terminals))
    assert list(islice(lang.words(), 4)) == [
        ("JO",),
        ("J", "O"),
        ("epsilon", "JO", "$"),
        ("epsilon", "J", "O", "$"),
    ]
    pda = sra(lang.srg, lang.accept)
    assert all(accepts(pda, w) for w in islice(lang.words(), 6))
    assert not accepts(pda, ("JO", "$"))
