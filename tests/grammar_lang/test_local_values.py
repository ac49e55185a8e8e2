"""`let`: values with names in a block of a semantics."""

from __future__ import annotations

from fractions import Fraction

import pytest

from compiler.robots.attributes import evaluate
from compiler.robots.normal_form import normalise
from compiler.robots.robot_key import robot_key
from compiler.words.language import language
from compiler.words.structures import structures
from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code
from grammar_lang.load import load_text

MODULES = """
module B { role base; }
module L { role link; dof q: revolute z in [-90, 90] deg; param length in [0.3, 0.8] m; }
module E { role effector; }
grammar G { start S; base: N -> B; limb: N -> N L; hand: S -> N E; }
"""
WITH = """
semantics G {
  base { this.at = world; }
  limb {
    let density = 1.5 kg/m;
    let joint = N.at * rot(z, L.q);
    let tip = joint * move(x, L.length);
    let half = L.length / 2;
    this.at = tip * rot(z, turn);
    let turn = 30 deg;
    rod(frame: joint, axis: x, length: half, density: 2 * density);
  }
  hand { effector(frame: N.at); }
}
"""
WITHOUT = """
semantics G {
  base { this.at = world; this.joint = world; }
  limb {
    this.joint = N.at * rot(z, L.q);
    this.at = this.joint * move(x, L.length) * rot(z, 30 deg);
    rod(frame: this.joint, axis: x, length: L.length / 2, density: 3 kg/m);
  }
  hand { effector(frame: N.at); }
}
"""


def keys(text: str) -> list[str]:
    """The robots of four words in normal form."""
    program = load_text(MODULES + text, "t").program
    assert program is not None
    grammar = program.grammars["G"]
    assert grammar.semantics is not None
    words = language(grammar, program.terminals, program.modules)
    return [
        robot_key(normalise(evaluate(found, program.modules, grammar.semantics, 2)))
        for found, _ in zip(structures(words, 6), range(4), strict=False)
    ]


def test_a_block_with_local_values_is_the_robot_without() -> None:
    assert keys(WITH) == keys(WITHOUT)
    assert len(set(keys(WITH))) == 4


def test_numbers_are_put_in_and_frames_are_not() -> None:
    """A constant stays one, so that it may stand where one is expected; a joint occurs once."""
    program = load_text(MODULES + WITH, "t").program
    assert program is not None
    block = (program.grammars["G"].semantics or {})["limb"]
    (rod,) = block.emissions
    assert isinstance(rod, ir.Rod)
    assert rod.density == ir.Num(Fraction(3))
    assert rod.frame == ir.AttributeOf(ir.LOCAL, "joint")
    targets = [rule.target for rule in block.rules]
    assert ir.AttributeOf(ir.LOCAL, "tip") in targets


@pytest.mark.parametrize(
    ("limb", "code", "at"),
    [
        ("let f = f; this.at = f * rot(z, L.q);", Code.CIRCULAR_ATTRIBUTES, "let f = f;"),
        ("let f = 1; let f = 2; this.at = N.at;", Code.DOUBLE_ATTRIBUTE, "f"),
        ("this.at = N.at * g;", Code.UNKNOWN_NAME, "g"),
        ("let f = 2 m; this.at = N.at * f;", Code.SORT_MISMATCH, "f"),
        ("let f = 2 m; this.at = N.at * rot(z, f);", Code.UNIT_MISMATCH, "f"),
        (
            "let a = b; let b = a; this.at = N.at * rot(z, L.q);",
            Code.CIRCULAR_ATTRIBUTES,
            "let a = b;",
        ),
        ("let q = L.q; this.at = N.at;", Code.BAD_DOF_USE, "L.q"),
    ],
)
def test_mistakes(limb: str, code: Code, at: str) -> None:
    text = MODULES + WITHOUT.replace("this.joint = world;", "")
    start, end = text.index("limb {") + 6, text.index("hand {")
    text = f"{text[:start]} {limb} }} {text[end:]}"
    found = load_text(text, "t").diagnostics
    assert (code, at) in [(d.code, text[d.span.start : d.span.end]) for d in found]


def test_one_that_nobody_reads_is_warned_of() -> None:
    text = MODULES + WITHOUT.replace("limb {", "limb { let idle = 3 m;")
    (found,) = load_text(text, "t").diagnostics
    assert found.code is Code.UNUSED_NAME
    assert text[found.span.start : found.span.end] == "idle"


def test_a_local_value_is_seen_in_its_own_block_only() -> None:
    text = MODULES + WITHOUT.replace("base {", "base { let f = 1;").replace("30 deg", "f")
    codes = [d.code for d in load_text(text, "t").diagnostics]
    assert Code.UNKNOWN_NAME in codes


def test_let_is_a_name_elsewhere() -> None:
    text = """
    module B { role base; const let = 2 m; const more = 2 * let; }
    module E { role effector; }
    grammar G { start S; all: S -> B let; tip: let -> E; }
    semantics G {
      all { let.let = world * move(x, B.let) * move(y, B.more); }
      tip { let let = this.let; effector(frame: let); }
    }
    """
    assert not [d for d in load_text(text, "t").diagnostics if d.code is not Code.FINITE_LANGUAGE]
