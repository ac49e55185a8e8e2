from __future__ import annotations

import pytest
from hypothesis import given, settings

from compiler.words.acceptance import accept_dfa
from compiler.words.finite_automaton import Dfa
from compiler.words.grammar import srg
from compiler.words.regular_automaton import SUBSET_LIMIT, regular_automaton
from grammar_lang import ir
from tests.oracles.brute_force_grammar import all_words, satisfies, words_of
from tests.oracles.grammars import ALPHABET, EVERY, TRAPS, grammar, random_grammars
from tests.oracles.some_cases import examples

AB = ("a", "b")
HALF = 4


def automaton(g: ir.Grammar, terminals: tuple[str, ...]) -> Dfa | None:
    return regular_automaton(srg(g, terminals, ()), accept_dfa(g.accept, terminals))


def check(g: ir.Grammar, dfa: Dfa, terminals: tuple[str, ...]) -> int:
    """The words up to length 8, and the size; the number of classes of prefixes up to length 4."""
    words = {word for word in words_of(g, 2 * HALF) if satisfies(g.accept, word)}
    for word in all_words(terminals, 2 * HALF if len(terminals) < 3 else 6):
        assert dfa.accepts(word) == (word in words)
    parts = all_words(terminals, HALF)
    classes = len({tuple(prefix + rest in words for rest in parts) for prefix in parts})
    # Every state of n is reached by n - 1 symbols and any two are told apart by n - 2 (Moore 1956).
    assert classes <= dfa.size
    if dfa.size <= HALF + 1:
        assert classes == dfa.size
    return classes


@settings(deadline=None, max_examples=examples(30, 60))
@given(random_grammars())
def test_random_grammars(g: ir.Grammar) -> None:
    dfa = automaton(g, AB)
    if dfa is not None:
        check(g, dfa, AB)


LINEAR = {
    "left-linear": "S -> S a b | T c | empty\nT -> S b | T a",
    "right-linear": "S -> a b S | c T | empty\nT -> b S | a T | c",
    "unit productions": "S -> T | a S\nT -> S | b",
    "useless": TRAPS["useless"],
    "empty language": "S -> a S",
    "empty word": "S -> empty",
}
NOT_SELF_EMBEDDING = {
    "two loops": "S -> A B\nA -> a A | a\nB -> B b | b",
    "a loop twice": "S -> A b A\nA -> a A | c | empty",
    "a loop within a loop": "S -> T S | c\nT -> a T | b",
    "mutual": "S -> A c | A B\nA -> B a | a\nB -> A b | B b",
    "empty and finite": "S -> A A A\nA -> a | b | empty",
    "embedding in useless rules only": "S -> A B\nA -> a A | a\nB -> b | a U b\nU -> a U b",
}


@pytest.mark.parametrize("accept", [EVERY, ir.Contains(("a",)), ir.Count(None, ">=", 3)])
@pytest.mark.parametrize("name", [*LINEAR, *NOT_SELF_EMBEDDING])
def test_grammars_of_regular_form(name: str, accept: ir.Accept) -> None:
    g = grammar({**LINEAR, **NOT_SELF_EMBEDDING}[name], ALPHABET, accept)
    dfa = automaton(g, ALPHABET)
    assert dfa is not None
    check(g, dfa, ALPHABET)


@pytest.mark.parametrize(
    ("text", "size"),
    [
        # start, in a, in b, sink
        ("S -> A B\nA -> a A | a\nB -> b B | b", 4),
        ("S -> a S | b S | empty", 1),
        ("S -> a S", 1),
        # remainders modulo 5
        ("S -> a a a a a S | b S | empty", 6),
        # the last three symbols
        ("S -> a S | b S | a T\nT -> a U | b U\nU -> a | b", 8),
    ],
)
def test_known_sizes(text: str, size: int) -> None:
    dfa = automaton(grammar(text, AB), AB)
    assert dfa is not None
    assert dfa.size == size


def test_other_forms_have_none() -> None:
    for text in (
        "S -> a S b | a b",
        TRAPS["odd palindromes"],
        TRAPS["ambiguous"],
        # recursion at both ends, though the language is regular
        "S -> a S | S b | a",
        # a cycle beside a right side of two nonterminals
        "S -> S | T T\nT -> a",
    ):
        assert automaton(grammar(text, ALPHABET), ALPHABET) is None


def last_but(k: int, *, left: bool = False) -> str:
    """The symbol number k + 1 from the end, or from the beginning, is an ``a``."""
    lines = ["S -> a S | b S | a X1", *(f"X{i} -> a X{i + 1} | b X{i + 1}" for i in range(1, k))]
    lines.append(f"X{k} -> a | b")
    if left:
        lines = [
            line.split(" -> ")[0]
            + " -> "
            + " | ".join(" ".join(reversed(r.split())) for r in line.split(" -> ")[1].split(" | "))
            for line in lines
        ]
    return "\n".join(lines)


def test_an_automaton_that_explodes_is_not_made() -> None:
    small = automaton(grammar(last_but(7), AB), AB)
    assert small is not None
    assert small.size == 2**8
    assert SUBSET_LIMIT < 2**15
    assert automaton(grammar(last_but(14), AB), AB) is None
    # the same from the other end is small
    mirrored = automaton(grammar(last_but(14, left=True), AB), AB)
    assert mirrored is not None
    assert mirrored.size == 14 + 3
