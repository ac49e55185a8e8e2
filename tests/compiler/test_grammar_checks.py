from __future__ import annotations

import time
from dataclasses import replace

import pytest

from compiler.checks.grammar_checks import cycle_diagnostics, grammar_diagnostics
from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code, Diagnostic, Severity, Sink
from grammar_lang.source import Span
from tests.oracles.grammars import ARM_TERMINALS, EVERY, arm, grammar

ROLES: dict[str, ir.Role] = {"B": "base", "JO": "joint", "L": "link", "EN": "effector"}


def program(*grammars: ir.Grammar, terminals: tuple[str, ...] = ARM_TERMINALS) -> ir.Program:
    modules = {
        name: ir.Module(name, ROLES.get(name, "link"), (), (), Span(i, i + 1))
        for i, name in enumerate(terminals)
        if name != "eps"
    }
    spans = {name: Span(i, i + 1) for i, name in enumerate(terminals)}
    return ir.Program(modules, terminals, {g.name: g for g in grammars}, {}, {}, (), spans)


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
        ("N -> B eps JO eps L eps EN | N eps L | M\nM -> N M", [Code.UNPRODUCTIVE]),
        ("N -> B eps JO eps L eps EN | N eps L\nM -> L", [Code.UNREACHABLE]),
        ("N -> B eps L eps EN | N eps L", [Code.UNUSED_SYMBOL]),
        ("N -> B JO L EN | N L", [Code.UNUSED_SYMBOL]),
        ("N -> B eps JO eps L eps EN", [Code.FINITE_LANGUAGE]),
        ("N -> N eps JO B L EN", [Code.UNPRODUCTIVE, Code.EMPTY_LANGUAGE]),
        ("N -> B eps JO eps L eps EN | N eps L | M\nM -> N", [Code.CYCLIC_GRAMMAR]),
        ("N -> B eps JO eps L | N eps L | M EN\nM -> M eps", [Code.UNPRODUCTIVE, Code.NO_EFFECTOR]),
        ("N -> N eps N | B | JO | L | EN", [Code.AMBIGUOUS_GRAMMAR]),
    ],
)
def test_each_finding(text: str, expected: list[Code]) -> None:
    assert codes(grammar(text, ARM_TERMINALS)) == expected


def test_severities_and_places() -> None:
    g = grammar("N -> B eps JO eps L eps EN | M | N eps L\nM -> N M", ARM_TERMINALS)
    productions = tuple(
        ir.Production(p.label, p.left, p.right, Span(100 + i, 101 + i))
        for i, p in enumerate(g.productions)
    )
    placed = ir.Grammar("G", g.start, g.nonterminals, productions, EVERY, None, Span(90, 200))
    (finding,) = findings(placed)
    assert finding.severity is Severity.WARNING
    assert finding.span == Span(103, 104)
    (unused,) = findings(grammar("N -> B eps L eps EN | N eps L", ARM_TERMINALS))
    assert unused.span == Span(1, 2)
    assert unused.message == "module `JO` is used in no production"


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
    assert codes(one, two) == [Code.NO_EFFECTOR, Code.FINITE_LANGUAGE, Code.FINITE_LANGUAGE]


def test_the_witness_is_told() -> None:
    (finding,) = findings(grammar("N -> N eps N | B | JO | L | EN", ARM_TERMINALS))
    assert "`B eps B eps B`" in finding.message


def at_productions(g: ir.Grammar) -> ir.Grammar:
    """Production i stands at 100 + i."""
    productions = tuple(
        ir.Production(p.label, p.left, p.right, Span(100 + i, 101 + i))
        for i, p in enumerate(g.productions)
    )
    return ir.Grammar(g.name, g.start, g.nonterminals, productions, g.accept, None, Span(90, 99))


def test_an_unused_edge_has_its_place() -> None:
    (unused,) = findings(grammar("N -> B JO L EN | N L", ARM_TERMINALS))
    assert unused.message == "edge `eps` is used in no production"
    assert unused.span == Span(4, 5)


def test_a_cycle_is_printed_and_its_productions_are_shown() -> None:
    g = grammar("N -> B JO L EN eps | N eps L | M | K\nM -> L | K\nK -> N", ARM_TERMINALS)
    (finding,) = findings(at_productions(g))
    assert finding.code is Code.CYCLIC_GRAMMAR
    assert finding.message.endswith(": `N -> M -> K -> N`")
    assert finding.span == Span(102, 103)
    assert finding.notes == (
        (Span(105, 106), "`M -> K` by this production"),
        (Span(106, 107), "`K -> N` by this production"),
    )
    assert finding.hint is not None
    assert "`p2`, `p5`, `p6`" in finding.hint
    assert [d.message for d in cycles_of(g)] == [finding.message]
    assert cycles_of(arm()) == []


def cycles_of(g: ir.Grammar) -> list[Diagnostic]:
    sink = Sink()
    cycle_diagnostics(program(g), g, sink)
    return sink.found


def test_a_cycle_beside_an_empty_symbol() -> None:
    g = grammar("N -> B JO L EN eps | N M | N L\nM -> eps | empty", ARM_TERMINALS)
    (finding,) = findings(at_productions(g))
    assert finding.span == Span(101, 102)
    assert finding.hint is not None
    assert "let `M` not derive the empty word" in finding.hint


@pytest.mark.parametrize(
    ("text", "accept", "message"),
    [
        ("N -> B eps JO eps L eps EN", EVERY, "1 word, of 7 symbols"),
        ("N -> B JO L eps EN X | EN\nX -> B | L L | empty", EVERY, "4 words, of 7 symbols at most"),
        ("N -> B | JO | L | EN | eps", EVERY, "5 words, of 1 symbol at most"),
        (
            "N -> N B | N JO | N L | N EN | N eps | empty",
            ir.Count(None, "<=", 3),
            f"{5 + 25 + 125} words, of 3 symbols at most",
        ),
        (
            "N -> N B | N JO | N L | N EN | N eps | empty",
            ir.Count(None, "<=", 20),
            "over 10^13 words, of 20 symbols at most",  # 5^20 + ... + 5 = 1.19 * 10^14
        ),
    ],
)
def test_a_finite_language_is_counted(text: str, accept: ir.Accept, message: str) -> None:
    (finding,) = findings(grammar(text, ARM_TERMINALS, accept))
    assert finding.code is Code.FINITE_LANGUAGE
    assert finding.severity is Severity.NOTE
    assert finding.message == f"grammar `G` has {message}"


def test_an_ambiguous_finite_language_counts_words() -> None:
    text = "N -> N eps N | B | JO | L | EN"
    found = findings(grammar(text, ARM_TERMINALS, ir.Count(None, "<=", 5)))
    assert [d.code for d in found] == [Code.AMBIGUOUS_GRAMMAR, Code.FINITE_LANGUAGE]
    assert found[1].message == f"grammar `G` has {4 + 16 + 64} words, of 5 symbols at most"
    found = findings(grammar(text, ARM_TERMINALS, ir.Count(None, "<=", 79)))
    assert found[1].message == "grammar `G` has finitely many words, of 79 symbols at most"


def test_of_an_incomplete_program_only_what_stands() -> None:
    text = "N -> B JO | N L | K\nK -> K"
    bare = program(grammar(text, ARM_TERMINALS))

    def told(*, complete: bool, roles: dict[str, ir.Role] = ROLES) -> list[Code]:
        modules = {name: replace(m, role=roles[name]) for name, m in bare.modules.items()}
        sink = Sink()
        grammar_diagnostics(replace(bare, modules=modules), sink, complete=complete)
        return [d.code for d in sink.found]

    no_tool: dict[str, ir.Role] = {**ROLES, "EN": "link"}
    unused = [Code.UNUSED_SYMBOL, Code.UNUSED_SYMBOL]
    assert told(complete=True) == [*unused, Code.UNPRODUCTIVE, Code.NO_EFFECTOR]
    assert told(complete=False) == [Code.UNPRODUCTIVE, Code.NO_EFFECTOR]
    assert told(complete=True, roles=no_tool) == [*unused, Code.UNPRODUCTIVE, Code.NO_EFFECTOR]
    assert told(complete=False, roles=no_tool) == [Code.UNPRODUCTIVE]
    # a module that was left out may have been the effector
    partial = replace(bare, modules={n: m for n, m in bare.modules.items() if n != "JO"})
    sink = Sink()
    grammar_diagnostics(partial, sink, complete=False)
    assert [d.code for d in sink.found] == [Code.UNPRODUCTIVE]
    sink = Sink()
    grammar_diagnostics(
        program(grammar("N -> B eps JO eps L eps EN", ARM_TERMINALS)), sink, complete=False
    )
    assert sink.found == []


def test_the_time_is_linear_in_the_grammars() -> None:
    def seconds(number: int) -> float:
        terminals = tuple(f"{name}{i}" for i in range(number) for name in ("B", "L", "E"))
        modules = {
            name: ir.Module(name, "effector" if name[0] == "E" else "link", (), ())
            for name in terminals
        }
        grammars = {
            f"G{i}": grammar(
                f"N -> B{i} | N eps L{i} | N eps E{i}",
                (*terminals[3 * i : 3 * i + 3], "eps"),
                ir.AllOf((ir.Contains((f"E{i}",)), ir.StartsWith((f"B{i}",)))),
                f"G{i}",
            )
            for i in range(number)
        }
        made = ir.Program(modules, (*terminals, "eps"), grammars, {}, {}, ())
        sink = Sink()
        started = time.process_time()
        grammar_diagnostics(made, sink)
        assert sink.found == []
        return time.process_time() - started

    seconds(5)
    assert seconds(160) < 12 * seconds(40)


def test_a_product_that_is_too_large_is_not_looked_at() -> None:
    """A branching grammar with counted words has a product of cubic size: a note, in no time."""
    branching = grammar("N -> [ N ] N | B", ("B", "[", "]"), ir.Count(None, "<=", 900))
    (found,) = findings(branching, terminals=("B", "[", "]"))
    assert (found.code, found.severity) == (Code.NOT_SUPPORTED, Severity.NOTE)
    small = grammar("N -> [ N ] N | B", ("B", "[", "]"), ir.Count(None, "<=", 9))
    assert Code.NOT_SUPPORTED not in codes(small, terminals=("B", "[", "]"))
