"""The table of names, on a text whose answers can be read off."""

from __future__ import annotations

import pytest

from grammar_lang.load import load_text
from grammar_lang.names.declarations import Entity, occurrences
from grammar_lang.names.table import NameTable
from grammar_lang.source import Span
from grammar_lang.syntax import Ident, Occurrence

TEXT = """\
module B { role base; }
module L { role link; param len in [1, 2] m; const twice = 2 * len; }
edge e;
grammar G { start N; b: N -> B; more: N -> N e L e L; accept contains N; }
semantics G {
  b { this.frame = world; }
  more { this.frame = N.frame * move(x, L2.twice); }
}
workspace W { plane xy; bounds box [0, 1] x [0, 1] m; region R box [0, 1] x [0, 1] m; }
task T { robot G; workspace W; start in R; reach Q; }
"""


@pytest.fixture(scope="module")
def names() -> NameTable:
    found = load_text(TEXT, "x.srg").names
    assert found is not None
    return found


def _named(text: str, after: str) -> Ident:
    start = TEXT.index(text, TEXT.index(after))
    return Ident(text, Span(start, start + len(text)))


@pytest.mark.parametrize(
    ("text", "after", "entity"),
    [
        ("len", "2 * ", Entity("parameter", ("L",), "len")),
        ("L2", "move", Entity("module", (), "L")),
        ("twice", "L2", Entity("constant", ("L",), "twice")),
        ("frame", "N.frame", Entity("attribute", ("G", "N"), "frame")),
        ("more", "more {", Entity("production", ("G",), "more")),
        ("N", "contains", Entity("nonterminal", ("G",), "N")),
        ("G", "robot", Entity("grammar", (), "G")),
        ("R", "start in", Entity("region", ("W",), "R")),
        ("Q", "reach", None),
        ("world", "world", None),
    ],
)
def test_what_a_name_stands_for(
    names: NameTable, text: str, after: str, entity: Entity | None
) -> None:
    assert names.entity(_named(text, after)) == entity


def test_an_entity_knows_its_declaration(names: NameTable) -> None:
    found = names.entity(_named("twice", "L2"))
    assert found is not None
    assert TEXT[found.span.start : found.span.end] == "twice"
    assert TEXT[found.statement.start : found.statement.end].startswith("const twice = 2 * len")
    assert [TEXT[m.span.start - 3 : m.span.start] for m in names.uses(found)] == ["L2."]


def test_a_mention_knows_where_it_stands(names: NameTable) -> None:
    start = TEXT.index("N.frame")
    found = names.inside(Span(start, TEXT.index(";", start)))
    assert [m.entity.name for m in found] == ["N", "frame", "L", "twice"]
    assert {m.within for m in found} == {Entity("production", ("G",), "more")}
    assert [m.position for m in found] == [0, 0, 4, 4]
    assert [TEXT[m.span.start : m.span.end] for m in found] == ["N", "frame", "L", "twice"]


def test_occurrences() -> None:
    """X once, X1 to Xn, aliases; a number that is another symbol's name needs an alias."""
    word = [Occurrence(None, Ident(name)) for name in ("A", "X", "e", "X", "e")]
    assert occurrences(word, {"A", "X", "e"}, {"e"}).places == {"A": 0, "X1": 1, "X2": 3}
    assert dict(occurrences(word, {"A", "X", "e"}).places)["e2"] == 4
    assert occurrences(word, {"A", "X", "X2", "e"}, {"e"}).clashes == ((Ident("X"), "X2"),)
    word[3] = Occurrence(Ident("last"), Ident("X"))
    assert occurrences(word, {"X2"}, {"e"}).clashes == ()
    assert occurrences(word, {"X2"}, {"e"}).places["last"] == 3
    assert occurrences(word, {"last"}).clashes == ((Ident("last"), "last"),)


def test_an_alias_that_is_taken_keeps_its_uses() -> None:
    """Else renaming it, which mends the error, would leave them behind."""
    text = (
        "module B { role base; } edge e; grammar G { start N; b: N -> B; m: N -> e:N e B; }"
        " semantics G { m { this.f = e.f; } }"
    )
    names = load_text(text, "x.srg").names
    assert names is not None
    alias = Entity("occurrence", ("G", "m"), "e")
    assert [m.span.start for m in names.mentions_of(alias)] == [
        text.index("e:N"),
        text.index("e.f;"),
    ]
