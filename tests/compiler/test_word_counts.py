from __future__ import annotations

from math import comb

import pytest
from hypothesis import given, settings

from compiler.words.budget import BudgetExceededError
from compiler.words.counting import DerivationCounts, WordsOfLength, count_by_length
from compiler.words.intersection import binary_normal_form
from compiler.words.language import Language, language
from grammar_lang import ir
from tests.oracles.brute_force_grammar import derivations, satisfies, words_of
from tests.oracles.grammars import ALPHABET, EVERY, TRAPS, grammar, random_grammars
from tests.oracles.some_cases import examples

AB = ("a", "b")
LENGTH = 42
PALINDROMES = "S -> a S a | b S b | c S c | a | b | c | empty"


def how_counted(lang: Language) -> str:
    """By what the words of a language are counted."""
    if lang.finite_automaton is not None:
        return "finite automaton"
    return "LR(1)" if lang.is_lr else "general"


def over(text: str, accept: ir.Accept = EVERY) -> Language:
    return language(grammar(text, ALPHABET, accept), ALPHABET, frozenset(ALPHABET))


def brute_force(g: ir.Grammar, longest: int) -> tuple[int, ...]:
    words = [word for word in words_of(g, longest) if satisfies(g.accept, word)]
    return tuple(sum(len(word) == length for word in words) for length in range(longest + 1))


@settings(deadline=None, max_examples=examples(20, 40))
@given(random_grammars())
def test_all_ways_of_counting_agree_with_brute_force(g: ir.Grammar) -> None:
    lang = language(g, AB, frozenset(AB))
    expected = brute_force(g, 7)
    assert lang.count_words(7) == expected
    # a horizon that is larger than needed, and the prefixes of a grammar that has a quicker way
    assert count_by_length(lang.recogniser(11), 7) == expected
    for length, number in enumerate(expected):
        assert WordsOfLength(lang.recogniser(length), length).number == number


@pytest.mark.parametrize("accept", [ir.Contains(("a", "b")), ir.Count("a", "<=", 2)])
@pytest.mark.parametrize("name", TRAPS)
def test_known_traps_with_an_accept_condition(name: str, accept: ir.Accept) -> None:
    g = grammar(TRAPS[name], ALPHABET, accept)
    assert language(g, ALPHABET, frozenset(ALPHABET)).count_words(7) == brute_force(g, 7)


# --- sequences of combinatorics, each by a recurrence of its own ---------------------------------


def powers() -> list[int]:
    return [2**n for n in range(LENGTH + 1)]


def fibonacci() -> list[int]:
    """Words over two letters without two of the first in a row."""
    row = [1, 2]
    while len(row) <= LENGTH:
        row.append(row[-1] + row[-2])
    return row


def catalan() -> list[int]:
    """Balanced words, by length."""
    return [comb(n, n // 2) // (n // 2 + 1) if n % 2 == 0 else 0 for n in range(LENGTH + 1)]


def motzkin() -> list[int]:
    """(n + 2) M(n) = (2n + 1) M(n-1) + 3 (n - 1) M(n-2)."""
    row = [1, 1]
    for n in range(2, LENGTH + 1):
        row.append(((2 * n + 1) * row[-1] + 3 * (n - 1) * row[-2]) // (n + 2))
    return row


def little_schroeder() -> list[int]:
    """(n + 1) s(n) = (6n - 3) s(n-1) - (n - 2) s(n-2), at even lengths."""
    row = [1, 1]
    for n in range(2, LENGTH // 2 + 1):
        row.append(((6 * n - 3) * row[-1] - (n - 2) * row[-2]) // (n + 1))
    return [row[n // 2] if n % 2 == 0 else 0 for n in range(LENGTH + 1)]


def schroeder() -> list[int]:
    """Twice the little ones, but for the first."""
    return [1, *(2 * number for number in little_schroeder()[1:])]


def test_the_recurrences_begin_as_they_should() -> None:
    assert fibonacci()[:6] == [1, 2, 3, 5, 8, 13]
    assert catalan()[:9:2] == [1, 1, 2, 5, 14]
    assert motzkin()[:7] == [1, 1, 2, 4, 9, 21, 51]
    assert little_schroeder()[:11:2] == [1, 1, 3, 11, 45, 197]


@pytest.mark.parametrize(
    ("text", "kind", "sequence"),
    [
        ("S -> S a | S b | empty", "finite automaton", powers),
        ("S -> S S | a | b | empty", "general", powers),
        ("S -> b S | a b S | a | empty", "finite automaton", fibonacci),
        ("S -> S S | b | a b | empty", "general", None),
        ("S -> a S b S | empty", "LR(1)", catalan),
        ("S -> S S | a S b | empty", "general", catalan),
        ("S -> c S | a S b S | empty", "LR(1)", motzkin),
        ("S -> S S | a S b | c | empty", "general", motzkin),
        ("S -> c c S | a S b S | empty", "LR(1)", schroeder),
        ("S -> S S | a S b | c c | empty", "general", schroeder),
        ("S -> a T b S | empty\nT -> c c T | a T b T | empty", "LR(1)", little_schroeder),
        ("S -> S S | a T b | empty\nT -> T T | a T b | c c | empty", "general", little_schroeder),
    ],
)
def test_known_sequences(text: str, kind: str, sequence: object) -> None:
    lang = over(text)
    assert how_counted(lang) == kind
    # words of b and a b: those without two a in a row that do not end in a
    expected = sequence() if callable(sequence) else [1, *fibonacci()[:LENGTH]]
    assert list(lang.count_words(LENGTH)) == expected


def test_an_accept_condition_on_balanced_words() -> None:
    for text in ("S -> a S b S | empty", "S -> S S | a S b | empty"):
        begun = over(text, ir.StartsWith(("a", "b"))).count_words(LENGTH)
        assert list(begun) == [0, 0, *catalan()[:-2]]
        flat = over(text, ir.NotAccept(ir.Contains(("a", "a")))).count_words(LENGTH)
        assert list(flat) == [1 - n % 2 for n in range(LENGTH + 1)]
        solid = over(text, ir.Count("a", ">=", 1)).count_words(LENGTH)
        assert list(solid) == [0, *catalan()[1:]]


def test_regular_languages_of_long_words() -> None:
    counts = over("S -> a S | b S | c S | empty").count_words(300)
    assert counts == tuple(3**n for n in range(301))
    # S -> L R without self-embedding: a^i b^j, both at least 1
    counts = over("S -> L R\nL -> a L | a\nR -> R b | b").count_words(300)
    assert counts == (0, *range(300))


# --- derivations ---------------------------------------------------------------------------------


def test_derivations_are_counted_not_words() -> None:
    # One derivation per binary tree, n + 1 leaves and n inner nodes.
    g = grammar("E -> E b E | a", ALPHABET)
    lang = language(g, ALPHABET, frozenset(ALPHABET))
    counts = DerivationCounts(binary_normal_form(lang.srg.cfg), 13)
    for n in range(7):
        assert counts.total(2 * n + 1) == catalan()[2 * n]
        assert counts.total(2 * n) == 0
    word = ("a", "b") * 4 + ("a",)
    assert counts.total(len(word)) == sum(1 for _ in derivations(g, word))
    assert lang.count_words(13)[1::2] == (1,) * 7


@pytest.mark.parametrize("length", [0, 1, 2])
def test_short_derivations(length: int) -> None:
    lang = over("S -> a S b S | empty")
    assert [DerivationCounts(lang.product, length).total(n) for n in range(length + 1)] == [
        *(1, 0, 1)[: length + 1]
    ]


def test_a_number_without_a_derivation() -> None:
    counts = DerivationCounts(over("S -> a S b S | c").product, 4)
    with pytest.raises(IndexError):
        counts.word(4, counts.total(4))


# --- the budget ----------------------------------------------------------------------------------


def test_an_exceeded_budget_says_so() -> None:
    with pytest.raises(BudgetExceededError, match=r"counting .* more than 1000 moves") as caught:
        over(PALINDROMES).count_words(60, budget=1000)
    assert caught.value.budget == 1000
    assert "prefix by prefix" in str(caught.value)
    assert over(PALINDROMES).count_words(7, budget=2000) == (1, 3, 3, 9, 9, 27, 27, 81)


def test_the_budget_counts_moves_before_the_last_symbol_only() -> None:
    # one state with three moves, once per symbol: no move is made after the last
    recogniser = over("S -> a S | b S | c S | empty").recogniser(10)
    assert count_by_length(recogniser, 10, budget=30)[-1] == 3**10
    assert WordsOfLength(recogniser, 10, budget=30).number == 3**10
    for use in (count_by_length, WordsOfLength):
        with pytest.raises(BudgetExceededError):
            use(recogniser, 10, budget=29)


def test_what_can_be_counted_in_polynomial_time_has_no_budget(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr("compiler.words.language.MOVE_BUDGET", 10)
    assert over("S -> a S | b S | empty").count_words(200)[-1] == 2**200
    assert over("S -> a S b S | empty").count_words(LENGTH)[-1] == catalan()[-1]
    with pytest.raises(BudgetExceededError, match="more than 10 moves"):
        over(PALINDROMES).count_words(8)
