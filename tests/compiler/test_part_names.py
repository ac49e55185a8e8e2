"""Names of links, joints and effectors: after modules, each once."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import pytest

from compiler.rigid_links.rigid_tree import rigid_tree
from compiler.robots.labelled_graph import labelled_graph
from compiler.robots.normal_form import RobotFamily
from compiler.words.derivation import replay
from grammar_lang import ir
from grammar_lang.load import load
from srgc.exports.exported_robot import PartNames, effector_modules, part_names

HEADER = """\
module B { role base; }
module J { role joint; dof q: revolute z; }
module U { role joint; dof a: revolute x; dof b: revolute y; }
module L { role link; const length = 2 m; }
module S { role link; const mass = 1 kg; }
module EN { role effector; }
"""
CHAIN = """\
grammar Chain {
  start N;
  base: N -> B;
  joint: N -> N J;
  cross: N -> N U;
  link: N -> N L;
  stone: N -> N S;
  tool: N -> N EN;
}
semantics Chain {
  base { this.frame = world; }
  joint { this.frame = N.frame * rot(z, J.q); }
  cross { this.frame = N.frame * rot(x, U.a) * rot(y, U.b); }
  link {
    this.frame = N.frame * move(x, L.length);
    rod(frame: N.frame, axis: x, length: L.length, density: 1);
  }
  stone { this.frame = N.frame; point(frame: N.frame, mass: S.mass); }
  tool { this.frame = N.frame; effector(frame: N.frame); TOOL }
}
"""


def names(tmp_path: Path, labels: Sequence[str], extra: str = "") -> PartNames:
    return names_in(tmp_path, HEADER + CHAIN.replace("TOOL", extra), "Chain", labels)


def names_in(tmp_path: Path, text: str, name: str, labels: Sequence[str]) -> PartNames:
    path = tmp_path / "robot.srg"
    path.write_text(text, encoding="utf-8")
    loaded = load(path)
    assert loaded.program is not None, loaded.diagnostics
    program: ir.Program = loaded.program
    grammar = program.grammars[name]
    derivation = replay(grammar, tuple(labels))
    model = RobotFamily(program, grammar, 3).robot(derivation)
    tree = rigid_tree(model, ())
    graph = labelled_graph(program, grammar, derivation)
    tools = effector_modules(derivation, grammar.semantics or {}, program.modules)
    assert len(tools) == len(tree.effectors)
    return part_names(model, tree, graph, program.modules, tools)


def test_a_link_is_called_after_its_first_link_module(tmp_path: Path) -> None:
    found = names(tmp_path, ["tool", "link", "link", "stone", "joint", "link", "joint", "base"])
    # B J L J S L L EN
    assert found == PartNames(("B_0", "L_2", "S_4"), ("J_1", "J_3"), ("EN_7",))


def test_two_degrees_of_freedom_of_one_module(tmp_path: Path) -> None:
    found = names(tmp_path, ["tool", "link", "cross", "base"])
    # B U L EN: the link between the two has no module of its own.
    assert found == PartNames(("B_0", "U_1_a_link", "L_2"), ("U_1_a", "U_1_b"), ("EN_3",))


def test_merged_joints_have_both_names(tmp_path: Path) -> None:
    found = names(tmp_path, ["tool", "link", "joint", "joint", "link", "base"])
    assert found.joints == ("J_2_J_3",)
    assert found.links == ("B_0", "L_4")


def test_effectors_that_are_not_one_per_module(tmp_path: Path) -> None:
    twice = "effector(frame: N.frame * move(y, 1 m));"
    found = names(tmp_path, ["tool", "link", "joint", "base"], twice)
    assert found.effectors == ("effector_1", "effector_2")


TWO_TOOLS = """\
module B { role base; }
module J { role joint; dof q: revolute z; }
module F { role effector; }
module E { role effector; }
edge '[', ']';
grammar G { start R; both: R -> B J X E; go: X -> F; }
semantics G {
  both {
    this.a = this.frame * rot(z, J.q);
    point(frame: this.a * move(x, 0.2), mass: 3);
    X.at = this.a * move(x, 1);
    FIRST
  }
  go { SECOND }
}
"""
AT_TWO = "effector(frame: this.a * move(x, 2));"
AT_ONE = "effector(frame: this.at);"


@pytest.mark.parametrize(
    ("first", "second", "expected"),
    [
        # Emitted by the production whose first module is B: number 1, though F is before E.
        (AT_TWO, AT_ONE, ("E_3", "F_2")),
        # As many effectors as effector modules, but which is whose?
        (AT_TWO + AT_TWO.replace("2)", "3)"), "", ("effector_1", "effector_2")),
        ("", AT_ONE + "effector(frame: this.at * move(y, 1));", ("effector_1", "effector_2")),
        (AT_TWO + AT_TWO.replace("2)", "3)"), AT_ONE, ("effector_1", "effector_2", "F_2")),
        ("", AT_ONE, ("F_2",)),
    ],
)
def test_an_effector_is_called_after_the_module_of_its_production(
    tmp_path: Path, first: str, second: str, expected: tuple[str, ...]
) -> None:
    text = TWO_TOOLS.replace("FIRST", first).replace("SECOND", second)
    assert names_in(tmp_path, text, "G", ["both", "go"]).effectors == expected


def test_effectors_of_productions_without_modules_of_their_own(tmp_path: Path) -> None:
    """Numbered by the first module of the production, else its first edge, else at the end."""
    text = TWO_TOOLS.replace(
        "B J X E; go: X -> F;", "Y B J X F E; go: X -> '[' ']'; no: Y -> empty;"
    )
    text = text.replace("FIRST", AT_TWO + "Y.at = this.a;").replace("SECOND", AT_ONE)
    text = text.replace("  go {", "  no { effector(frame: this.at); }\n  go {")
    found = names_in(tmp_path, text, "G", ["both", "no", "go"])
    # Two modules for the one effector of `both`; `no` derives the empty word and comes last.
    assert found.effectors == ("effector_1", "effector_2", "effector_3")
