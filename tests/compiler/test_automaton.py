from __future__ import annotations

from itertools import islice

import pytest
from hypothesis import assume, given, settings

from compiler.words.acceptance import accept_dfa
from compiler.words.grammar import cyclic, linearity, srg, trimmed
from compiler.words.language import language
from compiler.words.pushdown_automaton import (
    Configuration,
    Pda,
    Transition,
    accepting_run,
    accepts,
    configurations,
    run_along,
    sra,
)
from compiler.words.regular_automaton import linear_automaton
from compiler.words.structures import derivations_of
from grammar_lang import ir
from tests.oracles.brute_force_grammar import all_words, satisfies, words_of
from tests.oracles.grammars import (
    ALPHABET,
    ARM_ACCEPT,
    ARM_MODULES,
    ARM_TERMINALS,
    TRAPS,
    arm,
    grammar,
    random_grammars,
)
from tests.oracles.some_cases import examples

AB = ("a", "b")


def check_run(pda: Pda, word: tuple[str, ...]) -> list[Configuration]:
    """Every step of the run obeys the definition; it begins and ends where it must."""
    run = accepting_run(pda, word)
    assert run is not None
    assert all(transition in pda.transitions for transition in run)
    steps = list(configurations(pda, word, run))
    assert steps[0].remaining == word
    assert steps[0].state == pda.states[pda.initial]
    assert steps[-1] == Configuration(pda.states[pda.final], (), ())
    return steps


@settings(deadline=None, max_examples=examples(35, 80))
@given(random_grammars())
def test_runs_of_all_accepted_words(g: ir.Grammar) -> None:
    pda = sra(srg(g, AB, frozenset()), accept_dfa(g.accept, AB))
    members = {w for w in words_of(g, 5) if satisfies(g.accept, w)}
    for word in all_words(AB, 5):
        if word in members:
            check_run(pda, word)
        else:
            assert accepting_run(pda, word) is None


@pytest.mark.parametrize("name", TRAPS)
def test_runs_of_the_traps(name: str) -> None:
    lang = language(grammar(TRAPS[name], ALPHABET), ALPHABET, frozenset())
    pda = sra(lang.srg, lang.accept)
    for word in islice(lang.words(), 25):
        check_run(pda, word)


def test_a_run_is_a_leftmost_derivation() -> None:
    lang = language(arm(), ARM_TERMINALS, ARM_MODULES)
    pda = sra(lang.srg, lang.accept)
    word = ("B", "eps", "JO", "eps", "EN")
    run = accepting_run(pda, word)
    assert run is not None
    assert [t.label for t in run if t.label] == ["p3", "p1", "p0"]
    steps = check_run(pda, word)
    assert steps[0] == Configuration("q0", word, ("N", "$"))
    assert steps[1] == Configuration("q0", word, ("N", "eps", "EN", "$"))
    assert steps[2] == Configuration("q0", word, ("N", "eps", "JO", "eps", "EN", "$"))
    assert [t.read for t in run if t.read is not None] == [0, 4, 1, 4, 3]


def test_configurations_refuse_what_does_not_apply() -> None:
    lang = language(arm(), ARM_TERMINALS, ARM_MODULES)
    pda = sra(lang.srg, lang.accept)
    run = accepting_run(pda, ("B", "eps", "JO", "eps", "EN"))
    assert run is not None
    with pytest.raises(ValueError, match="does not apply"):
        list(configurations(pda, ("B", "eps", "L", "eps", "EN"), run))
    with pytest.raises(ValueError, match="does not apply"):
        list(configurations(pda, ("B", "eps", "JO", "eps", "EN"), run[1:]))


def test_acceptance_is_by_final_state_only() -> None:
    # An emptied stack in another state is no acceptance, nor the final state with input left.
    pda = Pda(
        ("a",),
        ("a", "$"),
        ("p", "q", "f"),
        (
            Transition(0, 0, 1, (), 1),
            Transition(0, None, 1, (1, 1), 0),
            Transition(0, None, 1, (), 2),
        ),
        0,
        (1,),
        2,
    )
    assert accepts(pda, ())
    assert not accepts(pda, ("a",))
    assert not accepts(pda, ("a", "a"))


def test_a_general_pushdown_automaton() -> None:
    # a^n b^n c by states rather than by a grammar, with an empty cycle on the stack.
    push, match, done = 0, 1, 2
    pda = Pda(
        ALPHABET,
        ("a", "b", "c", "A", "$"),
        ("push", "match", "done"),
        (
            Transition(push, 0, 4, (3, 4), push),
            Transition(push, 0, 3, (3, 3), push),
            Transition(push, None, 3, (3,), push),
            Transition(push, 1, 3, (), match),
            Transition(match, 1, 3, (), match),
            Transition(push, 2, 4, (), done),
            Transition(match, 2, 4, (), done),
        ),
        push,
        (4,),
        done,
    )
    for word in all_words(ALPHABET, 7):
        n = word.count("a")
        expected = word == ("a",) * n + ("b",) * n + ("c",)
        assert accepts(pda, word) == expected
        if expected:
            check_run(pda, word)


@pytest.mark.parametrize(
    ("text", "word"),
    [
        ("N -> a | N b", ("a", *("b",) * 4999)),
        ("N -> b N | a", (*("b",) * 4999, "a")),
        ("S -> a S b | c", (*("a",) * 2500, "c", *("b",) * 2500)),
    ],
)
def test_runs_of_long_words(text: str, word: tuple[str, ...]) -> None:
    lang = language(grammar(text, ALPHABET), ALPHABET, frozenset())
    pda = sra(lang.srg, lang.accept)
    run = accepting_run(pda, word)
    assert run is not None
    last = None
    for last in configurations(pda, word, run):  # noqa: B007
        pass
    assert last == Configuration("f", (), ())


def test_highly_ambiguous_words_take_polynomial_time() -> None:
    lang = language(grammar("S -> S S S | S S | a | empty", ALPHABET), ALPHABET, frozenset())
    pda = sra(lang.srg, lang.accept)
    check_run(pda, ("a",) * 60)
    assert not accepts(pda, (*("a",) * 60, "b"))


@settings(deadline=None, max_examples=examples(40, 200))
@given(random_grammars())
def test_linear_grammars_have_a_finite_automaton(g: ir.Grammar) -> None:
    rules = srg(g, AB, frozenset())
    accept = accept_dfa(g.accept, AB)
    dfa = linear_automaton(rules, accept)
    assert (dfa is None) == (linearity(trimmed(rules.cfg)) is None)
    assume(dfa is not None)
    assert dfa is not None
    members = words_of(g, 7)
    for word in all_words(AB, 7):
        assert dfa.accepts(word) == (word in members and satisfies(g.accept, word))


def test_finite_automaton_of_the_running_example() -> None:
    rules = srg(arm(), ARM_TERMINALS, ARM_MODULES)
    accept = accept_dfa(ARM_ACCEPT, ARM_TERMINALS)
    dfa = linear_automaton(rules, accept)
    assert dfa is not None
    # By hand: nothing, B, B eps, an arm without tool, that and eps, an arm with tool,
    # that and eps, and the dead state.
    assert dfa.size == 8
    assert dfa.accepts(("B", "eps", "JO", "eps", "EN", "eps", "L"))
    assert not dfa.accepts(("B", "eps", "JO", "eps", "EN", "eps"))
    tree = srg(grammar("T -> a T T | b", ALPHABET), ALPHABET, frozenset())
    assert linear_automaton(tree, accept_dfa(ir.AllOf(()), ALPHABET)) is None


@settings(deadline=None, max_examples=examples(30, 60))
@given(random_grammars())
def test_runs_along_derivations(g: ir.Grammar) -> None:
    lang = language(g, AB, frozenset(AB))
    assume(not cyclic(trimmed(lang.srg.cfg)))
    pda = sra(lang.srg, lang.accept)
    for word in islice(lang.words(max_length=5), 10):
        for derivation in islice(derivations_of(lang, word), 4):
            run = run_along(pda, derivation.labels)
            assert [step.label for step in run if step.label] == list(derivation.labels)
            steps = list(configurations(pda, word, run))
            assert steps[-1] == Configuration(pda.states[pda.final], (), ())
    with pytest.raises(ValueError, match="no run"):
        run_along(pda, ("no such label",))
