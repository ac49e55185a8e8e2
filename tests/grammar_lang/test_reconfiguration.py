from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import pytest

from grammar_lang import ir
from grammar_lang.load import load_text

Check = Callable[[str], list[tuple[str, str]]]
Build = Callable[..., str]

TASK = """
task P {{
  robot G; workspace W; start in S; reach T; effort <= 10 N*m; horizon 80 steps of 0.125 s;
  from {};
}}
"""
MODULES = """
module B  { role base; }
module JO { role joint; dof q: revolute z in [-180, 180] deg; }
module L  { role link; param length in [0.5, 5] m; param bend in [0, 90] deg;
            param bore in {20, 25, 30} mm; const density = 1 kg/m; }
module EN { role effector; }
edge eps, '[', ']';
"""


@pytest.fixture(scope="session")
def origin(build: Build) -> Callable[[str], ir.Origin]:
    def make(text: str) -> ir.Origin:
        loaded = load_text(build(modules=MODULES, task=TASK.format(text)), "t")
        assert loaded.program is not None, loaded.diagnostics
        found = loaded.program.tasks["P"].origin
        assert found is not None
        return found

    return make


def number(value: Fraction) -> ir.Expr:
    return ir.Num(value)


def test_a_word(origin: Callable[[str], ir.Origin]) -> None:
    assert origin("B eps JO '['") == ir.Origin(("B", "eps", "JO", "["), ())


def test_fixed_parameters(origin: Callable[[str], ir.Origin]) -> None:
    found = origin("B eps L eps JO eps L fixed L1.length = 2 m, L2.length = 50 cm, L2.bore = 0.03")
    assert found.word == ("B", "eps", "L", "eps", "JO", "eps", "L")
    assert found.fixed == (
        ir.Fixed(2, "length", number(Fraction(2))),
        ir.Fixed(6, "length", number(Fraction(1, 2))),
        ir.Fixed(6, "bore", number(Fraction(3, 100))),
    )
    [alone] = origin("B eps L fixed L.bend = 90 deg").fixed
    assert alone == ir.Fixed(2, "bend", ir.Binary("*", ir.Num(Fraction(1, 2)), ir.Pi()))
    ends = origin("B eps L fixed L.length = 0.5, L.bend = 0").fixed
    assert [fixed.value for fixed in ends] == [number(Fraction(1, 2)), number(Fraction(0))]


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("B eps X", [("UNKNOWN_NAME", "X")]),
        ("B eps N", [("WRONG_KIND", "N")]),
        ("B eps S", [("WRONG_KIND", "S")]),
        ("B L fixed M.length = 1", [("UNKNOWN_NAME", "M")]),
        ("B L L fixed L.length = 1", [("AMBIGUOUS_OCCURRENCE", "L")]),
        ("B L L fixed L3.length = 1", [("UNKNOWN_NAME", "L3")]),
        ("B L fixed L1.length = 1", [("UNKNOWN_NAME", "L1")]),
        ("B eps fixed eps.length = 1", [("WRONG_KIND", "eps")]),
        ("B L fixed L.lenght = 1", [("UNKNOWN_NAME", "lenght")]),
        ("B L fixed L.density = 1", [("WRONG_KIND", "density")]),
        ("B JO fixed JO.q = 1", [("WRONG_KIND", "q")]),
        ("B L fixed L.length = 1 kg", [("UNIT_MISMATCH", "1 kg")]),
        ("B L fixed L.length = 20 cm", [("BAD_VALUE", "20 cm")]),
        ("B L fixed L.length = 5.01", [("BAD_VALUE", "5.01")]),
        ("B L fixed L.bend = 91 deg", [("BAD_VALUE", "91 deg")]),
        ("B L fixed L.bend = 45", [("ANGLE_ABOVE_TURN", "45"), ("BAD_VALUE", "45")]),
        ("B L fixed L.bore = 22 mm", [("BAD_VALUE", "22 mm")]),
        ("B L fixed L.length = 1, L.length = 1", [("DUPLICATE_NAME", "L.length = 1")]),
        ("B L L fixed L1.length = 9, L2.length = 0", [("BAD_VALUE", "9"), ("BAD_VALUE", "0")]),
    ],
)
def test_findings(
    text: str, found: list[tuple[str, str]], check_fragment: Check, build: Build
) -> None:
    assert check_fragment(build(modules=MODULES, task=TASK.format(text))) == found


def test_a_number_that_is_a_name(check_fragment: Check, build: Build) -> None:
    modules = MODULES + "module L1 { role link; param length in [1, 2] m; }"
    grammar = """
grammar G {
  start N;
  base: N -> B;  joint: N -> N JO;  link: N -> N L;  one: N -> N L1;  tool: N -> N EN;
}"""
    semantics = """
semantics G {
  base { this.frame = world; } joint { this.frame = N.frame * rot(z, JO.q); }
  link { this.frame = N.frame * move(x, L.length); } tool { effector(frame: N.frame); }
  one { this.frame = N.frame * move(x, L1.length); }
}"""
    parts = {"modules": modules, "grammar": grammar, "semantics": semantics}

    def found(text: str) -> list[tuple[str, str]]:
        text = build(**parts, task=TASK.format(text))
        return [entry for entry in check_fragment(text) if entry[0] != "UNDEFINED_ATTRIBUTE"]

    assert found("B L L fixed L2.length = 1") == [("DUPLICATE_NAME", "L")]
    assert found("B L L") == []
    assert found("B L L1 fixed L1.length = 1") == []
