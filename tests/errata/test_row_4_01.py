"""Row 4.1: an automaton without a stack and with finitely many states, for any grammar."""

from __future__ import annotations

from compiler.words.acceptance import accept_dfa
from compiler.words.grammar import srg
from compiler.words.pushdown_automaton import accepts, sra
from compiler.words.regular_automaton import linear_automaton
from tests.oracles.brute_force_grammar import all_words, words_of
from tests.oracles.grammars import ARM_ACCEPT, ARM_MODULES, ARM_TERMINALS, EVERY, arm, grammar

AB = ("a", "b")
NESTED = grammar("S -> a S b | a b", AB)


def test_no_finite_number_of_states_does_for_nested_modules() -> None:
    """Each two of a, aa, ..., a^n are told apart by what may follow (Myhill and Nerode)."""
    words, most = words_of(NESTED, 24), 12
    endings = [("b",) * count for count in range(1, most + 1)]
    seen = {
        tuple((("a",) * count + ending) in words for ending in endings)
        for count in range(1, most + 1)
    }
    assert len(seen) == most


def test_two_states_and_a_stack_do() -> None:
    rules = srg(NESTED, AB, frozenset())
    pda = sra(rules, accept_dfa(EVERY, AB))
    assert len(pda.states) == 2
    assert pda.stack_alphabet == ("a", "b", "S", "$")
    members = words_of(NESTED, 9)
    assert len(members) == 4
    for word in all_words(AB, 9):
        assert accepts(pda, word) == (word in members)
    assert accepts(pda, ("a",) * 200 + ("b",) * 200)
    assert linear_automaton(rules, accept_dfa(EVERY, AB)) is None


def test_the_states_of_the_printed_construction_are_the_words_themselves() -> None:
    """Rule (3), q -> qz, names a state after all that was read: as many states as prefixes."""
    prefixes = {word[:size] for word in words_of(arm(EVERY), 9) for size in range(1, len(word) + 1)}
    assert len(prefixes) == sum(2 * 3**n for n in range(4)) + 3**4
    rules = srg(arm(), ARM_TERMINALS, ARM_MODULES)
    automaton = linear_automaton(rules, accept_dfa(ARM_ACCEPT, ARM_TERMINALS))
    assert automaton is not None
    assert automaton.size == 8
