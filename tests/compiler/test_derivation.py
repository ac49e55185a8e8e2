from __future__ import annotations

from itertools import islice

import pytest
from hypothesis import assume, given, settings

from compiler.words.derivation import BadDerivation, Derivation, replay
from compiler.words.grammar import cyclic, trimmed
from compiler.words.language import language
from compiler.words.structures import InfiniteAmbiguityError, derivations_of, structures
from grammar_lang import ir
from tests.oracles.brute_force_grammar import all_words, derivations, satisfies, words_of
from tests.oracles.grammars import (
    ALPHABET,
    ARM_MODULES,
    ARM_TERMINALS,
    EVERY,
    TRAPS,
    arm,
    grammar,
    random_grammars,
)
from tests.oracles.some_cases import examples

AB = ("a", "b")


def check_tree(g: ir.Grammar, derivation: Derivation) -> None:
    """Children point at the right things: nodes in pre-order, the word from left to right."""
    terminals: list[int] = []
    visited: list[int] = []
    todo: list[tuple[int, bool]] = [(0, True)]
    while todo:
        index, is_node = todo.pop()
        if not is_node:
            terminals.append(index)
            continue
        visited.append(index)
        node = derivation.nodes[index]
        assert len(node.children) == len(node.production.right)
        steps: list[tuple[int, bool]] = []
        for child, symbol in zip(node.children, node.production.right, strict=True):
            if symbol.kind == "nonterminal":
                assert derivation.nodes[child].production.left == symbol.name
                steps.append((child, True))
            else:
                assert derivation.word[child] == symbol.name
                steps.append((child, False))
        todo += reversed(steps)
    assert derivation.nodes[0].production.left == g.start
    assert visited == list(range(len(derivation.nodes)))
    assert terminals == list(range(len(derivation.word)))


MANY = 200


def brute_force(g: ir.Grammar, word: tuple[str, ...]) -> set[tuple[str, ...]]:
    """The derivations of a word; discards the example where empty productions make them many."""
    found = set(islice(derivations(g, word), MANY))
    assume(len(found) < MANY)
    return found


def in_order(g: ir.Grammar, labels: set[tuple[str, ...]]) -> list[tuple[str, ...]]:
    number = {p.label: i for i, p in enumerate(g.productions)}
    return sorted(labels, key=lambda sequence: [number[label] for label in sequence])


@settings(deadline=None, max_examples=examples(25, 120))
@given(random_grammars())
def test_derivations_are_those_of_brute_force(g: ir.Grammar) -> None:
    lang = language(g, AB, frozenset(AB))
    assume(not cyclic(trimmed(lang.srg.cfg)))
    for word in all_words(AB, 5):
        found = list(derivations_of(lang, word))
        expected = brute_force(g, word) if satisfies(g.accept, word) else set()
        assert [d.labels for d in found] == in_order(g, expected)
        for derivation in found:
            assert derivation.word == word
            assert replay(g, derivation.labels) == derivation
            check_tree(g, derivation)


@settings(deadline=None, max_examples=examples(30, 60))
@given(random_grammars())
def test_the_first_derivations_of_highly_ambiguous_words(g: ir.Grammar) -> None:
    lang = language(g, AB, frozenset(AB))
    assume(not cyclic(trimmed(lang.srg.cfg)))
    number = {p.label: i for i, p in enumerate(g.productions)}
    for word in islice(lang.words(max_length=4), 10):
        found = [d.labels for d in islice(derivations_of(lang, word), 50)]
        keys = [[number[label] for label in labels] for labels in found]
        assert keys == sorted(keys)
        assert len(set(found)) == len(found) > 0
        assert all(replay(g, labels).word == word for labels in found)


@settings(deadline=None, max_examples=examples(30, 80))
@given(random_grammars())
def test_structures_by_word_then_by_productions(g: ir.Grammar) -> None:
    lang = language(g, AB, frozenset("a"))
    assume(not cyclic(trimmed(lang.srg.cfg)))
    words = [
        w
        for w in all_words(AB, 5)
        if w and w in words_of(g, 5) and w.count("a") <= 2 and satisfies(g.accept, w)
    ]
    expected = [labels for w in words for labels in in_order(g, brute_force(g, w))]
    found = structures(lang, 2)
    assert [d.labels for d in islice(found, len(expected))] == expected
    following = next(found, None)
    assert following is None or len(following.word) > 5


@settings(deadline=None, max_examples=examples(35, 100))
@given(random_grammars())
def test_cyclic_grammars_are_refused_at_once(g: ir.Grammar) -> None:
    lang = language(g, AB, frozenset(AB))
    if cyclic(trimmed(lang.srg.cfg)):
        with pytest.raises(InfiniteAmbiguityError, match="derives itself"):
            derivations_of(lang, ("a",))
        with pytest.raises(InfiniteAmbiguityError):
            structures(lang, 3)
    else:
        derivations_of(lang, ("a",))


def test_derivations_are_not_words() -> None:
    # Catalan many derivations of a sum, one word.
    lang = language(grammar("E -> E b E | a", ALPHABET), ALPHABET, frozenset("a"))
    for n, catalan in enumerate([1, 1, 2, 5, 14, 42, 132]):
        word = ("a",) + ("b", "a") * n
        assert sum(1 for _ in derivations_of(lang, word)) == catalan
    # Lazy: the first of astronomically many.
    word = ("a",) + ("b", "a") * 60
    assert next(derivations_of(lang, word)).word == word


def test_structures_of_the_running_example() -> None:
    lang = language(arm(), ARM_TERMINALS, ARM_MODULES)
    found = list(structures(lang, 5))
    assert len(found) == sum(3**k - 2**k for k in range(4))
    assert found[0].labels == ("p3", "p1", "p0")
    assert found[0].word == ("B", "eps", "JO", "eps", "EN")
    assert [node.children for node in found[0].nodes] == [(1, 3, 4), (2, 1, 2), (0,)]


def test_the_empty_word_is_no_robot() -> None:
    lang = language(grammar("S -> a S b | empty", ALPHABET), ALPHABET, frozenset("a"))
    assert [d.word for d in structures(lang, 2)] == [("a", "b"), ("a", "a", "b", "b")]
    assert len(list(derivations_of(lang, ()))) == 1


def test_words_outside_have_no_derivation() -> None:
    lang = language(arm(), ARM_TERMINALS, ARM_MODULES)
    for word in [(), ("X",), ("B",), ("N",), ("B", "eps", "EN")]:
        assert list(derivations_of(lang, word)) == []


@pytest.mark.parametrize(
    ("labels", "reason"),
    [
        (("p3", "p1", "pX"), "no production 'pX'"),
        (("p3", "p1"), "stops before N is replaced"),
        ((), "stops before N is replaced"),
        (("p0", "p0"), "p0 is left over"),
    ],
)
def test_bad_derivations(labels: tuple[str, ...], reason: str) -> None:
    with pytest.raises(BadDerivation, match=reason):
        replay(arm(), labels)


def test_only_the_leftmost_nonterminal_may_be_replaced() -> None:
    g = grammar("S -> T U\nT -> a\nU -> b", ALPHABET)
    assert replay(g, ("p0", "p1", "p2")).word == ("a", "b")
    with pytest.raises(BadDerivation, match=r"step 2: p2 replaces U, but the leftmost .* is T"):
        replay(g, ("p0", "p2", "p1"))


@pytest.mark.parametrize(
    ("text", "labels"),
    [
        ("N -> a | N b", ("p1",) * 4999 + ("p0",)),
        ("N -> b N | a", ("p0",) * 4999 + ("p1",)),
        ("S -> a S b | c", ("p0",) * 2500 + ("p1",)),
    ],
)
def test_replay_of_long_words(text: str, labels: tuple[str, ...]) -> None:
    g = grammar(text, ALPHABET)
    derivation = replay(g, labels)
    assert derivation.labels == labels
    assert len(derivation.word) >= 5000
    check_tree(g, derivation)


def test_derivation_of_a_long_word() -> None:
    g = grammar("N -> a | N b", ALPHABET)
    lang = language(g, ALPHABET, frozenset("a"))
    word = ("a",) + ("b",) * 4999
    (derivation,) = derivations_of(lang, word)
    assert derivation == replay(g, ("p1",) * 4999 + ("p0",))


def test_traps_in_derivations() -> None:
    for name in ("hidden left recursion", "nullable chain", "not LALR", "mutual left"):
        g = grammar(TRAPS[name], ALPHABET, EVERY)
        lang = language(g, ALPHABET, frozenset())
        if cyclic(trimmed(lang.srg.cfg)):
            continue
        for word in islice(lang.words(max_length=6), 60):
            expected = in_order(g, set(derivations(g, word)))
            assert [d.labels for d in derivations_of(lang, word)] == expected
