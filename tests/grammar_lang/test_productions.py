from __future__ import annotations

from collections.abc import Callable

import pytest

from grammar_lang import ir
from grammar_lang.load import load_text

Check = Callable[[str], list[tuple[str, str]]]

HEAD = "module A { role base; } module B { role link; } module N1 { role link; } edge e, '[';\n"


def grammar(body: str) -> ir.Grammar:
    loaded = load_text(f"{HEAD}grammar G {{ {body} }}", "t")
    assert loaded.program is not None, loaded.diagnostics
    assert loaded.program.terminals == ("A", "B", "N1", "e", "[")
    return loaded.program.grammars["G"]


def test_any_context_free_grammar() -> None:
    found = grammar("start S; a: S -> A T '[' l:S r:S; b: S -> empty; c: U -> U; d: T -> B U;")
    assert found.start == "S"
    assert found.nonterminals == ("S", "T", "U")
    assert found.productions == (
        ir.Production(
            "a",
            "S",
            (
                ir.Symbol("A", "module"),
                ir.Symbol("T", "nonterminal"),
                ir.Symbol("[", "edge"),
                ir.Symbol("S", "nonterminal", "l"),
                ir.Symbol("S", "nonterminal", "r"),
            ),
        ),
        ir.Production("b", "S", ()),
        ir.Production("c", "U", (ir.Symbol("U", "nonterminal"),)),
        ir.Production("d", "T", (ir.Symbol("B", "module"), ir.Symbol("U", "nonterminal"))),
    )
    assert found.accept == ir.AllOf(())
    assert found.semantics is None


def accept(*conditions: str) -> ir.Accept:
    lines = " ".join(f"accept {c};" for c in conditions)
    return grammar(f"start S; a: S -> A; {lines}").accept


def test_accept_conditions() -> None:
    a, b = ir.Contains(("A",)), ir.Contains(("B",))
    assert accept("contains A or contains B and not contains A") == ir.AnyOf(
        (a, ir.AllOf((b, ir.NotAccept(a))))
    )
    assert accept("(contains A or contains B) and contains A") == ir.AllOf((ir.AnyOf((a, b)), a))
    assert accept("not not contains A") == ir.NotAccept(ir.NotAccept(a))
    assert accept("contains A", "contains B") == ir.AllOf((a, b))
    assert accept("starts with A '[' B") == ir.StartsWith(("A", "[", "B"))
    assert accept("ends with A") == ir.EndsWith(("A",))
    assert accept("length <= 4*5") == ir.Count(None, "<=", 20)
    for sign in ("<=", "<", ">=", ">", "=="):
        assert accept(f"count('[') {sign} 3") == ir.Count("[", sign, 3)


def test_regular_expressions() -> None:
    a, b = ir.RSymbol("A"), ir.RSymbol("B")
    assert accept("matches A | B A*") == ir.Matches(
        ir.RChoice((a, ir.RSequence((b, ir.RRepeat(a, "*")))))
    )
    assert accept("matches (A B)+? empty") == ir.Matches(
        ir.RSequence((ir.RRepeat(ir.RRepeat(ir.RSequence((a, b)), "+"), "?"), ir.REmpty()))
    )


@pytest.mark.parametrize(
    ("body", "found"),
    [
        ("start S; a: S -> A C;", [("UNKNOWN_NAME", "C")]),
        ("start T; a: S -> A;", [("UNKNOWN_NAME", "T")]),
        ("start S; a: S -> A; a: S -> B;", [("DUPLICATE_NAME", "a")]),
        ("a: S -> A;", [("MISSING_START", "G")]),
        ("start S; start S; a: S -> A;", [("REPEATED_CLAUSE", "start S;")]),
        ("start A; a: A -> B; b: A -> B;", [("WRONG_KIND", "A")]),
        ("start S; a: S -> A; accept contains S;", [("WRONG_KIND", "S")]),
        ("start S; a: S -> A; accept matches (C)*;", [("UNKNOWN_NAME", "C")]),
        ("start S; a: S -> A; accept count(A) <= 1/2;", [("BAD_VALUE", "1/2")]),
        ("start S; a: S -> A; accept length <= 3 m;", [("UNIT_MISMATCH", "3 m")]),
        ("start N; a: N -> N N; b: N -> A;", [("DUPLICATE_NAME", "N")]),
        ("start N; a: N -> l:N r:N; b: N -> A;", []),
        ("start S; a: S -> A:B;", [("DUPLICATE_NAME", "A")]),
        ("start S; a: S -> l:A l:B;", [("DUPLICATE_NAME", "l")]),
    ],
)
def test_findings(body: str, found: list[tuple[str, str]], check: Check) -> None:
    assert check(f"{HEAD}grammar G {{ {body} }}") == found


def test_a_hint_names_the_nearest_symbol() -> None:
    loaded = load_text("module Elbow { role joint; } grammar G { start S; a: S -> Elbwo; }", "t")
    assert [d.hint for d in loaded.diagnostics] == ["did you mean `Elbow`?"]
