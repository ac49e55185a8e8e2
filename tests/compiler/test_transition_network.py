from __future__ import annotations

from collections import Counter

import pytest
from hypothesis import given, settings

from compiler.words.grammar import cyclic, srg, trimmed
from compiler.words.regular_automaton import WORK_LIMIT, Network, transition_network
from grammar_lang import ir
from tests.oracles.brute_force_grammar import derivations, words_of
from tests.oracles.grammars import ALPHABET, TRAPS, grammar, random_grammars
from tests.oracles.some_cases import examples

LENGTH = 4


def network_of(text: str) -> Network | None:
    return transition_network(trimmed(srg(grammar(text, ALPHABET), ALPHABET, ALPHABET).cfg))


def paths(network: Network, length: int) -> Counter[tuple[int, ...]]:
    """The number of paths from the first state to the last per word of limited length."""
    found: Counter[tuple[int, ...]] = Counter()
    todo: list[tuple[int, tuple[int, ...]]] = [(0, ())]
    while todo:
        state, word = todo.pop()
        found[word] += state == 1
        for symbol, target in network.moves[state]:
            longer = word if symbol is None else (*word, symbol)
            if len(longer) <= length:
                todo.append((target, longer))
    return +found


@settings(max_examples=examples(35, 120), deadline=None)
@given(random_grammars())
def test_paths_are_derivations(g: ir.Grammar) -> None:
    rules = srg(g, ("a", "b"), "ab")
    cfg = trimmed(rules.cfg)
    network = None if cyclic(cfg) else transition_network(cfg)
    if network is None:
        return
    found = paths(network, LENGTH)
    if sum(found.values()) >= 300:
        return
    assert {rules.decode(word) for word in found} == words_of(g, LENGTH)
    for word, number in found.items():
        assert number == sum(1 for _ in derivations(g, rules.decode(word)))


@pytest.mark.parametrize(
    "name", ["odd palindromes", "counted", "branching", "hidden left recursion"]
)
def test_self_embedding_has_no_network(name: str) -> None:
    assert network_of(TRAPS[name]) is None


def test_recursion_at_both_ends_has_none() -> None:
    assert network_of("S -> a S | S b | c") is None
    assert network_of("S -> a T | c\nT -> S b") is None
    assert network_of("S -> S b T | c\nT -> a T | c") is not None


def test_unfolding_is_bounded() -> None:
    def doubling(depth: int) -> str:
        return "\n".join(f"A{i} -> A{i + 1} a A{i + 1}" for i in range(depth)) + f"\nA{depth} -> b"

    assert network_of(doubling(5)) is not None
    assert WORK_LIMIT < 2**20
    assert network_of(doubling(20)) is None
