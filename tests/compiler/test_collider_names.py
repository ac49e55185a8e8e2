"""Bodies of productions with several modules: no report says that one module owns them."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

from compiler.robots.collider_names import collider_names
from compiler.robots.normal_form import RobotFamily
from grammar_lang.load import load_text
from srgc.session import check_loaded

CART = """module Rail { role base; }
module Cart { role joint; dof s: prismatic x in [-1, 1] m; }
module Mast { role link; const height = 2 m; }
module Swivel { role joint; dof q: revolute z in [-2, 2] rad; }
module Boom { role link; const length = 1 m; }
module Tip { role effector; }
grammar Crane {
  start R;
  all: R -> Rail Cart Mast A;
  one: A -> Swivel Boom A;
  end: A -> Tip;
  accept count(Swivel) == 2;
}
semantics Crane {
  all {
    let cart = move(x, Cart.s);
    box(frame: cart, size: (20, 20, 10) cm);
    point(frame: cart, mass: 2 kg);
    rod(frame: cart, axis: z, length: Mast.height, density: 1 kg/m);
    A.at = cart * move(z, 1 m);
  }
  one {
    let turned = this.at * rot(z, Swivel.q);
    rod(frame: turned, axis: x, length: Boom.length, density: 1 kg/m);
    A.at = turned * move(x, Boom.length);
  }
  end { sphere(frame: this.at, radius: 3 cm); effector(frame: this.at); }
}
workspace Hall {
  space xyz;
  bounds box [-9, 9] x [-9, 9] x [-9, 9] m;
  region S box [1, 2] x [1, 2] x [0, 1] m;
  target T box [-2, -1] x [1, 2] x [0, 1] m;
}
task Go {
  robot Crane; workspace Hall; start in S; reach T;
  avoid self with body;
  effort <= 9 N*m; effort <= 9 N; horizon 9 steps of 0.1 s;
}
"""
BARE = CART.replace("length: Mast.height", "length: 2 m").replace(
    "length: Boom.length, d", "length: 1 m, d"
)
"""Only the sphere of the tip has one owner."""


def names(text: str, word: str, folder: Path | None = None) -> tuple[str, ...]:
    program = load_text(text, "crane.srg", folder).program
    assert program is not None
    grammar = program.grammars["Crane"]
    family = RobotFamily(program, grammar, 3)
    derivation = family.replay(("all", *["one"] * word.count("Boom"), "end"))
    assert " ".join(derivation.word) == word
    return collider_names(program, grammar, derivation, family.built(derivation))


def findings(text: str, code: str) -> list[tuple[str, str]]:
    found = check_loaded(load_text(text, "crane.srg")).diagnostics
    return [(each.message, str(each.hint)) for each in found if each.code.value == code]


def test_several_possible_owners_are_told_with_kind_and_line() -> None:
    assert names(CART, "Rail Cart Mast Swivel Boom Swivel Boom Tip") == (
        "body 2 (Mast at symbol 2)",
        "body 3 (Boom at symbol 4)",
        "body 4 (Boom at symbol 6)",
        "shape 1 (box in line 17, of Rail or Cart or Mast)",
        "shape 2 (Tip at symbol 7)",
    )
    bare = names(BARE, "Rail Cart Mast Swivel Boom Swivel Boom Tip")
    assert bare[:2] == (
        "body 2 (rod in line 19, of Rail or Cart or Mast)",
        "body 3 (rod in line 24, of Swivel or Boom)",
    )


def test_an_included_file_is_named(tmp_path: Path) -> None:
    """Without its name, the line would be looked for in the main file."""
    kit, rest = CART.split("workspace Hall", 1)
    (tmp_path / "kit.srg").write_text(kit, encoding="utf-8")
    text = f'include "kit.srg";\nworkspace Hall{rest}'
    told = names(text, "Rail Cart Mast Tip", tmp_path)
    assert told[1] == "shape 1 (box in line 17 of kit.srg, of Rail or Cart or Mast)"


def test_the_hint_recommends_nothing_that_is_refused() -> None:
    longer = CART.replace("count(Swivel) == 2", "count(Swivel) == 3")
    ((said, hint),) = findings(longer, "SRG0718")
    assert "shape 1 (box in line 17, of Rail or Cart or Mast)" in said
    assert "but not `Cart`, `Mast` and `Rail`: it is not clear which bodies are theirs" in hint
    named = longer.replace("avoid self with body", "avoid self with body, except Boom Boom")
    assert findings(named, "SRG0715") == []
    refused = longer.replace("avoid self with body", "avoid self with body, except Boom Mast")
    assert findings(refused, "SRG0715") != []


def test_without_any_pair_to_name_there_is_no_such_hint() -> None:
    ((_, hint),) = findings(BARE, "SRG0718")
    assert hint.startswith("`except` can add no pair here")
    pairs = re.findall(r"[A-Z]\w+", "Rail Cart Mast Swivel Boom")
    for module in pairs:
        text = BARE.replace("avoid self with body", f"avoid self with body, except Tip {module}")
        assert findings(text, "SRG0715") != []


@pytest.mark.parametrize("count", [1, 2])
def test_clear_owners_are_named_as_before(count: int) -> None:
    word = "Rail Cart Mast " + "Swivel Boom " * count + "Tip"
    told = names(CART, word)
    assert [each for each in told if "Boom" in each] == [
        f"body {3 + i} (Boom at symbol {4 + 2 * i})" for i in range(count)
    ]
