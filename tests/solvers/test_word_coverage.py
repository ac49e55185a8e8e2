"""The verifier's test that no word is left, against the definition, word by word."""

from __future__ import annotations

import ast
import inspect
from collections.abc import Iterable
from fractions import Fraction
from functools import partial
from itertools import product

import pytest
from hypothesis import given, settings

from grammar_lang import ir
from solvers.verifier.refutations import word_coverage
from solvers.verifier.refutations.word_coverage import (
    Reader,
    State,
    listed,
    reader,
    weighing,
    within,
    word_left,
)
from tests.oracles import brute_force_grammar
from tests.oracles.grammars import ALPHABET, TRAPS, accepts, grammar
from tests.oracles.limits import asked_by
from tests.oracles.some_cases import examples

WORDS = [word for n in range(6) for word in product("ab", repeat=n)]


@settings(deadline=None, max_examples=examples(60, 300))
@given(accepts(("a", "b")))
def test_readers_decide_conditions(condition: ir.Accept) -> None:
    read = reader(condition)
    for word in WORDS:
        state = read.first
        for symbol in word:
            state = read.step(state, symbol)
        assert read.accepts(state) == brute_force_grammar.satisfies(condition, word)


def _after(read: Reader, word: Iterable[str]) -> State:
    state = read.first
    for symbol in word:
        state = read.step(state, symbol)
    return state


def check_settled(read: Reader) -> None:
    """What is settled of a word is so of all that it begins."""
    for word in WORDS:
        settled = read.settled(_after(read, word))
        if settled is not None:
            longer = [w for w in WORDS if w[: len(word)] == word]
            assert all(read.accepts(_after(read, w)) is settled for w in longer), word


@settings(deadline=None, max_examples=examples(60, 300))
@given(accepts(("a", "b")))
def test_what_is_settled(condition: ir.Accept) -> None:
    check_settled(reader(condition))


def test_what_is_settled_of_lists_and_weights() -> None:
    weights = {"a": Fraction(1, 3), "b": Fraction(0)}
    readers = [
        listed([("a",), ("a", "b", "a")]),
        within(["a"], 2),
        weighing(weights, Fraction(1), strict=True),
        weighing(weights, Fraction(2, 3), strict=False),
        weighing(weights, Fraction(0), strict=True),
    ]
    for read in readers:
        check_settled(read)
        assert any(read.settled(_after(read, word)) is False for word in WORDS)


def test_words_that_no_condition_can_accept_any_more_cost_nothing() -> None:
    """Sums of ten weights have millions of values; those of words that are asked for have few."""
    symbols = tuple("abcdefghij")
    made = grammar("N -> " + " | ".join([*symbols, *(f"N {x}" for x in symbols)]), symbols)
    weights = {symbol: Fraction(1, n + 11) for n, symbol in enumerate(symbols)}
    few = ir.Matches(ir.RSequence((ir.RSymbol("a"), ir.RRepeat(ir.RSymbol("b"), "*"))))
    asked = [reader(few), weighing(weights, Fraction(3), strict=True)]
    for covered, left in [(ir.StartsWith(("a",)), False), (ir.Count("b", "<=", 30), True)]:
        stage = partial(word_left, made, asked, [reader(covered)])
        assert asked_by(stage, 5000)[1] is left


@pytest.mark.parametrize("name", TRAPS)
@pytest.mark.parametrize("bound", [1, 3, 5])
def test_a_word_is_left(name: str, bound: int) -> None:
    made = grammar(TRAPS[name], ALPHABET)
    words = brute_force_grammar.words_of(made, bound)
    asked = [within(ALPHABET, bound)]
    assert not word_left(made, asked, [listed(words)])
    for word in words:
        assert word_left(made, asked, [listed(words - {word})])


@pytest.mark.parametrize("name", TRAPS)
@pytest.mark.parametrize(
    "condition", [ir.Count("a", "<=", 1), ir.Contains(("b",)), ir.StartsWith(("a", "a"))]
)
def test_conditions_cover(name: str, condition: ir.Accept) -> None:
    made = grammar(TRAPS[name], ALPHABET)
    bound = ir.Count(None, "<=", 6)
    left = any(
        not brute_force_grammar.satisfies(condition, word)
        for word in brute_force_grammar.words_of(made, 6)
    )
    assert word_left(made, [reader(bound)], [reader(condition)]) == left


def test_an_infinite_language_is_covered() -> None:
    made = grammar("N -> a | N b | N c", ALPHABET)
    few = ir.Count("a", "<=", 1)
    assert not word_left(made, [], [reader(few)])
    assert word_left(made, [], [reader(ir.Count("b", "<=", 100))])


def test_no_word_automaton_of_the_compiler_is_used() -> None:
    tree = ast.parse(inspect.getsource(word_coverage))
    modules = {node.module for node in ast.walk(tree) if isinstance(node, ast.ImportFrom)}
    assert not any(str(name).startswith(("compiler.words", "solvers")) for name in modules)
