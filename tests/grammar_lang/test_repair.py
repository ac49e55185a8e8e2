"""Statements with a slip in them: what is said, where, and what is read all the same."""

from __future__ import annotations

import re
from collections.abc import Callable
from pathlib import Path

import pytest

from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.load import load_text
from grammar_lang.parsing.clause_forms import FORMS, ITEMS, MEANT
from grammar_lang.parsing.parse import parse
from grammar_lang.parsing.tables import tables
from grammar_lang.parsing.tokens import KEYWORDS
from tests.grammar_lang.conftest import PARTS

ROOT = Path(__file__).parents[2]
SPECS = sorted((ROOT / "specs").glob("*.srg"))
ENDING = re.compile(r";(?=[ \t]*(?://[^\n]*)?\n)")

PLACES = {
    "module": "module M {{ {} }}",
    "grammar": "grammar G {{ {} }}",
    "semantics": "semantics G {{ base {{ {} }} }}",
    "workspace": "workspace W {{ {} }}",
    "task": "task T {{ {} }}",
    "mission": "mission Q {{ {} }}",
}


def syntax(text: str) -> list[tuple[str, str, int, int]]:
    """Message, hint, beginning and end of each error of the parser."""
    sink = Sink()
    parse(text, sink)
    return [(d.message, d.hint or "", d.span.start, d.span.end) for d in sink.sorted()]


# --- Missing semicolons ---------------------------------------------------------------------------


@pytest.mark.parametrize("spec", SPECS, ids=lambda spec: spec.stem)
def test_a_missing_semicolon_is_one_error_at_the_end_of_its_line(spec: Path) -> None:
    """But where the next line may go on: the word of a robot takes in any names."""
    text = spec.read_text(encoding="utf-8")
    for found in list(ENDING.finditer(text))[::3]:
        line = text[text.rfind("\n", 0, found.start()) + 1 : found.start()]
        if "//" in line or line.lstrip().startswith("from "):
            continue
        spoilt = text[: found.start()] + text[found.end() :]
        errors = [(message, start) for message, _, start, _ in syntax(spoilt)]
        assert errors == [("expected `;`", found.start())], text[found.start() - 60 : found.end()]


@pytest.mark.parametrize("part", PARTS)
def test_all_semicolons_missing(part: str) -> None:
    lost = ENDING.sub("", PARTS[part])
    count = len(ENDING.findall(PARTS[part]))
    assert [message for message, *_ in syntax(lost)] == ["expected `;`"] * count


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("edge a\nedge b;", 1),
        ("include 'a.srg'\ninclude 'b.srg';", 1),
        ("grammar G { start N;\n  a: N -> B\n  b: N -> N C;\n}", 2),
        ("grammar G { start N;\n  a: N -> B\n    C\n  b: N -> N C;\n}", 3),
        ("grammar G { accept contains B and\n  contains C\n  a: N -> B;\n}", 2),
        ("task T { robot G workspace W;\n}", 1),
        ("task T { robot G,\n  workspace W;\n}", 1),
    ],
)
def test_where_a_semicolon_is_missing(text: str, line: int) -> None:
    [(message, _, start, _)] = syntax(text)
    assert message.startswith("expected `;`")
    assert text[:start].count("\n") + 1 == line


# --- Other notations ------------------------------------------------------------------------------


OTHERS = [
    ("grammar", "accept contains A && contains B;", "&&", "accept contains A and contains B;"),
    ("grammar", "accept contains A || contains B;", "||", "accept contains A or contains B;"),
    ("grammar", "accept !contains A;", "!", "accept not contains A;"),
    ("grammar", "accept count(A) = 2;", "=", "accept count(A) == 2;"),
    ("grammar", "accept: contains A;", ":", "accept contains A;"),
    ("grammar", "a: N => B;", "=>", "a: N -> B;"),
    ("grammar", "a: N ::= B;", "::=", "a: N -> B;"),
    ("module", "const a = 2**3;", "**", "const a = 2^3;"),
    ("module", "const a := 2;", ":=", "const a = 2;"),
    ("module", "const a: 2 m;", ":", "const a = 2 m;"),
    ("module", "role = link;", "=", "role link;"),
    ("module", "param a: [1, 2] m;", ":", "param a in [1, 2] m;"),
    ("module", "param a in (1, 2) m;", "(", "param a in [1, 2] m;"),
    ("module", "param a in [1; 2] m;", ";", "param a in [1, 2] m;"),
    ("module", "dof q = revolute z;", "=", "dof q: revolute z;"),
    ("semantics", "this.f == world;", "==", "this.f = world;"),
    ("semantics", "this.f = N.f @ world;", "@", "this.f = N.f * world;"),
    ("semantics", "this.f = rot(z, J->q);", "->", "this.f = rot(z, J.q);"),
    ("semantics", "effector(frame = N.f);", "=", "effector(frame: N.f);"),
    ("semantics", "this.f = move([1, 0]);", "[", "this.f = move((1, 0));"),
    ("workspace", "plane: xy;", ":", "plane xy;"),
    ("workspace", "region S = box [0, 1] x [0, 1] m;", "=", "region S box [0, 1] x [0, 1] m;"),
    ("workspace", "bounds box [0, 1] * [0, 1] m;", "*", "bounds box [0, 1] x [0, 1] m;"),
    ("workspace", "bounds box [0, 1], [0, 1] m;", ",", "bounds box [0, 1] x [0, 1] m;"),
    ("workspace", "region S ball [2, 3] m radius 1 m;", "[", "region S ball (2, 3) m radius 1 m;"),
    ("workspace", "region S hull [(0, 0), (1, 0)];", "[", "region S hull (0, 0), (1, 0);"),
    ("task", "robot: G;", ":", "robot G;"),
    ("task", "start: S;", ":", "start in S;"),
    ("task", "start in S, at rest;", ",", "start in S at rest;"),
    ("task", "avoid [O] with body;", "[", "avoid O with body;"),
    ("task", "avoid O and P with body;", "and", "avoid O, P with body;"),
    ("task", "avoid O with body margin = 1 cm;", "=", "avoid O with body margin 1 cm;"),
    ("task", "effort = 10 N*m;", "=", "effort <= 10 N*m;"),
    ("task", "effort < 10 N*m;", "<", "effort <= 10 N*m;"),
    ("task", "horizon = 5 steps of 1 s;", "=", "horizon 5 steps of 1 s;"),
    ("task", "gravity = (0, -9.81) m/s^2;", "=", "gravity (0, -9.81) m/s^2;"),
    ("task", "minimize mass, time;", ",", "minimize mass then time;"),
    ("task", "satisfy always !O;", "!", "satisfy always not O;"),
    ("task", "satisfy S -> eventually T;", "->", "satisfy S implies eventually T;"),
    ("mission", "tasks [A, B];", "[", "tasks A, B;"),
    ("mission", "minimize: changes;", ":", "minimize changes;"),
]


@pytest.mark.parametrize(("block", "written", "marked", "meant"), OTHERS)
def test_other_notations_are_told_and_read_as_meant(
    block: str, written: str, marked: str, meant: str
) -> None:
    """What is read is what the corrected statement says, in the same tree."""
    wrong, right = PLACES[block].format(written), PLACES[block].format(meant)
    [(_, hint, start, end)] = syntax(wrong)
    assert wrong[start:end] == marked
    assert syntax(right) == []
    assert f"`{meant}`" in hint or f" {hint.split('`')[1]} " in f" {spaced(meant)} "
    sink = Sink()
    assert parse(wrong, sink).items == parse(right, sink).items


def spaced(text: str) -> str:
    """The text with blanks about its signs."""
    return " ".join(re.findall(r"\w+|->|[<>=]=|\S", text))


@pytest.mark.parametrize(
    ("block", "written", "meant"),
    [
        ("module", "dof q revolute z;", "dof q: revolute z;"),
        ("module", "param a in [1 2] m;", "param a in [1, 2] m;"),
        ("grammar", "a N -> B;", "a: N -> B;"),
        ("semantics", "this.f = N.f rot(z, J.q);", "this.f = N.f * rot(z, J.q);"),
        ("semantics", "this.f = rot(z J.q);", "this.f = rot(z, J.q);"),
        ("workspace", "bounds box [0, 1] [0, 1] m;", "bounds box [0, 1] x [0, 1] m;"),
        ("task", "start S;", "start in S;"),
        ("task", "avoid O body;", "avoid O with body;"),
        ("task", "effort 10 N*m;", "effort <= 10 N*m;"),
        ("mission", "changes 3;", "changes <= 3;"),
    ],
)
def test_what_is_missing_is_written_out(block: str, written: str, meant: str) -> None:
    [(_, hint, *_)] = syntax(PLACES[block].format(written))
    assert hint == f"write `{meant}`"
    assert syntax(PLACES[block].format(meant)) == []


def test_a_slip_hides_no_other_in_its_statement() -> None:
    found = syntax("grammar G { accept contains A && !contains B || contains C; }")
    assert [hint for _, hint, *_ in found] == ["write `and`", "write `not`", "write `or`"]


@pytest.mark.parametrize("clause", ["horizon = 2 s;", "horizon: 2 s;", "horizon = 20;"])
def test_a_horizon_that_is_a_time_is_one_error(clause: str) -> None:
    [(message, hint, *_)] = syntax(f"task T {{ robot G; {clause} workspace W; }}")
    assert message.endswith("stands after `horizon`")
    assert "`horizon 10 steps of 0.2 s;`" in hint


# --- Comments and numbers -------------------------------------------------------------------------


def test_comments_with_a_hash_are_told_and_hide_nothing() -> None:
    plain = "edge a; // one's\nmodule M { // two {\n  role link; // 'three\n}\n// four"
    hashed = plain.replace("//", "#")
    found = syntax(hashed)
    assert [hashed[start:end] for *_, start, end in found] == ["#"] * 4
    assert {hint for _, hint, *_ in found} == {"a comment begins with `//`"}
    assert parse(hashed, Sink()).items == parse(plain, Sink()).items


def test_an_include_as_in_c() -> None:
    [(_, hint, *_)] = syntax('#include "modules.srg"\nedge a;')
    assert hint == 'write `include "FILE.srg";`'


@pytest.mark.parametrize(
    ("number", "meant"), [(".5", "0.5"), (".25e-3", "0.25e-3"), ("5.", "5.0"), ("0.", "0.0")]
)
def test_numbers_without_a_digit_beside_the_point(number: str, meant: str) -> None:
    wrong, right = (f"module M {{ const a = 2 * {n} m; }}" for n in (number, meant))
    [(_, hint, start, end)] = syntax(wrong)
    assert wrong[start:end] == number
    assert hint == f"write `{meant}`"
    assert parse(wrong, Sink()).items == parse(right, Sink()).items


# --- The words with which clauses begin -----------------------------------------------------------


def openings(block: str) -> set[str]:
    """The words with which a statement of an item may begin, by the tables of the parser."""
    states = [0]
    head = {"semantics": ["semantics", "NAME", "{", "NAME", "{"]}.get(block, [block, "NAME", "{"])
    for terminal in head:
        assert tables().shift(states, terminal)
    return {each for each in tables().expected(states) if each in tables().words} - {"this"}


@pytest.mark.parametrize("block", PLACES)
def test_every_clause_has_a_form_that_is_right(block: str) -> None:
    assert set(FORMS[block]) == openings(block)
    for word, form in FORMS[block].items():
        assert form.split()[0].startswith(word)
        assert syntax(PLACES[block].format(form)) == []
    assert set(MEANT[block].values()) <= set(FORMS[block])
    assert not set(MEANT[block]) & set(FORMS[block])


def test_every_item_has_a_form_that_is_right() -> None:
    assert set(ITEMS) == KEYWORDS
    for form in ITEMS.values():
        assert syntax(form) == []


@pytest.mark.parametrize(
    ("block", "written"),
    [
        *((block, "'quux' = 3;") for block in PLACES),
        # In the others a production, an attribute or a body may begin so.
        *((block, "quux 3;") for block in ("module", "workspace", "task", "mission")),
    ],
)
def test_an_unknown_clause_gets_the_whole_list(block: str, written: str) -> None:
    [(message, hint, start, _)] = syntax(text := PLACES[block].format(written))
    assert message.split("`")[1] == written.split(maxsplit=1)[0]
    assert text[start:].startswith(written)
    assert {f"`{word}`" for word in FORMS[block]} <= set(re.findall(r"`\w+`", hint))


@pytest.mark.parametrize(
    ("block", "written", "meant"),
    [
        ("module", "parm a in [1, 2];", "param"),
        ("module", "double a = 1;", "const"),
        ("module", "joint q: revolute z;", "dof"),
        ("grammar", "axiom N;", "start"),
        ("grammar", "accepts contains A;", "accept"),
        ("workspace", "zone S box [0, 1] x [0, 1] m;", "region"),
        ("task", "goal T;", "reach"),
        ("task", "efort <= 3 N;", "effort"),
        ("task", "duration 3 s;", "horizon"),
        ("mission", "task A, B;", "tasks"),
    ],
)
def test_what_is_meant_is_asked_and_the_list_follows(block: str, written: str, meant: str) -> None:
    [(_, hint, *_)] = syntax(PLACES[block].format(written))
    assert hint.startswith(f"did you mean `{meant}`? a {block} has ")
    assert {f"`{word}`" for word in FORMS[block]} <= set(re.findall(r"`\w+`", hint))


def test_a_clause_of_another_item() -> None:
    [(_, hint, *_)] = syntax("mission Q { robot G; }")
    assert hint.startswith("`robot` stands in a task; a mission has ")


# --- Brackets -------------------------------------------------------------------------------------


def test_a_bracket_that_is_never_closed() -> None:
    text = "semantics G { a { rod(frame: N.f, axis: x; this.g = N.g; } }"
    sink = Sink()
    parse(text, sink)
    (found,) = sink.found
    assert found.message == "expected `)`: a `(` is never closed"
    assert [text[span.start] for span, _ in found.notes] == ["("]


def test_a_block_that_is_never_closed() -> None:
    text = "semantics G {\n  a { this.f = N.f;\n  b { this.f = N.f; }\n}\nedge e;"
    sink = Sink()
    file = parse(text, sink)
    (found,) = sink.found
    assert found.message == "expected `}`: a `{` is never closed"
    assert found.span.start == text.index("\n  b")
    assert [span.start for span, _ in found.notes] == [text.index("{ this")]
    assert [len(getattr(item, "blocks", ())) for item in file.items] == [2, 0]


def test_an_item_that_is_never_closed_ends_at_an_edge() -> None:
    text = "module M {\n  role link;\nedge e;\nmodule N { role link; }"
    [(message, _, start, _)] = syntax(text)
    assert message == "expected `}`: a `{` is never closed"
    assert start == text.index("\nedge")


# --- One mistake, one error, after the parser ----------------------------------------------------


@pytest.mark.parametrize(
    ("old", "new", "marked", "hint"),
    [
        ("rot(z, JO.q)", "rot(JO.q, z)", "rot(JO.q, z)", "write `rot(z, …)`"),
        ("rot(z, JO.q)", "rotate(z, JO.q)", "rotate", "did you mean `rot`?"),
        ("rot(z, JO.q)", "rot(z, q)", "q", "known: `N`, `eps`, `JO`, `pi`"),
        ("= world", "= World", "World", "did you mean `world`?"),
        ("this.frame = world", "self.frame = world", "self", "the left side is called `this`"),
        ("frame: N.frame)", "frame: 'tip')", "'tip'", None),
    ],
)
def test_slips_in_a_semantics(
    old: str, new: str, marked: str, hint: str | None, build: Callable[..., str]
) -> None:
    assert old in PARTS["semantics"]
    text = build(semantics=PARTS["semantics"].replace(old, new))
    (found,) = load_text(text, "t.srg").diagnostics
    assert text[found.span.start : found.span.end] == marked
    assert hint is None or found.hint == hint


def test_a_unit_with_blanks_in_it(build: Callable[..., str]) -> None:
    text = build(modules=PARTS["modules"].replace("1 kg/m", "1 kg / m"))
    (found,) = load_text(text, "t.srg").diagnostics
    assert found.message == "unknown name `m`"
    assert "without blanks" in (found.hint or "")


@pytest.mark.parametrize("unit", ["Nm", "N m"])
def test_a_product_of_units_without_its_sign(unit: str, build: Callable[..., str]) -> None:
    text = build(task=PARTS["task"].replace("10 N*m", f"10 {unit}"))
    (found,) = load_text(text, "t.srg").diagnostics
    assert found.message == f"unknown unit `{unit}`"
    assert (found.hint or "").startswith("did you mean `N*m`?")


# --- Texts that end anywhere ----------------------------------------------------------------------


@pytest.mark.parametrize(
    "last", [":", "=", ",", "[", "(", "**", "&&", "!", ";", "|", "->", "3", "x"]
)
@pytest.mark.parametrize("part", PARTS)
def test_texts_that_end_with_a_slip(part: str, last: str) -> None:
    """An error or none, but always an answer, wherever the text ends."""
    words = PARTS[part].split(" ")
    for stop in range(1, len(words), 11):
        text = " ".join([*words[:stop], last])
        assert all(start <= len(text) for _, _, start, _ in syntax(text))
