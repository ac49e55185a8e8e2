from __future__ import annotations

import re
from collections.abc import Callable
from fractions import Fraction

import pytest

from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.load import load_text
from grammar_lang.parsing.parse import parse

Check = Callable[[str], list[tuple[str, str]]]


def value(expression: str) -> s.Expr:
    sink = Sink()
    file = parse(f"module M {{ const c = {expression}; }}", sink)
    assert not sink.found
    module = file.items[0]
    assert isinstance(module, s.Module)
    const = module.items[0]
    assert isinstance(const, s.Const)
    return const.value


def number(text: str, unit: str | None = None) -> s.Number:
    return s.Number(Fraction(text), None if unit is None else s.Ident(unit))


def test_a_unit_is_one_token() -> None:
    """``2 N*m`` is newton metres, ``2 N * m`` is 2 N times the name m."""
    assert value("2 N*m") == number("2", "N*m")
    product = s.Binary("*", number("2", "N"), s.Name(s.Ident("m")))
    assert value("2 N * m") == product
    assert value("2 N*m.a") == s.Binary("*", number("2", "N"), s.Member(s.Ident("m"), s.Ident("a")))
    assert value("(1 + 2) cm") == s.Scaled(s.Binary("+", number("1"), number("2")), s.Ident("cm"))


def test_precedence() -> None:
    one, two, three = number("1"), number("2"), number("3")
    assert value("1 - 2 - 3") == s.Binary("-", s.Binary("-", one, two), three)
    assert value("1 + 2 * 3") == s.Binary("+", one, s.Binary("*", two, three))
    assert value("-1 ^ 2") == s.Negate(s.Binary("^", one, two))
    assert value("1 ^ -2") == s.Binary("^", one, s.Negate(two))


def test_numbers_are_exact() -> None:
    assert value("0.1") == number("1/10")
    assert value("1.5e-3") == number("3/2000")


def test_keywords_are_contextual(check_fragment: Check) -> None:
    text = """
module base { role base; param in2 in [1, 2] m; const rate = 1; dof dof: revolute z; }
module link { role link; param length in [0.5, 1] m; }
module count { role effector; }
edge contains, starts;
grammar grammar {
  start task;
  base: task -> base;
  count: task -> task contains count;
  in: task -> length:task starts link;
  accept contains contains count and starts with base and count(count) < 3 and length > 0;
  accept matches base (contains | count | starts | link)*;
}
semantics grammar {
  base { this.frame = rot(z, base.dof); }
  count { this.frame = task.frame; effector(frame: this.frame); }
  in { this.frame = length.frame * move(x, link.length); }
}
workspace plane { plane xy; bounds box [0, 1] x [0, 1]; region box box [0, 1] x [0, 1] m;
  target with polytope { x <= 1; -x <= 0; y <= 1; -y <= 0 }; }
task module { robot grammar; workspace plane; start in box at rest; reach with;
  avoid box, with with body margin 1 cm; effort <= 1 N*m; horizon 3 steps of 1 s; }
"""
    assert check_fragment(text) == []


@pytest.mark.parametrize("word", ["and", "or", "not", "empty", "this", "world", "accept", "x"])
def test_reserved_words(word: str, check: Check) -> None:
    assert check(f"module {word} {{ role base; }}") == [("SYNTAX", word)]


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("module A { role base }", ("SYNTAX", " ")),
        ("module A { role base\n}", ("SYNTAX", "\n")),
        ("module A { role base;", ("SYNTAX", "")),
        ("module A { rol base; }", ("SYNTAX", "rol")),
        ("module A { role base; } }", ("SYNTAX", "}")),
        ("workspace W { planexy; }", ("SYNTAX", "planexy")),
        ("module A { const c = 3 furlong; }", ("UNKNOWN_UNIT", "furlong")),
        ("module A { const c = 3 kgs; }", ("UNKNOWN_UNIT", "kgs")),
        ("module A { const c = @; }", ("UNEXPECTED_CHARACTER", "@")),
        ("module É { role base; }", ("UNEXPECTED_CHARACTER", "É")),
        ("edge 'a;", ("UNEXPECTED_CHARACTER", "'")),
        ("module A { role base; } /* ", ("SYNTAX", "/*")),
        ("edge 'a b';", ("SYNTAX", "'a b'")),
        ("nonsense", ("SYNTAX", "nonsense")),
    ],
)
def test_syntax_errors(text: str, found: tuple[str, str], check: Check) -> None:
    assert check(text) == [found]


@pytest.mark.parametrize(
    ("clause", "advised", "followed"),
    [
        ("effort <= 10 Nm;", "`N*m`", "effort <= 10 N*m;"),
        ("horizon 10 s;", "`horizon 10 steps of 0.2 s`", "horizon 10 steps of 0.2 s;"),
        ("horizon 10 s steps 80;", "`horizon 10 steps of 0.2 s`", "horizon 10 steps of 0.2 s;"),
        ("horizon 10 stps of 2 s;", "`steps`", "horizon 10 steps of 2 s;"),
        ("horizon at most 10 s;", "`horizon 10 steps of 0.2 s`", "horizon at most 2 steps of 2 s;"),
        ("horizon at least 5 steps of 1 s;", "for any number", "horizon at most 5 steps of 1 s;"),
        ("horizon at 5 steps of 1 s;", "`horizon at most 10", "horizon at most 5 steps of 1 s;"),
        ("horizon at moist 5 steps of 1 s;", "`most`", "horizon at most 5 steps of 1 s;"),
        ("horizon most 5 steps of 1 s;", "`horizon at most 10", "horizon at most 5 steps of 1 s;"),
        ("horizon up to 5 steps of 1 s;", "`horizon at most 10", "horizon at most 5 steps of 1 s;"),
        ("horizon <= 5 steps of 1 s;", "`horizon at most 10", "horizon at most 5 steps of 1 s;"),
        ("horizon at most;", "`horizon at most 10", "horizon at most 5 steps of 1 s;"),
        ("start at S;", "`start in` a region", "start in S;"),
        ("avoid self collisions;", "`avoid self with body;`", "avoid self with body;"),
        ("reach T for 1 s at rest;", "`reach T at rest for 0.5 s;`", "reach T at rest for 1 s;"),
        ("reach in T;", "`reach T`", "reach T;"),
        ("avoid self with body, except L;", "in pairs", "avoid self with body;"),
        ("avoid self with body except;", "in pairs", "avoid self with body;"),
        (
            "avoid self with body, except L L, margin 2 mm;",
            "before `except`",
            "avoid self with body, margin 2 mm;",
        ),
    ],
)
def test_habits_of_other_notations_get_a_hint_that_helps(
    clause: str, advised: str, followed: str, build: Callable[..., str], check_fragment: Check
) -> None:
    clauses = {"start": "start in S;", "reach": "reach T;", "effort": "effort <= 10 N*m;"}
    clauses["horizon"] = "horizon 80 steps of 0.125 s;"

    def spec(text: str) -> str:
        task = " ".join((clauses | {clause.split(maxsplit=1)[0]: text}).values())
        return build(task=f"task P {{ robot G; workspace W; {task} }}")

    hints = [diagnostic.hint or "" for diagnostic in load_text(spec(clause), "t.srg").diagnostics]
    assert any(advised in hint for hint in hints), hints
    assert not check_fragment(spec(followed))


@pytest.mark.parametrize(
    ("text", "advised"),
    [
        ("module L { role link; param length in [30, 40, 50] cm; }", "`{30, 40, 50} cm`"),
        ("module L { role joint; dof q: revolute z acceleration <= 2 rad/s^2; }", "`accel`"),
        ("module L { role joint; dof q: revolute z in [0, 1] rad speed in [0, 1]; }", "`rate`"),
        ("workspace W { plane xy; obstacle O polygon (0, 0), (1, 0), (0, 1) m; }", "`hull`"),
        ("task P { avoid A, B margin 1 cm; }", "`with effector` or `with body`"),
    ],
)
def test_words_and_brackets_of_other_notations(text: str, advised: str) -> None:
    hints = [diagnostic.hint or "" for diagnostic in load_text(text, "t.srg").diagnostics]
    assert any(advised in hint for hint in hints), hints


@pytest.mark.parametrize(
    ("limit", "advised"),
    [
        ("torque <= 5 N*m", "did you mean `effort`? write `effort <= 5 N*m`"),
        ("speed in [-1, 1] rad/s", "did you mean `rate`? write `rate in [-1, 1] rad/s`"),
        ("torque [-5, 5] N*m", "did you mean `effort`?"),
    ],
)
def test_a_limit_by_another_name_is_one_error(limit: str, advised: str) -> None:
    text = f"module M {{ role joint; dof q: revolute z in [-1, 1] rad {limit}; const c = 1; }}"
    assert [each.hint for each in load_text(text, "t.srg").diagnostics] == [advised]
    whole = advised.partition("write `")[2].strip("`")
    if whole:
        assert not load_text(text.replace(limit, whole), "t.srg").diagnostics


def test_a_torque_after_a_missing_semicolon_is_a_torque() -> None:
    text = "module M { role joint; dof q: revolute z torque(q) = 2 N*m; }"
    (found,) = load_text(text, "t.srg").diagnostics
    assert (found.message, found.hint) == ("expected `;`", "add the `;`")


@pytest.mark.parametrize("name", ["x", "y"])
def test_a_joint_that_is_called_like_an_axis_is_one_error(name: str) -> None:
    text = f"""module M {{ role link; dof {name}: prismatic x in [-1, 1] m; port in: F; port out: F;
      frame out = in * move(x, {name}); }}"""
    (found,) = load_text(text, "t.srg").diagnostics
    assert found.hint == f"`{name}` is reserved; choose another name, such as `p{name}`"
    followed = text.replace(f" {name}:", f" p{name}:").replace(f", {name})", f", p{name})")
    assert not load_text(followed, "t.srg").diagnostics


def test_chained_inequalities_are_to_be_split() -> None:
    workspace = "workspace W { plane xy; bounds polytope { 0 <= x <= 1; y >= 0; y <= 1 } m; }"
    (found,) = load_text(workspace, "t.srg").diagnostics
    assert found.hint is not None
    assert "two" in found.hint


@pytest.mark.parametrize(
    "shape", ["polytope x >= 0, y >= 0", "polytope { x + y <= 1 m, x >= 0 m, y >= 0 m }"]
)
def test_inequalities_are_in_braces_with_semicolons_between(shape: str) -> None:
    workspace = f"workspace W {{ plane xy; bounds box [0, 1] x [0, 1] m; region S {shape}; }}"
    (found,) = load_text(workspace, "t.srg").diagnostics
    advised = re.search(r"`(polytope .*) m`", found.hint or "")
    assert advised is not None
    followed = workspace.replace(shape, f"{advised[1]} m")
    assert not load_text(followed, "t.srg").diagnostics


def test_every_broken_item_is_reported(check: Check) -> None:
    text = "module A { role ; }\nmodule B { role base; }\nedge ,;\ntask T { robot ; }"
    assert check(text) == [("SYNTAX", ";"), ("SYNTAX", ","), ("SYNTAX", ";")]


@pytest.mark.parametrize(
    "expression",
    ["(" * 10_000 + "1" + ")" * 10_000, "-" * 10_000 + "1", "1" + "+1" * 10_000, "(" * 10_000],
)
def test_deep_nesting_is_no_recursion_error(expression: str, check: Check) -> None:
    found = check(f"module A {{ role base; const c = {expression}; }}")
    assert [code for code, _ in found] in ([], ["TOO_DEEP"], ["SYNTAX"])


def test_deep_conditions(check: Check, build: Callable[..., str]) -> None:
    accept = "accept " + "not " * 10_000 + "contains B;"
    grammar = "grammar G { start N; a: N -> B; " + accept + " }"
    found = check(build(grammar=grammar, semantics="", task=""))
    assert [code for code, _ in found] == ["TOO_DEEP"]


def test_a_file_of_errors_is_not_read_to_its_end() -> None:
    """What follows is not known to be wrong: its names are noted, so that nobody misses them."""
    sink = Sink()
    file = parse("module A { role; }\n" * 200 + "module Late { role base; }", sink)
    assert len(sink.found) == 100
    assert "Late" in file.skipped
    assert len(file.broken) == 101


def test_an_item_of_errors_is_not_read_to_its_end() -> None:
    sink = Sink()
    file = parse("module A {" + "role;" * 200 + "const late = 1; }\nedge e;", sink)
    assert len(sink.found) == 100
    assert "late" in file.skipped
    assert not file.items


def test_junk_between_items_is_one_span() -> None:
    text = "; ; role base; } module A { role base; } ;;;"
    file = parse(text, Sink())
    assert [text[s.start : s.end] for s in file.broken] == ["; ; role base; }", ";;;"]
    assert file.skipped == {"role", "base"}
