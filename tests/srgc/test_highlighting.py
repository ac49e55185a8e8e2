"""Colours follow the language: both highlighters against the parser, the specs and any text.

The oracle is `srg.lark` read by lark itself, which tells of every word whether it is a keyword, a
name or a unit *there*.
"""

from __future__ import annotations

import json
import random
import re
import tomllib
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from lark import Lark, Token, UnexpectedInput
from lark.lark import PostLex
from pygments import highlight
from pygments.formatters import HtmlFormatter
from pygments.token import Comment, Error, Keyword, Name, Number, Operator, Punctuation, String
from rich.console import Console
from rich.syntax import Syntax

from grammar_lang.elaboration import emissions, typecheck
from grammar_lang.units import UNIT_NAMES
from srgc.pygments_lexer import EMISSIONS, FUNCTIONS, SrgLexer
from tests.oracles.sentences import Sentences
from tests.oracles.some_cases import examples
from tests.oracles.textmate import Grammar

ROOT = Path(__file__).parents[2]
LARK = (ROOT / "grammar_lang" / "parsing" / "srg.lark").read_text(encoding="utf-8")
EXTENSION = ROOT / "editors" / "vscode"
TEXTMATE = json.loads((EXTENSION / "syntaxes" / "srg.tmLanguage.json").read_text(encoding="utf-8"))
SPECS = {
    str(path.relative_to(ROOT)): path.read_text(encoding="utf-8")
    for path in sorted((ROOT / "specs").glob("*.srg"))
}
FENCE = re.compile(r"^```srg(?: [^\n]*)?\n(.*?)^```$", re.MULTILINE | re.DOTALL)
PAGES = {
    str(path.relative_to(ROOT)): FENCE.findall(path.read_text(encoding="utf-8"))
    for folder in ("docs", "tests/golden", "grammar_lang/diagnostics/catalogue")
    for path in sorted((ROOT / folder).rglob("*.md"))
}
PAGES = {page: blocks for page, blocks in PAGES.items() if blocks}
PLANAR_ARM = SPECS["specs/planar_arm.srg"]

# Every keyword as a keyword, and whatever else may stand there: keywords as names, units as names.
CONTEXTS = r"""
include "modules.srg"; include std "serial.srg";
module Fork { role joint; const male = 3; port in: in male; port port: ports female; port out: std;
  frame frame = in * rot(z, q); frame out = frame * move((1, male) m); frame port = out * world;
  rod(frame: in, axis: -x, length: male, density: 2 kg/m); sphere(frame: port, radius: 2 * 3 cm); }
grammar from from ports { start from; with with, start1, ports; accept contains with; }
/* block
   comment } ; */
module Foot { role base; }
module module { role link; param length in [0.5, 5] m; param radius in {20, 25, 30} mm;
  const area = pi * (2 cm)^2; const a = sqrt(2) m; const m = 2 N * m; const n = 2 N*m; }
module Elbow { role joint;
  dof q: revolute -z in [-150, 150] deg rate in [-2, 2] rad/s accel <= 8 rad/s^2 effort <= 7 N*m
    named "in; 'q'";
  named 'dof "q"';
  drive q: gear -2 * (3 + a) rotor 1 kg*m^2 viscous 3 N*m*s coulomb 1 N*m;
  state w rad/s = 0; state s s; state in; input v in [0, 1] N*m;
  der(w) = v - 2*w; torque(q) = u - b*rate(q); }
module Slide
{ role joint;
  dof
    rate
    : prismatic x
    in [0, 40]
      cm; }
edge eps, '[', "]";
grammar Tree {
  start S;
  until: S -> empty;
  root:   S -> Foot T;  with: S -> T;
  branch: T -> '[' left:T ']' right:T;
  role:  T -> module;
  accept contains contains and starts with with starts or
    not (ends with Foot and count(m) <= 4 or length < 20);
  accept starts with Foot and count(m) == 2 and length > 3 and matches Foot or ends with Foot
    or length >= 2 or matches empty or count('[') <= 3 or contains Foot;
  accept matches Foot ((eps m | empty)* eps L)+ E? ;
}
semantics Tree {
  root { T.at = world; this.length = L.length; }
  branch { left.at = this.at * rot(-z, 30 deg); right.at = this.at * move((1, 2, 3) m); }
  task { effector(frame: this.at); point(frame: this.at, mass: 0.2 kg);
    visual(frame: this.at, file: "visual.dae", scale: 1 mm); visual.visual = let.visual;
    effector.effector = sin(pi/2) + pi.pi; }
  let { let let = let.let * rot(z, 3 deg); let.in = let; let f = (1 + 2) m; Elbow.in = f * world; }
}
workspace Hall {
  plane xy; space xyz;
  bounds box [0, 6] x [0, 4] m;
  region box hull (0.2, 0.2), (1.4, 0.2), (0.2, 1.4) m;
  obstacle task polytope { x >= 2; x <= 3; y <= 1 + x/2; y >= 0 } m;
  region radius ball (1, 1) m radius 2 * 5 cm; target ball capsule (1, 1), (2, 1) m radius 1 cm;
  region capsule cylinder (1, 1), (2, 1) m radius 1 cm;
  obstacles from "map.yaml";
  obstacles from "at.stl" in mm at world * move((1, 0, 0) m) * rot(-z, 2 * 15 deg);
  obstacles from "in.obj" at move(x, 1 m); obstacles from 'a.obj' in cm;
}
task Turn {
  robot robot; workspace workspace;
  start in in by effector 1 rates <= 0.1 rad/s; start in held at rest held;
  start at (0 deg, 2 m, 3);
  reach reach by effector 1 at rest; reach for rates <= 0.1 rad/s for (1 + 1) s;
  reach rates at rest for 1 s; reach to aligned -x to (0, 1 + 1) within 5 deg at rest;
  reach within by effector 1 oriented rot(-z, 2 deg) * world within (1 + 1) deg aligned y to (1,
    0) m within 1 rates <= 2; payload 2 kg; payload (1 + 1) kg by effector 1;
  carry 2 kg from A to B; carry (1 + 1) kg from from to to by effector 1 rates <= 0.1 rad/s;
  carry 1 from to to from rates <= 2;
  minimize modules; minimize sum ( then ) within 5 % then sum(within) within (1 + a) * 2 % /* then
    */ then effort then within within within % then mass then time;
  avoid with, with with body, margin 2 cm;
  avoid O with effector margin (1 + 2) cm;
  avoid self with body; avoid self with body, except except except, margin Tube;
  avoid self, O with body margin 2 mm except Tube Tube;
  effort <= 10 N*m norm 2;
  horizon 40 steps of 50 ms; horizon at /* */ most (2 + 1) steps of 2;
  gravity (0, -9.81) m/s^2; modules <= 6; bounds with body; slack 1e-6;
  from fixed eps '[' fixed L.length = 2 m, L2.fixed = 3 m;
  satisfy until until not (always until)
    implies eventually[0 s, 5 s] m by effector 2 and last[2 s] s or next R;
  satisfy (R) and (S) until (T) or (U) implies a until b and c or d by effector 1 until
    e by effector 1 or f by effector 1 and (g) implies h by effector 1 implies i;
  satisfy aligned aligned -x to (0, 1) within 5 deg and to by effector 1 aligned y to (1,
    0) within (1 + 1) deg oriented rot(-z, 2 deg) * world within 1 or not (within oriented world
    within 2 deg until next always to aligned z to (0, 0, 1) within 1 implies oriented);
  robust start 1 mm 0.1 deg, (1 + 1) m; robust effort 0.5 %;
  robust measure 0.1 deg, 2 mm/s; robust effort (1 + 1) % /* */ of bound; robust mass 3 %;
  robust mass 3 % of of; robust mass (1 + 1) % of Tube;
  robust payload 3 %;
  control open loop; control feedback; repeat;
}
mission Day {
  tasks Turn, tasks, one , free; one /* */ robot;
  reconfigure; reconfigure add 2, remove -1 * (3 + add), change change; reconfigure remove remove;
  free L.length, free.free, one . tasks; changes <= 2 * changes - 1; changes < (1 + 2);
  minimize changes within 5 % then sum(changes) within changes % then tasks then effort;
}
mission mission { tasks mission; }
"""


class _Words(PostLex):
    always_accept = ("NAME",)

    def process(self, stream: Iterator[Token]) -> Iterator[Token]:
        return stream


@cache
def parser() -> Lark:
    return Lark(
        f"file: item*\n{LARK}", start=["file", "item"], parser="lalr", lexer="contextual",
        postlex=_Words(), keep_all_tokens=True, maybe_placeholders=True,
    )  # fmt: skip


def meant(text: str) -> list[tuple[int, str, str]]:
    """The tokens the parser sees: offset, text, kind; UnexpectedInput if the text is wrong."""
    tree = parser().parse(text, start="file")
    tokens = tree.scan_values(lambda value: isinstance(value, Token))
    names = {
        token.start_pos
        for part in tree.find_pred(lambda part: part.data in {"label", "target"})
        for token in part.children
        if token != "this"
    }
    kinds = {True: lambda _: "name", False: kind_meant}
    return [(t.start_pos or 0, str(t), kinds[t.start_pos in names](t)) for t in tokens]


def kind_meant(token: Token) -> str:
    if token.type in {"NAME", "NUMBER", "STRING", "UNIT"}:
        return token.type.lower()
    if token == "%":
        return "unit"
    return "keyword" if token.isalpha() else "sign"


def is_correct(text: str) -> bool:
    try:
        meant(text)
    except UnexpectedInput:
        return False
    return True


def lexed(text: str) -> dict[int, tuple[str, object]]:
    return {at: (value, kind) for at, kind, value in SrgLexer().get_tokens_unprocessed(text)}


def kind_lexed(value: str, kind: object) -> str:
    kinds = {
        "unit": [Keyword.Type],
        "keyword": [Keyword, Operator.Word],
        "name": [Name],
        "number": [Number],
        "string": [String],
        "sign": [Operator, Punctuation],
    }
    if value == "this" and kind is Name.Builtin.Pseudo:
        return "keyword"
    return next(name for name, some in kinds.items() if any(kind in k for k in some))


SCOPES = {
    "unit": "keyword.other.unit",
    "sign": "keyword.operator.(arithmetic|comparison|assignment|arrow|quantifier)|punctuation",
    "keyword": "keyword|storage|constant.language.(?!pi|role)|variable.language.this",
    "name": "variable|entity|support|constant.language.(pi|role)",
    "number": "constant.numeric",
    "string": "string",
}


@cache
def textmate():
    return Grammar(TEXTMATE)


def scoped(text: str) -> list[tuple[int, str, str]]:
    """Offset, text and innermost scope of every piece of a text."""
    starts = [0]
    for line in text.split("\n"):
        starts.append(starts[-1] + len(line) + 1)
    pieces = [
        (starts[p.line] + p.start, starts[p.line] + p.end, p) for p in textmate().tokenise(text)
    ]
    return [(start, text[start:end], piece.scopes[-1]) for start, end, piece in pieces]


def assert_lexed_as_meant(text: str) -> None:
    tokens = lexed(text)
    for at, value, kind in meant(text):
        assert at in tokens, (value, text[at : at + 40])
        assert tokens[at][0] == value, text[at : at + 40]
        assert kind_lexed(*tokens[at]) == kind, (value, text[max(0, at - 40) : at + 40])


def assert_scoped_as_meant(text: str) -> None:
    scopes = {at: (value, scope) for at, value, scope in scoped(text)}
    for at, value, kind in meant(text):
        assert at in scopes, (value, text[at : at + 40])
        assert scopes[at][0].rstrip() == value, text[at : at + 40]
        found = next(k for k, some in SCOPES.items() if re.match(some, scopes[at][1]))
        assert found == kind, (value, scopes[at], text[max(0, at - 40) : at + 40])


# --- against the parser -------------------------------------------------------------------------


@pytest.mark.parametrize("text", [*SPECS.values(), CONTEXTS], ids=[*SPECS, "contexts"])
def test_the_lexer_sees_what_the_parser_sees(text: str) -> None:
    assert_lexed_as_meant(text)


@pytest.mark.parametrize("text", [*SPECS.values(), CONTEXTS], ids=[*SPECS, "contexts"])
def test_the_textmate_grammar_sees_what_the_parser_sees(text: str) -> None:
    assert_scoped_as_meant(text)


@pytest.mark.parametrize("text", [*SPECS.values(), CONTEXTS], ids=[*SPECS, "contexts"])
def test_the_specs_have_no_error_tokens(text: str) -> None:
    assert not [value for value, kind in lexed(text).values() if kind in Error]
    assert not [value for _, value, scope in scoped(text) if scope.startswith("invalid")]


@pytest.mark.parametrize("page", PAGES)
def test_programs_of_the_pages(page: str) -> None:
    for text in PAGES[page]:
        tokens = lexed(text)
        assert "".join(value for value, _ in tokens.values()) == text
        if is_correct(text):
            assert not [value for value, kind in tokens.values() if kind in Error]
            assert_lexed_as_meant(text)


@pytest.mark.parametrize("page", PAGES)
def test_programs_of_the_pages_have_their_scopes(page: str) -> None:
    for text in PAGES[page]:
        pieces = scoped(text)
        if is_correct(text):
            assert not [value for _, value, scope in pieces if scope.startswith("invalid")]
            assert_scoped_as_meant(text)


def test_the_programs_of_the_language_page_are_correct() -> None:
    """So that the tests above say something."""
    assert len(PAGES["docs/reference/language.md"]) >= 4
    assert all(map(is_correct, PAGES["docs/reference/language.md"]))
    assert sum(is_correct(text) for blocks in PAGES.values() for text in blocks) > 20


@cache
def sentences() -> Sentences:
    return Sentences(parser())


def sentence(choose: random.Random, names: tuple[str, ...], gaps: tuple[str, ...]) -> str:
    """A random item, its terminals apart by random gaps."""
    units = [*UNIT_NAMES, "N*m", "kg/m^3", "rad/s", "m^-2"]
    drawn = {
        "NAME": names,
        "NUMBER": ("0", "12", "0.5", "1e-6", "2.5E+3"),
        "STRING": ("'['", '"map.yaml"', "'//'", '"é"'),
        "UNIT": units,
    }
    fixed = {t.name: t.pattern.value for t in parser().terminals if t.name not in drawn}
    terminals = sentences().draw("file", choose, choose.choice((40, 160, 400)))
    words = (choose.choice(drawn.get(name) or (fixed[name],)) for name in terminals)
    return "".join(f"{word}{choose.choice(gaps)}" for word in words)


NAMES = ("a", "B1", "_t", "m", "s", "N", "frame", "JO", "pi", "rot")
KEYWORDS = tuple(sorted(set(re.findall(r'"([a-z]+)"', LARK))))
RESERVED = frozenset(
    {"and", "or", "not", "empty", "this", "world", "start", "accept", "x", "y", "z"}
)
AWKWARD = (*NAMES * 6, *sorted(set(KEYWORDS) - RESERVED), "self")
GAPS = (" ", " ", " ", "\n", "\t", " /* ; } ' */ ", '// in { "\n', "\r\n")


@settings(max_examples=examples(200, 400))
@given(st.integers(0, 2**32))
def test_random_items_are_lexed_as_they_are_parsed(seed: int) -> None:
    text = sentence(random.Random(seed), AWKWARD, GAPS)
    if is_correct(text):
        assert_lexed_as_meant(text)


@settings(deadline=None)  # the first one compiles the patterns
@given(st.integers(0, 2**32))
def test_random_items_are_scoped_as_they_are_parsed(seed: int) -> None:
    text = sentence(random.Random(seed), NAMES, (" ", "  "))
    if is_correct(text):  # `frame` is no emission
        assert_scoped_as_meant(text)


# --- nothing is forgotten -----------------------------------------------------------------------


def test_every_keyword_of_the_language_is_shown_as_one() -> None:
    """A new keyword fails here until a program in this file uses it and both colour it."""
    seen = {value for _, value, kind in meant(CONTEXTS + PLANAR_ARM) if kind == "keyword"}
    assert len(KEYWORDS) > 70
    assert set(KEYWORDS) <= seen


def patterns(node: object) -> Iterator[str]:
    """All regular expressions of a TextMate grammar."""
    if isinstance(node, dict):
        for key, value in node.items():
            if key in {"match", "begin", "end"}:
                yield value
            else:
                yield from patterns(value)
    elif isinstance(node, list):
        for value in node:
            yield from patterns(value)


def test_every_keyword_and_unit_occurs_in_the_textmate_grammar() -> None:
    words = {
        word for p in patterns(TEXTMATE) for word in re.findall(r"[A-Za-z]+", p.replace(r"\b", " "))
    }
    assert set(KEYWORDS) <= words
    units = {tuple(u.split("|")) for p in patterns(TEXTMATE) for u in re.findall(r"(kg[|\w]+)", p)}
    assert {frozenset(u) for u in units} == {frozenset(UNIT_NAMES)}


def test_every_unit_is_a_unit_after_a_number_and_a_name_elsewhere() -> None:
    for unit in UNIT_NAMES:
        text = f"module L {{ const {unit} = 2 {unit}; const a = 2*{unit}; }}"
        kinds = [kind for value, kind in lexed(text).values() if value == unit]
        assert kinds == [Name.Variable, Keyword.Type, Name]
        assert [scope for _, value, scope in scoped(text) if value.strip() == unit] == [
            "variable.parameter.srg", "keyword.other.unit.srg", "variable.other.srg",
        ]  # fmt: skip


def test_the_functions_are_those_of_the_language() -> None:
    assert set(FUNCTIONS) == {*typecheck.FUNCTIONS, "rate"}
    assert set(EMISSIONS) == set(emissions._ARGUMENTS)
    [functions] = [p for p in patterns(TEXTMATE) if "sqrt" in p]
    [rods] = [p for p in patterns(TEXTMATE) if "rod|" in p]
    assert set(FUNCTIONS) <= set(re.findall(r"\w+", functions))
    assert set(EMISSIONS) <= set(re.findall(r"\w+", rods))


# --- expectations by hand -----------------------------------------------------------------------


def words_of(line: str, text: str = PLANAR_ARM) -> list[tuple[str, str]]:
    """The visible tokens of the one line of a text that contains ``line``."""
    at = text.index(line)
    assert text.count(line) == 1
    tokens = lexed(text)
    return [
        (value, str(kind).removeprefix("Token."))
        for start, (value, kind) in tokens.items()
        if at <= start < at + len(line) and value.strip()
    ]


def test_a_parameter_may_be_called_as_a_keyword() -> None:
    assert words_of("param length in [0.5, 5] m;") == [
        ("param", "Keyword.Declaration"), ("length", "Name.Variable"), ("in", "Keyword"),
        ("[", "Punctuation"), ("0.5", "Literal.Number"), (",", "Punctuation"),
        ("5", "Literal.Number"), ("]", "Punctuation"), ("m", "Keyword.Type"),
        (";", "Punctuation"),
    ]  # fmt: skip


def test_a_member_is_no_keyword() -> None:
    assert words_of("length: L.length, density") == [
        ("length", "Name.Property"), (":", "Punctuation"), ("L", "Name"), (".", "Operator"),
        ("length", "Name.Attribute"), (",", "Punctuation"), ("density", "Name.Property"),
    ]  # fmt: skip


def test_the_accept_condition() -> None:
    assert words_of("accept contains EN and starts with B") == [
        ("accept", "Keyword"), ("contains", "Keyword"), ("EN", "Name"), ("and", "Operator.Word"),
        ("starts", "Keyword"), ("with", "Keyword"), ("B", "Name"),
    ]  # fmt: skip
    line = "accept length <= 20;"
    assert words_of(line, f"grammar G {{ {line} }}") == [
        ("accept", "Keyword"), ("length", "Keyword"), ("<=", "Operator"),
        ("20", "Literal.Number"), (";", "Punctuation"),
    ]  # fmt: skip


def test_a_rule_and_an_emission() -> None:
    assert words_of("joint { this.frame = N.frame * rot(z, JO.q); }") == [
        ("joint", "Name.Label"), ("{", "Punctuation"), ("this", "Name.Builtin.Pseudo"),
        (".", "Operator"), ("frame", "Name.Attribute"), ("=", "Operator"), ("N", "Name"),
        (".", "Operator"), ("frame", "Name.Attribute"), ("*", "Operator"),
        ("rot", "Name.Builtin"), ("(", "Punctuation"), ("z", "Keyword.Constant"),
        (",", "Punctuation"), ("JO", "Name"), (".", "Operator"), ("q", "Name.Attribute"),
        (")", "Punctuation"), (";", "Punctuation"), ("}", "Punctuation"),
    ]  # fmt: skip
    assert words_of("effector(frame: N")[0] == ("effector", "Name.Builtin")
    assert words_of("role effector")[1] == ("effector", "Name.Constant")
    assert words_of("avoid O with effector")[-1] == ("effector", "Keyword")


def test_a_unit_stands_right_after_its_number() -> None:
    assert words_of("effort <= 10 N*m;") == [
        ("effort", "Keyword"), ("<=", "Operator"), ("10", "Literal.Number"),
        ("N*m", "Keyword.Type"), (";", "Punctuation"),
    ]  # fmt: skip
    assert words_of("2 N * m;", "module L { const a = 2 N * m; }") == [
        ("2", "Literal.Number"), ("N", "Keyword.Type"), ("*", "Operator"), ("m", "Name"),
        (";", "Punctuation"),
    ]  # fmt: skip


def test_a_product_of_intervals() -> None:
    assert words_of("region S box [0.8, 1.2] x [1.0, 1.4] m;") == [
        ("region", "Keyword.Declaration"), ("S", "Name.Entity"), ("box", "Keyword"),
        ("[", "Punctuation"), ("0.8", "Literal.Number"), (",", "Punctuation"),
        ("1.2", "Literal.Number"), ("]", "Punctuation"), ("x", "Operator.Word"),
        ("[", "Punctuation"), ("1.0", "Literal.Number"), (",", "Punctuation"),
        ("1.4", "Literal.Number"), ("]", "Punctuation"), ("m", "Keyword.Type"),
        (";", "Punctuation"),
    ]  # fmt: skip


def test_comments_and_strings() -> None:
    text = "edge '[', \"//\"; // it's\n/* ; */ /* open\nmodule"
    assert [(v, k) for v, k in lexed(text).values() if k in Comment or k in String] == [
        ("'['", String.Single), ('"//"', String.Double), ("// it's", Comment.Single),
        ("/*", Comment.Multiline), (" ; ", Comment.Multiline), ("*/", Comment.Multiline),
        ("/*", Comment.Multiline), (" open\nmodule", Comment.Multiline),
    ]  # fmt: skip
    assert {scope for _, v, scope in scoped(text) if "open" in v or "module" in v} == {
        "comment.block.srg"
    }


@pytest.mark.parametrize(
    ("word", "scope"),
    [
        ("module", "storage.type.module.srg"),
        ("JO", "entity.name.type.module.srg"),
        ("PickAndPlace", "entity.name.namespace.srg"),
        ("density", "variable.parameter.srg"),
        ("contains", "keyword.other.condition.srg"),
        ("and", "keyword.operator.wordlike.srg"),
        ("base", "constant.language.role.srg"),
        ("this", "variable.language.this.srg"),
        ("world", "constant.language.srg"),
        ("rot", "support.function.srg"),
        ("rod", "support.function.emission.srg"),
        ("O", "entity.name.tag.region.srg"),
        ("N*m", "keyword.other.unit.srg"),
        ("0.125", "constant.numeric.srg"),
    ],
)
def test_scopes_of_the_running_example(word: str, scope: str) -> None:
    """Of the first place where the word stands."""
    found = [scope for _, value, scope in scoped(PLANAR_ARM) if value.strip() == word]
    assert found[0] == scope


# --- broken text --------------------------------------------------------------------------------

FRAGMENTS = (
    "/*", "*/", "//", "'", '"', "{", "}", "[", "]", "(", ")", ";", ":", "task A {", "module",
    " in ", " and ", " m", " N*m", "\n", "\r", "\0", "é", "½", "1", ".", " x ", "length", "#",
)  # fmt: skip


def mutated(seed: int) -> str:
    choose = random.Random(seed)
    text = choose.choice([PLANAR_ARM, CONTEXTS])
    for _ in range(choose.randint(1, 8)):
        start = choose.randrange(len(text))
        end = start + choose.choice((0, 0, 1, 3, 10, 100))
        text = text[:start] + choose.choice((*FRAGMENTS, "")) + text[end:]
    return text


@given(st.one_of(st.integers(0, 2**32).map(mutated), st.text()))
def test_no_text_loses_a_character(text: str) -> None:
    tokens = list(SrgLexer().get_tokens_unprocessed(text))
    assert "".join(value for _, _, value in tokens) == text
    assert all(value for _, _, value in tokens)


@given(st.integers(0, 2**32).map(mutated))
def test_no_text_stops_the_textmate_grammar(text: str) -> None:
    lines = text.split("\n")
    pieces = textmate().tokenise(text)
    shown = [
        "".join(lines[n][p.start : p.end] for p in pieces if p.line == n) for n in range(len(lines))
    ]
    assert shown == lines


@pytest.mark.parametrize("kind", ["module", "grammar", "semantics", "workspace", "task", "mission"])
@pytest.mark.parametrize(
    "broken",
    [
        "module A { role base;",
        "grammar G { start N;",
        "semantics S { a { this.b = 1;",
        "semantics S { a { }",
        "workspace W { plane xy;",
        "task T { reach R;",
        "mission M { tasks A, B;",
        "mission M",
        "task T",
        "task",
        "};",
    ],
)
def test_a_missing_brace_does_not_spoil_the_next_item(broken: str, kind: str) -> None:
    text = f"{broken}\n{kind} Next {{ }}\nmodule Last {{ role link; }}"
    tokens = list(lexed(text).values())
    assert (kind, Keyword.Declaration) in tokens
    assert ("Next", Name.Class if kind == "module" else Name.Namespace) in tokens
    assert ("link", Name.Constant) in tokens
    scopes = {value.strip(): scope for _, value, scope in scoped(text)}
    assert scopes[kind] == f"storage.type.{kind}.srg"
    assert scopes["Next"].startswith("entity.name")
    assert scopes["link"] == "constant.language.role.srg"


def test_the_statement_after_a_broken_one_has_its_colours() -> None:
    tokens = lexed("module L { param length in [0, 1 \n const length = 2; }")
    assert ("const", Keyword.Declaration) in tokens.values()


@pytest.mark.parametrize("nest", ["(", "[", "{", "/*", "module a {", "accept (", "- "])
def test_deep_nesting(nest: str) -> None:
    text = f"module L {{ const a = {nest * 10_000}"
    assert "".join(value for value, _ in lexed(text).values()) == text


# --- the files ----------------------------------------------------------------------------------


def test_the_textmate_grammar_is_whole() -> None:
    """Its keys are those of the format, its includes resolve, its regular expressions compile."""
    assert set(TEXTMATE) == {"$schema", "name", "scopeName", "fileTypes", "patterns", "repository"}
    assert (TEXTMATE["scopeName"], TEXTMATE["fileTypes"]) == ("source.srg", ["srg"])
    assert textmate().included == set(TEXTMATE["repository"])


def test_all_scopes_end_with_the_language() -> None:
    names = re.findall(r'"name": "([^"]+)"', json.dumps(TEXTMATE["repository"]))
    assert names
    assert [name for name in names if not re.fullmatch(r"[a-z.-]+\.srg", name)] == []


def test_the_extension_uses_the_grammar() -> None:
    manifest = json.loads((EXTENSION / "package.json").read_text(encoding="utf-8"))
    [grammar] = manifest["contributes"]["grammars"]
    [language] = manifest["contributes"]["languages"]
    assert json.loads((EXTENSION / grammar["path"]).read_text(encoding="utf-8")) == TEXTMATE
    assert grammar["scopeName"] == TEXTMATE["scopeName"]
    assert language["id"] == grammar["language"]
    assert [f"*{extension}" for extension in language["extensions"]] == SrgLexer.filenames


def test_there_is_one_copy_of_the_grammar() -> None:
    kept = [path for path in (ROOT / "editors").rglob("*.tmLanguage.json")
            if "node_modules" not in path.parts]  # fmt: skip
    assert kept == [EXTENSION / "syntaxes" / "srg.tmLanguage.json"]


def test_the_lexer_is_declared() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    assert project["entry-points"]["pygments.lexers"] == {"srg": "srgc.pygments_lexer:SrgLexer"}
    assert any(need.startswith("pygments") for need in project["dependencies"])


def test_pygments_and_rich_use_the_lexer() -> None:
    assert '<span class="nc">JO</span>' in highlight(PLANAR_ARM, SrgLexer(), HtmlFormatter())
    console = Console(record=True, width=200, color_system="truecolor", file=None, quiet=True)
    console.print(Syntax(PLANAR_ARM, SrgLexer()))
    assert SrgLexer.analyse_text(PLANAR_ARM) > 0.5
    assert SrgLexer.analyse_text("module foo { }") == 0
