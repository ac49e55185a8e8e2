from __future__ import annotations

import pytest
from hypothesis import assume, given, settings

from compiler.words.acceptance import accept_dfa
from compiler.words.deterministic_pushdown import deterministic_pushdown, is_deterministic
from compiler.words.grammar import Srg, srg, useful_rules
from compiler.words.lr_automaton import (
    LrAutomaton,
    LrTooLarge,
    accepts,
    lr_automaton,
    right_parse,
)
from compiler.words.pushdown_automaton import (
    Configuration,
    Pda,
    Transition,
    accepting_run,
    configurations,
    sra,
)
from compiler.words.pushdown_automaton import accepts as some_run_accepts
from grammar_lang import ir
from tests.oracles.brute_force_grammar import all_words, satisfies, words_of
from tests.oracles.grammars import (
    ALPHABET,
    ARM_ACCEPT,
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


def automata(g: ir.Grammar, terminals: tuple[str, ...]) -> tuple[Srg, LrAutomaton, Pda] | None:
    """The grammar, its LR(1) automaton and the pushdown automaton; None where it is not LR(1)."""
    rules = srg(g, terminals, frozenset())
    automaton = lr_automaton(rules.cfg)
    if not isinstance(automaton, LrAutomaton):
        return None
    pda = deterministic_pushdown(rules, automaton, accept_dfa(g.accept, terminals))
    assert isinstance(pda, Pda)
    return rules, automaton, pda


def of(text: str, terminals: tuple[str, ...] = ALPHABET, accept: ir.Accept = EVERY) -> Pda:
    found = automata(grammar(text, terminals, accept), terminals)
    assert found is not None
    return found[2]


def only_run(pda: Pda, word: tuple[str, ...]) -> tuple[bool, int]:
    """Follow the definition step by step: whether it accepts, and the most transitions at once."""
    state, stack, position, most = pda.initial, list(reversed(pda.initial_stack)), 0, 0
    codes = [pda.alphabet.index(name) for name in word]
    by_state: dict[int, list[Transition]] = {}
    for transition in pda.transitions:
        by_state.setdefault(transition.state, []).append(transition)
    while stack:
        fitting = [
            t
            for t in by_state.get(state, [])
            if t.pop == stack[-1] and (t.read is None or codes[position : position + 1] == [t.read])
        ]
        most = max(most, len(fitting))
        if not fitting:
            break
        stack[-1:] = reversed(fitting[0].push)
        state = fitting[0].target
        position += fitting[0].read is not None
    return not stack and state == pda.final and position == len(codes), most


@settings(deadline=None, max_examples=examples(15, 40))
@given(random_grammars())
def test_agrees_with_the_other_readings(g: ir.Grammar) -> None:
    found = automata(g, AB)
    assume(found is not None)
    assert found is not None
    rules, automaton, pda = found
    stacked = sra(rules, accept_dfa(g.accept, AB))
    assert is_deterministic(pda)
    end = pda.alphabet[-1]
    members = words_of(g, 5)
    for word in all_words(AB, 5):
        expected = word in members and satisfies(g.accept, word)
        assert some_run_accepts(pda, (*word, end)) == expected
        assert only_run(pda, (*word, end)) in ((expected, 0), (expected, 1))
        assert some_run_accepts(stacked, word) == expected
        parsed = accepts(automaton, rules.encode(word) or ())
        assert (parsed and satisfies(g.accept, word)) == expected


def test_the_traps() -> None:
    deterministic = 0
    for text in TRAPS.values():
        found = automata(grammar(text, ALPHABET), ALPHABET)
        if found is None:
            continue
        deterministic += 1
        pda = found[2]
        assert is_deterministic(pda)
        members = words_of(grammar(text, ALPHABET), 6)
        for word in all_words(ALPHABET, 6):
            assert some_run_accepts(pda, (*word, "#")) == (word in members)
    assert deterministic == 8


def test_the_end_is_read_once_and_last() -> None:
    # Both a word and its proper prefix are in the language.
    pda = of("S -> S a | empty")
    for n in range(4):
        word = ("a",) * n
        assert some_run_accepts(pda, (*word, "#"))
        assert not some_run_accepts(pda, word)
        assert not some_run_accepts(pda, (*word, "#", "#"))
        assert not some_run_accepts(pda, (*word, "#", "a"))
        assert not some_run_accepts(pda, ("#", *word, "#"))


def test_the_end_marker_is_no_terminal() -> None:
    terminals = ("#", "##", "a")
    pda = of("S -> # S ## | a", terminals)
    assert pda.alphabet == (*terminals, "###")
    assert some_run_accepts(pda, ("#", "#", "a", "##", "##", "###"))
    assert not some_run_accepts(pda, ("#", "#", "a", "##", "###"))


@settings(deadline=None, max_examples=examples(15, 40))
@given(random_grammars())
def test_runs_show_the_reductions(g: ir.Grammar) -> None:
    found = automata(g, AB)
    assume(found is not None)
    assert found is not None
    rules, automaton, pda = found
    labels = [rules.productions[r].label for r in useful_rules(rules.cfg)]
    for word in words_of(g, 4):
        if not satisfies(g.accept, word):
            continue
        marked = (*word, pda.alphabet[-1])
        run = accepting_run(pda, marked)
        parse = right_parse(automaton, rules.encode(word) or ())
        assert run is not None
        assert parse is not None
        assert [t.label for t in run if t.label is not None] == [labels[r] for r in parse]
        *_, last = configurations(pda, marked, run)
        assert last == Configuration("f", (), ())


def test_the_running_example() -> None:
    found = automata(arm(), ARM_TERMINALS)
    assert found is not None
    pda = found[2]
    assert is_deterministic(pda)
    assert len(set(pda.states)) == len(pda.states) < 30
    language = words_of(arm(), 9)
    for word in language:
        assert some_run_accepts(pda, (*word, "#")) == satisfies(ARM_ACCEPT, word)
    assert ("B", "eps", "JO", "eps", "EN") in language


def test_every_control_is_met_where_the_accept_condition_excludes_nothing() -> None:
    pda = of("S -> a S b | empty", AB)
    met: set[int] = set()
    for n in range(4):
        run = accepting_run(pda, ("a",) * n + ("b",) * n + ("#",))
        assert run is not None
        met.update(*((t.state, t.target) for t in run))
    assert met == set(range(len(pda.states)))


def test_nothing_is_built_where_nothing_is_accepted() -> None:
    for accept in (ir.AnyOf(()), ir.Count(None, "<", 0)):
        pda = of("S -> a S b | empty", AB, accept)
        assert pda.transitions == ()
        assert not some_run_accepts(pda, ("#",))
    assert of("S -> a S").transitions == ()


def test_determinism_is_decided_by_state_top_and_next_symbol() -> None:
    def pda(*transitions: Transition) -> Pda:
        return Pda(AB, ("x", "y"), ("p", "q"), transitions, 0, (0,), 1)

    reading = Transition(0, 0, 0, (), 1)
    assert is_deterministic(pda())
    assert is_deterministic(pda(reading, Transition(0, 1, 0, (), 1)))
    assert is_deterministic(pda(reading, Transition(0, 0, 1, (), 1)))
    assert is_deterministic(pda(reading, Transition(1, 0, 0, (), 1)))
    assert is_deterministic(pda(reading, Transition(0, None, 1, (), 1)))
    assert not is_deterministic(pda(reading, Transition(0, 0, 0, (1,), 1)))
    assert not is_deterministic(pda(reading, Transition(0, None, 0, (), 1)))
    assert not is_deterministic(pda(Transition(0, None, 0, (), 1), reading))
    assert not is_deterministic(pda(Transition(0, None, 0, (), 1), Transition(0, None, 0, (), 0)))
    # The SRA chooses among the productions of a nonterminal.
    rules = srg(arm(), ARM_TERMINALS, ARM_MODULES)
    assert not is_deterministic(sra(rules, accept_dfa(EVERY, ARM_TERMINALS)))


def test_limits_and_mismatches() -> None:
    rules = srg(grammar("S -> a S b | empty", AB), AB, frozenset())
    automaton = lr_automaton(rules.cfg)
    assert isinstance(automaton, LrAutomaton)
    accept = accept_dfa(EVERY, AB)
    assert deterministic_pushdown(rules, automaton, accept, limit=5) == LrTooLarge(5)
    with pytest.raises(ValueError, match="different alphabets"):
        deterministic_pushdown(rules, automaton, accept_dfa(EVERY, ALPHABET))
    other = lr_automaton(srg(grammar("S -> c", ALPHABET), ALPHABET, frozenset()).cfg)
    assert isinstance(other, LrAutomaton)
    with pytest.raises(ValueError, match="not of this grammar"):
        deterministic_pushdown(rules, other, accept)


def test_a_word_of_twenty_thousand_symbols() -> None:
    terminals = ("JO", "L")
    pda = of("S -> JO S L | empty", terminals, ir.Contains(("JO", "L")))
    word = ("JO",) * 10_000 + ("L",) * 10_000
    assert some_run_accepts(pda, (*word, "#"))
    assert only_run(pda, (*word, "#")) == (True, 1)
    assert only_run(pda, (*word[1:], "#")) == (False, 1)


def test_deep_brackets() -> None:
    pda = of("T -> a | [ T T ]", ("[", "]", "a"))

    def nested(depth: int) -> tuple[str, ...]:
        return (*("[",) * depth, "a", *("a", "]") * depth)

    assert only_run(pda, (*nested(8_000), "#")) == (True, 1)
    assert only_run(pda, (*nested(8_000)[:-1], "#")) == (False, 1)
    assert some_run_accepts(pda, (*nested(1_000), "#"))
    assert not some_run_accepts(pda, (*nested(1_000)[:-1], "#"))
