"""Names of links, joints and effectors: after modules, each once."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from compiler.grammars.derivation import replay
from compiler.graphs.labelled_graph import labelled_graph
from compiler.rigid_links.part_names import PartNames, part_names
from compiler.rigid_links.rigid_tree import rigid_tree
from compiler.semantics.family import RobotFamily
from grammar_lang import ir
from grammar_lang.load import load

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
    path = tmp_path / "robot.srg"
    path.write_text(HEADER + CHAIN.replace("TOOL", extra), encoding="utf-8")
    loaded = load(path)
    assert loaded.program is not None, loaded.diagnostics
    program: ir.Program = loaded.program
    grammar = program.grammars["Chain"]
    derivation = replay(grammar, tuple(labels))
    model = RobotFamily(program, grammar, 3).robot(derivation)
    tree = rigid_tree(model, ())
    graph = labelled_graph(program, grammar, derivation)
    return part_names(model, tree, graph, program.modules)


def test_a_link_is_called_after_its_first_link_module(tmp_path: Path) -> None:
    found = names(tmp_path, ["tool", "link", "link", "stone", "joint", "link", "joint", "base"])
    # B J L J S L L EN
    assert found == PartNames(("B_0", "L_2", "S_4"), ("J_1", "J_3"), ("EN_7",))


def test_two_degrees_of_freedom_of_one_module(tmp_path: Path) -> None:
    found = names(tmp_path, ["tool", "link", "cross", "base"])
    # B U L EN: the link between the two has no module of its own.
    assert found == PartNames(("B_0", "U_1_link", "L_2"), ("U_1", "U_1_no2"), ("EN_3",))


def test_merged_joints_have_both_names(tmp_path: Path) -> None:
    found = names(tmp_path, ["tool", "link", "joint", "joint", "link", "base"])
    assert found.joints == ("J_2_J_3",)
    assert found.links == ("B_0", "L_4")


def test_effectors_that_are_not_one_per_module(tmp_path: Path) -> None:
    twice = "effector(frame: N.frame * move(y, 1 m));"
    found = names(tmp_path, ["tool", "link", "joint", "base"], twice)
    assert found.effectors == ("effector_1", "effector_2")
