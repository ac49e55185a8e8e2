"""The parser against lark itself, and what it does after errors."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import pytest
from lark import Lark, Token, Transformer_NonRecursive, UnexpectedInput
from lark.tree import Meta

from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.parsing import lalr
from grammar_lang.parsing.parse import parse
from grammar_lang.parsing.table_generator import parser, tables
from grammar_lang.parsing.tables import tables as read
from grammar_lang.parsing.tokens import cut, tokenise
from grammar_lang.parsing.tree_builder import BUILDERS
from grammar_lang.source import Source, Span
from tests.grammar_lang.conftest import PARTS

ROOT = Path(__file__).parents[2]
TEXTS = {
    **{str(p.relative_to(ROOT)): p.read_text("utf-8") for p in (ROOT / "specs").glob("*.srg")},
    **PARTS,
    **{
        f"{page.name} {n}": block
        for page in sorted((ROOT / "docs").glob("*.md"))
        for n, block in enumerate(
            re.findall(r"^```srg\n(.*?)^```", page.read_text("utf-8"), re.M | re.S)
        )
        if page.name != "codes.md"
    },
    "everything": (ROOT / "tests" / "oracles" / "everything.srg").read_text("utf-8"),
}


class Fold(Transformer_NonRecursive):
    """The builders on lark's own tree."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.text = text

    def __default__(self, data: Any, children: list[Any], meta: Meta) -> object:
        made = [self.token(c) if isinstance(c, Token) else c for c in children]
        return BUILDERS[str(data)](made, Span(meta.start_pos, meta.end_pos))

    def token(self, token: Token) -> lalr.Token:
        return lalr.Token(token.type, str(token), Span(token.start_pos or 0, token.end_pos or 0))


@pytest.fixture(scope="module")
def lark() -> Lark:
    return parser()


@pytest.mark.parametrize("name", TEXTS)
def test_values_are_those_of_lark(name: str, lark: Lark) -> None:
    text = TEXTS[name]
    sink = Sink()
    found = parse(text, sink)
    assert not sink.found
    tokens = tokenise(text)
    for raw, item in zip(cut(tokens), found.items, strict=True):
        span = tokens.span(raw.first, raw.stop - 1)
        piece = text[span.start : span.end]
        assert repr(item) == repr(Fold(piece).transform(lark.parse(piece)))
        assert item.span == span


def test_every_builder_is_a_rule_and_used() -> None:
    assert set(BUILDERS) <= {rule.builder for rule in read().rules}


def test_the_tables_are_those_of_the_grammar() -> None:
    assert (ROOT / "grammar_lang" / "parsing" / "tables.json").read_text("utf-8") == tables()


@pytest.mark.parametrize("name", TEXTS)
def test_what_lark_refuses_is_refused(name: str, lark: Lark) -> None:
    """Every item with one token left out is refused by both or by none."""
    tokens = tokenise(TEXTS[name])
    for raw in cut(tokens):
        span = tokens.span(raw.first, raw.stop - 1)
        for lost in range(raw.first, raw.stop, 7):
            gap = tokens.span(lost)
            piece = tokens.text[span.start : gap.start] + " " + tokens.text[gap.end : span.end]
            sink = Sink()
            parse(piece, sink)
            try:
                lark.parse(piece)
            except UnexpectedInput:
                assert sink.found, piece
            else:
                assert not sink.found, piece


# --- after an error -----------------------------------------------------------------------------


def errors(text: str) -> list[tuple[int, str]]:
    sink = Sink()
    parse(text, sink)
    source = Source("t", text)
    return [(source.position(d.span.start)[0], d.message) for d in sink.sorted()]


def test_every_statement_is_read_on_its_own() -> None:
    text = """module A {
  rol base;
  param a in [1 2] m;
  param b in [1, 2] m;
  const c = ;
  dof q: revolute w;
}
semantics G {
  a { this.f = ; this.g = world world; }
  b c { }
  d { this.h 3; }
}
task T { reach; avoid R with nothing; horizon 3 of 2; }
"""
    assert [line for line, _ in errors(text)] == [2, 3, 5, 6, 9, 9, 10, 11, 13, 13, 13]


def test_what_can_be_read_is_kept() -> None:
    sink = Sink()
    (module,) = parse("module A { role base; param a in [1; const c = 2; }", sink).items
    assert [type(i).__name__ for i in module.items] == ["Role", "Const"]
    assert len(sink.found) == 1


def test_missing_semicolons_are_supplied() -> None:
    text = "module A {\n  role base\n  param a in [1, 2] m\n}\nedge e\nmodule B { role base; }"
    sink = Sink()
    file = parse(text, sink)
    assert [d.message for d in sink.found] == ["expected `;`"] * 3
    assert [type(i).__name__ for i in file.items] == ["Module", "Edges", "Module"]
    assert len(file.items[0].items) == 2


def test_a_missing_brace_is_supplied() -> None:
    sink = Sink()
    file = parse("module A { role base;\ngrammar G { start N; a: N -> A; }\nedge e;", sink)
    assert [d.message for d in sink.found] == ["expected `}`: a `{` is never closed"]
    assert [len(getattr(i, "items", ())) for i in file.items] == [1, 2, 0]


def test_junk_between_items_is_one_error() -> None:
    assert len(errors("role base; param a; const b; module A { role base; }")) == 1


def test_lost_words_are_noted() -> None:
    file = parse("module A { param a in [1; }\nmodule 3 { const b = 2; }", Sink())
    assert {"a", "b"} <= file.skipped
    assert len(file.broken) == 2


@pytest.mark.parametrize("terms", [90, 97, 98, 99, 100, 101, 150, 3000])
def test_long_sums_are_one_value_or_one_error(terms: int) -> None:
    sink = Sink()
    parse(f"module A {{ const c = {' + '.join(['1'] * terms)}; }}", sink)
    assert len(sink.found) == (terms > lalr.MAX_DEPTH)


def test_every_misspelt_item_is_told() -> None:
    text = "grammer G { start S; }\nsemantic G { g { } }\nworkspce W { }\nrole base;\ntusk T { }\n"
    assert [line for line, _ in errors(text)] == [1, 2, 3, 5]
