"""In what modules are built otherwise in another spec, and what makes no difference."""

from __future__ import annotations

import pytest

from compiler.missions.module_differences import ModuleDifference, module_differences
from grammar_lang import ir
from grammar_lang.load import load_text
from srgc.session import check_loaded
from tests.oracles.small_specs import replaced

KIT = """\
module Base { role base; port out: Socket; frame out = in; }
module Limb { role link; dof q: revolute z in [-150, 150] deg; param length in [0.5, 1.5] m;
              port in: Socket; frame joint = in * rot(z, q);
              port out: Socket; frame out = joint * move(x, length);
              rod(frame: joint, axis: x, length: length, density: 1 kg/m); }
module Hand { role effector; port in: Socket; effector(frame: in); }
grammar Arm from ports { start Base; with Limb, Hand; }
"""
FOOT = "module Foot { role effector; port in: Socket; effector(frame: in); }"
LABELS = ("Base", "Limb", "Hand")

WRITTEN = """\
module B { role base; }
module JO { role joint; dof q: revolute z in [-160, 160] deg; }
module L { role link; const length = 0.5 m; const density = 1 kg/m; }
module EN { role effector; }
edge eps;
grammar Arm {
  start N;
  base: N -> B;
  joint: N -> N eps JO eps L;
  tool: N -> N eps EN;
}
semantics Arm {
  base { this.frame = world; }
  joint {
    let turned = N.frame * rot(z, JO.q);
    this.frame = turned * move(x, L.length);
    rod(frame: turned, axis: x, length: L.length, density: L.density);
  }
  tool { this.frame = N.frame; effector(frame: N.frame); }
}
"""


def family(text: str) -> tuple[ir.Program, ir.Grammar]:
    checked = check_loaded(load_text(text, "spec.srg"))
    assert checked.program is not None, checked.diagnostics
    return checked.program, checked.program.grammars["Arm"]


def told(text: str, *changes: str) -> dict[str, tuple[str, ...]]:
    """What differs after replacements, each of a text by the next one."""
    other = text
    for old, new in zip(changes[::2], changes[1::2], strict=True):
        other = replaced(other, old, new)
    before, after = family(text), family(other)
    labels = [production.label for production in before[1].productions]
    found = module_differences([*before[0].modules], labels, before, after)
    return {each.module: each.what for each in found}


@pytest.mark.parametrize(
    ("changes", "what"),
    [
        (("density: 1 kg/m", "density: 2 kg/m"), ("bodies",)),
        (("[0.5, 1.5] m", "[0.5, 2] m"), ("parameter length",)),
        (("[0.5, 1.5] m", "{0.5, 1.5} m"), ("parameter length",)),
        (("[-150, 150] deg", "[-90, 90] deg"), ("degree of freedom q",)),
        (("deg; param", "deg effort <= 5 N*m; param"), ("degree of freedom q",)),
        (("dof q:", "dof p:", "rot(z, q)", "rot(z, p)"),
         ("degree of freedom q", "degree of freedom p", "frames")),
        (("joint * move(x, length)", "joint * move(x, 2 * length)"), ("frames",)),
        (("density: 1 kg/m);", "density: 1 kg/m); sphere(frame: joint, radius: 2 cm);"),
         ("shapes",)),
        (("role link", "role joint"), ("role",)),
    ],
    ids=str,
)  # fmt: skip
def test_of_a_module_with_ports(changes: tuple[str, ...], what: tuple[str, ...]) -> None:
    assert told(KIT, *changes) == {"Limb": what}


def test_a_port_of_another_type_is_another_one() -> None:
    """What a limb carries is no hand any more: limb and hand have other ports."""
    found = told(
        KIT, "port out: Socket; frame out = joint", "port out: Wrist; frame out = joint",
        "effector; port in: Socket", "effector; port in: Wrist",
    )  # fmt: skip
    assert found == {"Limb": ("ports",), "Hand": ("ports",)}


@pytest.mark.parametrize(
    "changes",
    [
        ("module Limb {", "// another one\nmodule  Limb  {"),
        ("[0.5, 1.5] m", "[50, 150] cm"),
        ("1 kg/m", "1000 g/m"),
        ("frame joint =", "frame axis_ =", "joint * move", "axis_ * move", "frame: joint",
         "frame: axis_"),
        ("grammar Arm", f"{FOOT}\ngrammar Arm", "Limb, Hand;", "Foot, Limb, Hand;"),
    ],
    ids=str,
)  # fmt: skip
def test_what_makes_no_difference(changes: tuple[str, ...]) -> None:
    assert told(KIT, *changes) == {}


@pytest.mark.parametrize(
    ("changes", "found"),
    [
        (("density = 1 kg/m", "density = 2 kg/m"), {"L": ("bodies",)}),
        (("length = 0.5 m", "length = 0.6 m"), {"L": ("frames", "bodies")}),
        (("rot(z, JO.q)", "rot(z, 10 deg) * rot(z, JO.q)"), {"JO": ("frames",)}),
        (("tool: N -> N eps EN", "tool: N -> N EN"), {"EN": ("production",)}),
    ],
    ids=str,
)
def test_rules_of_written_grammars_belong_to_whom_they_name(
    changes: tuple[str, ...], found: dict[str, tuple[str, ...]]
) -> None:
    assert told(WRITTEN, *changes) == found


def test_other_nonterminals_labels_and_further_productions_make_no_difference() -> None:
    text = WRITTEN.replace("N.frame", "A.frame").replace("N ->", "A ->").replace("> N", "> A")
    text = text.replace("start N", "start A").replace("tool", "hand")
    text = replaced(text, "  hand: ", "  link: A -> A eps L;\n  hand: ")
    text = replaced(text, "  hand {", "  link { this.frame = A.frame * move(x, 2 m); }\n  hand {")
    before, after = family(WRITTEN), family(text)
    modules = [*before[0].modules]
    assert module_differences(modules, ("base", "joint", "tool"), before, after) == ()


def test_a_module_that_the_grammar_leaves_out_cannot_be_kept() -> None:
    assert told(KIT, "with Limb, Hand", "with Hand") == {}


def test_a_kit_and_what_its_ports_stand_for_are_the_same() -> None:
    """The grammar that `srgc expand` shows of it."""
    kit = replaced(
        KIT, "grammar Arm from ports { start Base; with Limb, Hand; }",
        """grammar Arm { start R; a: R -> Base S; b: S -> Limb S; c: S -> Hand; }
        semantics Arm {
          a { Base.in = this.frame; S.frame = Base.out; }
          b { Limb.in = this.frame; S.frame = Limb.out; }
          c { Hand.in = this.frame; }
        }""",
    )  # fmt: skip
    before, after = family(KIT), family(kit)
    assert module_differences(LABELS, LABELS, before, after) == ()
    heavy = family(replaced(kit, "1 kg/m", "2 kg/m"))
    assert module_differences(LABELS, LABELS, before, heavy) == (
        ModuleDifference("Limb", ("bodies",)),
    )
