from __future__ import annotations

import networkx
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.words.grammar import (
    components,
    cyclic,
    is_finite,
    linearity,
    nullable,
    on_cycle,
    productive,
    reachable,
    srg,
    trimmed,
)
from compiler.words.language import language
from grammar_lang import ir
from tests.oracles.brute_force_grammar import word_sets
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


def test_symbols_in_order_of_declaration() -> None:
    rules = srg(arm(), ARM_TERMINALS, ARM_MODULES)
    assert rules.terminals == ARM_TERMINALS
    assert rules.modules == ARM_MODULES
    assert rules.start == "N"
    assert rules.encode(("B", "eps", "EN")) == (0, 4, 3)
    assert rules.encode(("B", "N")) is None
    assert rules.decode((0, 4, 3)) == ("B", "eps", "EN")


def test_undeclared_symbols_are_refused() -> None:
    with pytest.raises(ValueError, match="undeclared module 'EN'"):
        srg(arm(), ("B", "JO", "L", "eps"), ARM_MODULES)
    lost = ir.Production("p", "S", (ir.Symbol("T", "nonterminal"),))
    with pytest.raises(ValueError, match="undeclared nonterminal 'T'"):
        srg(ir.Grammar("G", "S", ("S",), (lost,), EVERY, None), AB, frozenset())
    with pytest.raises(ValueError, match="undeclared nonterminal 'S'"):
        srg(ir.Grammar("G", "S", (), (), EVERY, None), AB, frozenset())


@settings(deadline=None, max_examples=examples(30, 150))
@given(random_grammars())
def test_symbol_sets_by_brute_force(g: ir.Grammar) -> None:
    rules = srg(g, AB, frozenset())
    sets = word_sets(g, 8)
    assert set(rules.names(nullable(rules.cfg))) == {n for n, w in sets.items() if () in w}
    # Three nonterminals, right sides of three symbols: a shortest word has at most 27 symbols,
    # so the words up to 8 can only show productivity, not refute it.
    assert {n for n, w in sets.items() if w} <= set(rules.names(productive(rules.cfg)))
    graph = networkx.DiGraph()
    graph.add_nodes_from(g.nonterminals)
    for p in g.productions:
        graph.add_edges_from((p.left, s.name) for s in p.right if s.kind == "nonterminal")
    assert set(rules.names(reachable(rules.cfg))) == {"S"} | networkx.descendants(graph, "S")


@settings(deadline=None, max_examples=examples(35, 150))
@given(random_grammars())
def test_cycles_by_definition(g: ir.Grammar) -> None:
    empty = {n for n, w in word_sets(g, 0).items() if w}
    graph = networkx.DiGraph()
    for p in g.productions:
        for i, s in enumerate(p.right):
            others = p.right[:i] + p.right[i + 1 :]
            if s.kind == "nonterminal" and all(o.name in empty for o in others):
                graph.add_edge(p.left, s.name)
    closure = networkx.transitive_closure(graph, reflexive=False)
    rules = srg(g, AB, frozenset())
    assert set(rules.names(cyclic(rules.cfg))) == {n for n in graph if closure.has_edge(n, n)}


@settings(deadline=None, max_examples=examples(30, 150))
@given(random_grammars())
def test_finiteness_two_ways(g: ir.Grammar) -> None:
    everything = ir.Grammar(g.name, g.start, g.nonterminals, g.productions, EVERY, None)
    lang = language(everything, AB, frozenset())
    assert is_finite(lang.srg.cfg) == lang.is_finite()


@settings(deadline=None)
@given(st.lists(st.tuples(st.integers(0, 6), st.integers(0, 6)), max_size=20))
def test_components_agree_with_networkx(edges: list[tuple[int, int]]) -> None:
    adjacent: list[list[int]] = [[] for _ in range(7)]
    for tail, head in edges:
        adjacent[tail].append(head)
    component = components(7, adjacent.__getitem__)
    graph = networkx.DiGraph(edges)
    graph.add_nodes_from(range(7))
    expected = {frozenset(c) for c in networkx.strongly_connected_components(graph)}
    assert {frozenset(n for n in range(7) if component[n] == c) for c in set(component)} == expected
    assert all(component[head] <= component[tail] for tail, head in edges)
    on = {n for c in expected if len(c) > 1 for n in c} | {t for t, h in edges if t == h}
    assert on_cycle(7, edges) == on


def test_components_of_a_long_chain() -> None:
    size = 20_000
    component = components(size, lambda n: (n + 1,) if n + 1 < size else ())
    assert component == tuple(range(size - 1, -1, -1))


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("N -> a | N b c", "left"),
        ("N -> a | b c N", "right"),
        ("N -> a b | c", "left"),
        ("N -> N b | b N", None),
        ("N -> N N | a", None),
        ("N -> a N b | c", None),
        ("N -> a M\nM -> N b | c", None),
        ("N -> empty", "left"),
    ],
)
def test_linearity(text: str, expected: str | None) -> None:
    assert linearity(srg(grammar(text, ALPHABET), ALPHABET, frozenset()).cfg) == expected


def test_useless_rules_go() -> None:
    cfg = srg(grammar(TRAPS["useless"], ALPHABET), ALPHABET, frozenset()).cfg
    assert [rule.right for rule in trimmed(cfg).rules] == [(0,), (3, 1)]
    assert trimmed(srg(grammar("S -> a S", ALPHABET), ALPHABET, frozenset()).cfg).rules == ()
