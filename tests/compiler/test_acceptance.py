from __future__ import annotations

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.words.acceptance import accept_dfa, at_most
from compiler.words.finite_automaton import AutomatonTooLargeError, Dfa
from grammar_lang import ir
from tests.oracles.brute_force_grammar import all_words, satisfies
from tests.oracles.grammars import ARM_ACCEPT, ARM_TERMINALS, accepts
from tests.oracles.some_cases import examples

AB = ("a", "b")
ABC = ("a", "b", "c")


@settings(deadline=None, max_examples=examples(105, 300))
@given(accepts(AB))
def test_automaton_decides_the_condition(condition: ir.Accept) -> None:
    dfa = accept_dfa(condition, AB)
    for word in all_words(AB, 7):
        assert dfa.accepts(word) == satisfies(condition, word), word


@settings(deadline=None, max_examples=examples(75, 150))
@given(accepts(AB))
def test_automaton_is_minimal_complete_and_canonical(condition: ir.Accept) -> None:
    dfa = accept_dfa(condition, AB)
    assert len(dfa.table) == dfa.size * len(AB)
    # Breadth-first numbering: a new state is the least number not met so far.
    met = 1
    for target in dfa.table:
        assert target <= met
        met = max(met, target + 1)
    assert met == dfa.size
    # No two states are equivalent (table filling, Hopcroft, Motwani, Ullman, 4.4).
    distinct = {
        (p, q) for p in range(dfa.size) for q in range(p) if dfa.accepting[p] != dfa.accepting[q]
    }
    while True:
        more = {
            (p, q)
            for p in range(dfa.size)
            for q in range(p)
            if any(
                (max(x, y), min(x, y)) in distinct
                for x, y in ((dfa.step(p, a), dfa.step(q, a)) for a in range(2))
            )
        }
        if more <= distinct:
            break
        distinct |= more
    assert len(distinct) == dfa.size * (dfa.size - 1) // 2


@settings(deadline=None, max_examples=examples(50, 100))
@given(accepts(AB), accepts(AB))
def test_boolean_laws_give_equal_automata(one: ir.Accept, two: ir.Accept) -> None:
    both = accept_dfa(ir.AllOf((one, two)), AB)
    assert both == accept_dfa(ir.AllOf((two, one)), AB)
    neither = ir.AnyOf((ir.NotAccept(one), ir.NotAccept(two)))
    assert both == accept_dfa(ir.NotAccept(neither), AB)


def test_known_sizes() -> None:
    def size(condition: ir.Accept) -> int:
        return accept_dfa(condition, ABC).size

    assert size(ir.AllOf(())) == 1
    assert size(ir.AnyOf(())) == 1
    assert size(ir.Contains(("a", "b", "a"))) == 4
    assert size(ir.EndsWith(("a", "b", "a"))) == 4
    assert size(ir.StartsWith(("a", "b", "a"))) == 5
    assert size(ir.Count(None, "<=", 5)) == 7
    assert size(ir.Count("a", "==", 5)) == 7
    assert size(ir.Count("a", ">=", 5)) == 6
    assert accept_dfa(ARM_ACCEPT, ARM_TERMINALS).size == 6


def test_length_counts_edges_too() -> None:
    dfa = accept_dfa(ir.Count(None, "<=", 3), ARM_TERMINALS)
    assert dfa.accepts(("B", "eps", "JO"))
    assert not dfa.accepts(("B", "eps", "JO", "eps"))


def test_at_most_counts_symbols_together() -> None:
    dfa = at_most(ABC, frozenset("ac"), 2)
    for word in all_words(ABC, 5):
        assert dfa.accepts(word) == (sum(s in "ac" for s in word) <= 2)


def test_unknown_symbols() -> None:
    with pytest.raises(ValueError, match="'X' is not a module or edge"):
        accept_dfa(ir.Contains(("X",)), AB)
    assert not accept_dfa(ir.AllOf(()), AB).accepts(("X",))
    assert accept_dfa(ir.AllOf(()), AB).run(("a", "X")) is None


def test_live_states() -> None:
    dfa = accept_dfa(ir.Count("a", "<=", 1), AB)
    assert dfa.live() == (True, True, False)


@given(st.integers(50, 400))
@settings(deadline=None, max_examples=5)
def test_deep_conditions_need_no_recursion(depth: int) -> None:
    condition: ir.Accept = ir.Contains(("a",))
    regex: ir.Regex = ir.RSymbol("a")
    for _ in range(20 * depth):
        condition = ir.NotAccept(condition)
        regex = ir.RSequence((regex,))
    assert accept_dfa(condition, AB) == accept_dfa(ir.Contains(("a",)), AB)
    assert accept_dfa(ir.Matches(regex), AB).size == 3


def test_long_words_and_bounds() -> None:
    word = ("a", "b") * 1000
    dfa = accept_dfa(ir.Contains(word), AB)
    assert dfa.size == 2001
    assert dfa.accepts(("b", *word, "b"))
    assert accept_dfa(ir.Count(None, "<=", 3000), AB).size == 3002
    with pytest.raises(AutomatonTooLargeError, match="states"):
        accept_dfa(ir.Count(None, "<=", 10**9), AB)


def test_exponential_expressions_are_refused() -> None:
    # The n-th symbol from the end is a: 2^n states.
    either = ir.RChoice((ir.RSymbol("a"), ir.RSymbol("b")))
    regex = ir.RSequence((ir.RRepeat(either, "*"), ir.RSymbol("a"), *(either,) * 30))
    with pytest.raises(AutomatonTooLargeError):
        accept_dfa(ir.Matches(regex), AB)


def test_different_alphabets_do_not_mix() -> None:
    from compiler.words.finite_automaton import union

    with pytest.raises(ValueError, match="different alphabets"):
        union(Dfa(AB, (0, 0), (True,)), Dfa(ABC, (0, 0, 0), (True,)))
