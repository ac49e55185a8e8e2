"""Which effectors are part of a body, so that they cannot go where bodies must not."""

from __future__ import annotations

import pytest

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.normal_form import family_of
from compiler.words.structures import derivations_of
from grammar_lang.load import load_text
from solvers.search.sampled_cells import effectors_on_bodies

SPEC = """
module B {{ role base; }}
module J {{ role joint; dof q: revolute z in [-90, 90] deg; }}
module E {{ role effector; }}
grammar G {{ start R; r: R -> B J E; }}
semantics G {{
  r {{ this.at = world * rot(z, J.q); {emissions} }}
}}
workspace W {{ plane xy; bounds box [-3, 3] x [-3, 3] m; region H box [1, 2] x [-1, 1] m; }}
task T {{ robot G; workspace W; start in H; reach H; effort <= 5 N*m; horizon 4 steps of 0.1 s; }}
"""
ROD = "rod(frame: this.at, axis: x, length: 1 m, density: 1 kg/m);"
TIP = "effector(frame: this.at * move(x, {} m));"


@pytest.mark.parametrize(
    ("emissions", "wanted"),
    [
        (ROD + TIP.format(1), {0}),
        (ROD + TIP.format(0.4), {0}),
        (ROD + TIP.format(1.2), set()),
        (ROD + "effector(frame: this.at * move((0.5, 0.1) m));", set()),
        (ROD + TIP.format(1.2) + TIP.format(0), {1}),
        (ROD + "point(frame: this.at * move(x, 1.5 m), mass: 1 kg);" + TIP.format(1.5), {0}),
    ],
)
def test_those_on_a_point_or_a_rod(emissions: str, wanted: set[int]) -> None:
    program = load_text(SPEC.format(emissions=emissions), "test.srg").program
    assert program is not None
    task = program.tasks["T"]
    family = family_of(program, task)
    model = family.robot(next(iter(derivations_of(family.language, ("B", "J", "E")))))
    assert effectors_on_bodies(NumericRobot(robot_graph(model, task.gravity))) == wanted
