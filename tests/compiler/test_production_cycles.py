from __future__ import annotations

from hypothesis import given, settings

from compiler.words.ambiguity import ProductionCycle, production_cycles
from compiler.words.grammar import cyclic, srg, trimmed
from grammar_lang import ir
from tests.oracles.brute_force_grammar import word_sets
from tests.oracles.grammars import ALPHABET, grammar, random_grammars
from tests.oracles.some_cases import examples


def cycles(text: str) -> list[tuple[str, str]]:
    """Per cycle its nonterminals and the labels of its productions."""
    found = production_cycles(srg(grammar(text, ALPHABET), ALPHABET, ALPHABET))
    return [(" ".join(c.nonterminals), " ".join(p.label for p in c.productions)) for c in found]


def test_unit_cycles() -> None:
    assert cycles("A -> a | B\nB -> b | A") == [("A B A", "p1 p3")]
    assert cycles("A -> a | A") == [("A A", "p1")]
    assert cycles("A -> a | B\nB -> b") == []


def test_the_shortest_through_the_first() -> None:
    text = "S -> a | A\nA -> B | C | a\nB -> C\nC -> D | A\nD -> A"
    assert cycles(text) == [("A B C A", "p2 p5 p7")]
    assert cycles("S -> A | B\nA -> A | a\nB -> C | b\nC -> B") == [
        ("A A", "p2"),
        ("B C B", "p4 p6"),
    ]


def test_beside_symbols_that_derive_the_empty_word() -> None:
    (cycle,) = production_cycles(
        srg(grammar("A -> B A C | a\nB -> empty | b\nC -> B B", ALPHABET), ALPHABET, ALPHABET)
    )
    assert cycle.nonterminals == ("A", "A")
    assert cycle.vanishing == ("B", "C")
    assert cycles("A -> A A | empty | a") == [("A A", "p0")]


def test_useless_productions_have_no_part() -> None:
    assert cycles("A -> a\nB -> B | b") == []
    assert cycles("A -> a | B\nB -> B") == []


@settings(max_examples=examples(40, 120), deadline=None)
@given(random_grammars())
def test_every_step_replaces_one_nonterminal_by_another(g: ir.Grammar) -> None:
    rules = srg(g, ("a", "b"), "ab")
    found = production_cycles(rules)
    assert bool(found) == bool(cyclic(trimmed(rules.cfg)))
    empty = {name for name, words in word_sets(g, 0).items() if () in words}
    for cycle in found:
        assert cycle.nonterminals[0] == cycle.nonterminals[-1]
        assert len(set(cycle.nonterminals)) == len(cycle.productions)
        check_steps(cycle, empty)


def check_steps(cycle: ProductionCycle, empty: set[str]) -> None:
    targets = cycle.nonterminals[1:]
    for production, left, right in zip(
        cycle.productions, cycle.nonterminals, targets, strict=False
    ):
        names = [symbol.name for symbol in production.right]
        names.remove(right)
        assert production.left == left
        assert set(names) <= empty
        assert set(names) <= set(cycle.vanishing)
