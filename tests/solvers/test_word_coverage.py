"""The verifier's test that no word is left, against the definition, word by word."""

from __future__ import annotations

import ast
import inspect
from itertools import product

import pytest
from hypothesis import given, settings

from grammar_lang import ir
from solvers.verifier.refutations import word_coverage
from solvers.verifier.refutations.word_coverage import listed, reader, within, word_left
from tests.oracles import brute_force_grammar
from tests.oracles.grammars import ALPHABET, TRAPS, accepts, grammar
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
