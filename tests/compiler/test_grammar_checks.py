from __future__ import annotations

import time

import pytest

from compiler.grammar_checks import ambiguity_witness, grammar_diagnostics
from compiler.language import language
from grammar_lang import ir
from grammar_lang.codes import Code
from grammar_lang.diagnostics import Diagnostic, Severity, Sink
from grammar_lang.source import Span
from tests.oracles.grammars import ALPHABET, ARM_TERMINALS, EVERY, TRAPS, arm, grammar

ROLES: dict[str, ir.Role] = {"B": "base", "JO": "joint", "L": "link", "EN": "effector"}


def program(*grammars: ir.Grammar, terminals: tuple[str, ...] = ARM_TERMINALS) -> ir.Program:
    modules = {
        name: ir.Module(name, ROLES.get(name, "link"), (), (), Span(i, i + 1))
        for i, name in enumerate(terminals)
        if name != "eps"
    }
    return ir.Program(modules, terminals, {g.name: g for g in grammars}, {}, {}, ())


def findings(*grammars: ir.Grammar, terminals: tuple[str, ...] = ARM_TERMINALS) -> list[Diagnostic]:
    sink = Sink()
    grammar_diagnostics(program(*grammars, terminals=terminals), sink)
    assert all(d.hint for d in sink.found)
    assert all("\n" not in d.message and not d.message.endswith(".") for d in sink.found)
    return sink.found


def codes(*grammars: ir.Grammar, terminals: tuple[str, ...] = ARM_TERMINALS) -> list[Code]:
    return [d.code for d in findings(*grammars, terminals=terminals)]


def test_the_running_example_is_clean_and_fast() -> None:
    findings(arm())
    started = time.process_time()
    assert findings(arm()) == []
    assert time.process_time() - started < 0.05


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("N -> B eps JO eps L eps EN | M\nM -> N M", [Code.UNPRODUCTIVE]),
        ("N -> B eps JO eps L eps EN\nM -> L", [Code.UNREACHABLE]),
        ("N -> B eps L eps EN", [Code.UNUSED_SYMBOL]),
        ("N -> B JO L EN", [Code.UNUSED_SYMBOL]),
        ("N -> N eps JO B L EN", [Code.UNPRODUCTIVE, Code.EMPTY_LANGUAGE]),
        ("N -> B eps JO eps L eps EN | M\nM -> N", [Code.CYCLIC_GRAMMAR, Code.CYCLIC_GRAMMAR]),
        ("N -> B eps JO eps L | N eps L | M EN\nM -> M eps", [Code.UNPRODUCTIVE, Code.NO_EFFECTOR]),
        ("N -> N eps N | B | JO | L | EN", [Code.AMBIGUOUS_GRAMMAR]),
    ],
)
def test_each_finding(text: str, expected: list[Code]) -> None:
    assert codes(grammar(text, ARM_TERMINALS)) == expected


def test_severities_and_places() -> None:
    g = grammar("N -> B eps JO eps L eps EN | M\nM -> N M", ARM_TERMINALS)
    productions = tuple(
        ir.Production(p.label, p.left, p.right, Span(100 + i, 101 + i))
        for i, p in enumerate(g.productions)
    )
    placed = ir.Grammar("G", g.start, g.nonterminals, productions, EVERY, None, Span(90, 200))
    (finding,) = findings(placed)
    assert finding.severity is Severity.WARNING
    assert finding.span == Span(102, 103)
    (unused,) = findings(grammar("N -> B eps L eps EN", ARM_TERMINALS))
    assert unused.span == Span(1, 2)
    assert unused.message == "module JO is used in no production"


def test_an_accept_condition_may_leave_nothing() -> None:
    (finding,) = findings(arm(ir.StartsWith(("JO",))))
    assert finding.code is Code.EMPTY_LANGUAGE
    assert finding.severity is Severity.ERROR
    assert finding.hint is not None
    assert "`B`" in finding.hint


def test_the_empty_word_is_no_robot() -> None:
    (finding,) = findings(
        grammar("S -> empty | S B JO L EN eps", ARM_TERMINALS, ir.Count(None, "<", 5))
    )
    assert finding.code is Code.EMPTY_LANGUAGE


def test_accepted_words_without_effector() -> None:
    assert codes(arm(ir.NotAccept(ir.Contains(("EN",))))) == [Code.NO_EFFECTOR]


def test_too_large_conditions_are_not_supported() -> None:
    assert codes(arm(ir.Count("JO", "<=", 10**7))) == [Code.NOT_SUPPORTED]


def test_a_library_of_modules_is_not_unused() -> None:
    assert findings() == []


def test_a_symbol_used_by_one_grammar_is_used() -> None:
    one = grammar("N -> B eps JO", ARM_TERMINALS, name="One")
    two = grammar("N -> B eps L eps EN", ARM_TERMINALS, name="Two")
    assert codes(one, two) == [Code.NO_EFFECTOR]


def test_ambiguity_witness() -> None:
    witness = ambiguity_witness(
        language(grammar(TRAPS["ambiguous"], ALPHABET), ALPHABET, frozenset("a"))
    )
    assert witness is not None
    assert witness[0].word == witness[1].word == ("a", "b", "a", "b", "a")
    assert witness[0].labels != witness[1].labels
    for name in ("left linear", "right linear", "odd palindromes", "counted", "not LALR"):
        lang = language(grammar(TRAPS[name], ALPHABET), ALPHABET, frozenset(ALPHABET))
        assert ambiguity_witness(lang) is None or name == "right linear"


def test_the_witness_is_told() -> None:
    (finding,) = findings(grammar("N -> N eps N | B | JO | L | EN", ARM_TERMINALS))
    assert "`B eps B eps B`" in finding.message
