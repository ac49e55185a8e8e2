"""The graph of derivations against brute force: the same derivations of the same words."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

import pytest

from compiler.lemmas.conditioned_derivations import (
    ConditionedDerivations,
    Node,
    TooManyDerivations,
    conditioned_derivations,
)
from compiler.words.acceptance import accept_dfa
from compiler.words.grammar import Srg, srg
from grammar_lang import ir
from tests.oracles import brute_force_grammar
from tests.oracles.grammars import ALPHABET, TRAPS, grammar

MOST = 6
CONDITIONS = [
    ir.Count("a", "<=", 2),
    ir.Count("b", "==", 1),
    ir.AllOf((ir.Contains(("a", "b")), ir.Count(None, "<=", 5))),
    ir.NotAccept(ir.EndsWith(("c",))),
]


def derivations(
    graph: ConditionedDerivations, rules: Srg, most: int
) -> Iterator[tuple[tuple[str, ...], tuple[str, ...]]]:
    """Word and labels of all derivations in a graph of words of at most so many symbols."""
    by_node: dict[Node, list[int]] = {}
    for number, application in enumerate(graph.applications):
        by_node.setdefault(application.node, []).append(number)
    found: dict[Node, set[tuple[tuple[str, ...], tuple[str, ...]]]] = {n: set() for n in by_node}
    while True:
        size = sum(map(len, found.values()))
        for application in graph.applications:
            production = rules.productions[application.rule]
            children = dict(application.children)
            parts = [
                found[children[i]] if i in children else {((symbol.name,), ())}
                for i, symbol in enumerate(production.right)
            ]
            for chosen in product(*parts):
                word = tuple(x for part, _ in chosen for x in part)
                labels = (production.label, *(x for _, part in chosen for x in part))
                if len(word) <= most:
                    found[application.node].add((word, labels))
        if sum(map(len, found.values())) == size:
            break
    for root in graph.roots:
        yield from found.get(root, ())


@pytest.mark.parametrize("name", [n for n in TRAPS if "cycle" not in n and "self" not in n])
@pytest.mark.parametrize("condition", CONDITIONS)
def test_the_same_derivations(name: str, condition: ir.Accept) -> None:
    text = TRAPS[name]
    made = grammar(text, ALPHABET)
    rules = srg(made, ALPHABET, frozenset(ALPHABET))
    graph = conditioned_derivations(rules.cfg, accept_dfa(condition, ALPHABET))
    expected = {
        (word, labels)
        for word in brute_force_grammar.words_of(made, MOST)
        if brute_force_grammar.satisfies(condition, word)
        for labels in brute_force_grammar.derivations(made, word)
    }
    assert set(derivations(graph, rules, MOST)) == expected


def test_cycles_are_in_the_graph() -> None:
    made = grammar("A -> A | B | a\nB -> A | b", ALPHABET)
    rules = srg(made, ALPHABET, frozenset(ALPHABET))
    graph = conditioned_derivations(rules.cfg, accept_dfa(ir.Count("a", "==", 1), ALPHABET))
    used = {rules.productions[a.rule].label for a in graph.applications}
    assert used == {"p0", "p1", "p2", "p3"}


def test_a_graph_that_is_too_large() -> None:
    made = grammar("E -> E E | a", ALPHABET)
    rules = srg(made, ALPHABET, frozenset(ALPHABET))
    with pytest.raises(TooManyDerivations):
        conditioned_derivations(rules.cfg, accept_dfa(ir.Count("a", "==", 120), ALPHABET))
