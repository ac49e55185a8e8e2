"""The least lengths of cranes and arms, which follow by hand from what they have to reach."""

from __future__ import annotations

import pytest

from grammar_lang import ir
from grammar_lang.load import load_text
from solvers.impossibility.box_search import CoveringBudget
from solvers.run_context import RunContext
from solvers.search import parameter_bounds
from solvers.search.synthesis import Synthesis, synthesise
from tests.oracles.small_specs import replaced

NEAR = 1.01
"""Limits and margins are kept at a distance for the proof, of about a millimetre."""
RAIL, QUILL = 4.0, 1.2
"""kg/m"""

CRANE = f"""
module Rail {{
  role base; param length in [0.3, 1.5] m; dof sx: prismatic x in [-0.5, 0.5] m;
  port out: Cart;
  frame left = in * move(y, 1.4 m);
  frame out = left * move(x, length) * move(x, sx);
  rod(frame: left, axis: x, length: length, density: {RAIL} kg/m);
}}
module Quill {{
  role effector; param length in [0.2, 1] m; dof sy: prismatic -y in [0, 0.6] m;
  port in: Cart;
  frame slide = in * move(-y, sy);
  rod(frame: slide, axis: -y, length: length, density: {QUILL} kg/m);
  effector(frame: slide * move(-y, length));
}}
grammar Crane from ports {{ start Rail; with Quill; }}
workspace Yard {{
  plane xy; bounds box [-1, 3] x [0, 2] m;
  region Pick box [0.2, 0.4] x [0.3, 0.5] m;
  obstacle Crate box [0.6, 0.8] x [0, 0.7] m;
  target Place box [1.1, 1.3] x [0.3, 0.5] m;
}}
task Go {{
  robot Crane; workspace Yard; start in Pick at rest; reach Place at rest; avoid Crate with body;
  gravity (0, -9.81) m/s^2; effort <= 80 N; horizon 30 steps of 0.1 s;
  minimize mass;
}}
"""
# The cart gets to x = 1.1 m with 0.5 m of travel, and the tip 0.9 m below the rail with 0.6 m.
LEAST_RAIL, LEAST_QUILL = 0.6, 0.3

GANTRY = """
module Rail {
  role base; param length in [0.3, 1.6] m; dof sx: prismatic x in [-0.5, 0.5] m rate in [-1, 1] m/s;
  port carriage: Rail;
  frame left = in * move((-0.8, 0, 1.6) m);
  frame carriage = left * move(x, length) * move(x, sx);
  rod(frame: left, axis: x, length: length, density: 4 kg/m, radius: 3 cm);
}
module Beam {
  role joint; param length in [0.2, 1.2] m;
  dof sy: prismatic y in [-0.1, 0.3] m rate in [-1, 1] m/s;
  port in: Rail; port out: Cart;
  frame root = in * move(z, -10 cm);
  frame out = root * move(y, length) * move(y, sy);
  rod(frame: root, axis: y, length: length, density: 2.5 kg/m, radius: 2 cm);
}
module Quill {
  role effector; param length in [0.2, 1] m; dof sz: prismatic -z in [0, 0.6] m rate in [-1, 1] m/s;
  port in: Cart;
  frame slide = in * move(z, -10 cm) * move(-z, sz);
  rod(frame: slide, axis: -z, length: length, density: 1.2 kg/m, radius: 1.5 cm);
  effector(frame: slide * move(-z, length));
}
grammar Gantry from ports { start Rail; with Beam, Quill; }
workspace Cell {
  space xyz; bounds box [-1.2, 1.2] x [-0.1, 1.6] x [0, 2] m;
  region Pick box [-0.6, -0.4] x [0.4, 0.6] x [0.3, 0.5] m;
  obstacle Crate box [-0.2, 0.1] x [0.3, 0.8] x [0, 0.7] m;
  target Place box [0.3, 0.5] x [0.6, 0.8] x [0.3, 0.5] m;
}
task Go {
  robot Gantry; workspace Cell;
  start in Pick at rest held; reach Place at rest; avoid Crate with body margin 2 cm;
  payload 1.5 kg; gravity (0, 0, -9.81) m/s^2; effort <= 80 N;
  horizon at most 30 steps of 0.1 s;
  minimize mass;
}
"""
# The rail reaches x = 0.3 m from -0.8 m with 0.5 m of travel, the beam y = 0.6 m with 0.3 m, and
# the quill gets 0.9 m down with 0.6 m.  A way around the crate, beyond y = 0.8 m, takes a longer
# beam than one over it.
LEAST_OF_GANTRY = 4 * 0.6 + 2.5 * 0.3 + 1.2 * 0.3

ARM = """
module Base { role base; const length = 0 m; port out: Socket; frame out = in; }
module Upper {
  role link; dof q: revolute z in [-150, 150] deg; param length in [0.4, 1.5] m;
  port in: Socket; frame joint = in * rot(z, q);
  port out: Elbow; frame out = joint * move(x, length);
  rod(frame: joint, axis: x, length: length, density: 2 kg/m);
}
module Fore {
  role link; dof q: revolute z in [-150, 150] deg; param length in [0.2, 1.2] m;
  port in: Elbow; frame joint = in * rot(z, q);
  port out: Wrist; frame out = joint * move(x, length);
  rod(frame: joint, axis: x, length: length, density: 0.8 kg/m);
}
module Hand { role effector; const length = 0 m; port in: Wrist; effector(frame: in); }
grammar Arm from ports { start Base; with Upper, Fore, Hand; }
workspace Table {
  plane xy; bounds box [-2, 2] x [-1, 2] m;
  region Home box [1.2, 1.6] x [0, 0.3] m;
  target Shelf box [-0.2, 0.2] x [1.2, 1.6] m;
}
task Go {
  robot Arm; workspace Table; start in Home; reach Shelf;
  effort <= 10 N*m; horizon 40 steps of 0.05 s;
  minimize sum(length) then mass;
}
"""


@pytest.fixture(autouse=True)
def _without_coverings(monkeypatch: pytest.MonkeyPatch) -> None:
    """Bounds on all robots take longer, and have tests of their own."""
    monkeypatch.setattr(parameter_bounds, "BUDGET", CoveringBudget(1, 1, 1))


def task_of(text: str) -> tuple[ir.Program, ir.Task]:
    program = load_text(text, "spec.srg").program
    assert program is not None
    return program, program.tasks["Go"]


def found(text: str) -> Synthesis:
    program, task = task_of(text)
    result = synthesise(program, task, RunContext(evaluations=4, paths=1))
    assert result.design is not None, result.reason
    return result


def values(result: Synthesis) -> list[float]:
    """The values of a design in the objectives; none is below what is proved of all robots."""
    assert result.optimality is not None
    assert all(each.least <= each.value for each in result.optimality.objectives)
    return [float(each.value) for each in result.optimality.objectives]


def test_a_crane_is_as_light_as_its_reach_allows() -> None:
    least = RAIL * LEAST_RAIL + QUILL * LEAST_QUILL
    (mass,) = values(found(CRANE))
    assert least <= mass <= NEAR * least


def test_lengths_of_a_catalogue() -> None:
    """The shortest rail that is long enough comes with the shortest quill."""
    text = replaced(CRANE, "length in [0.3, 1.5] m", "length in {0.3, 0.5, 0.65, 0.8, 0.9, 1.2} m")
    least = RAIL * 0.65 + QUILL * LEAST_QUILL
    (mass,) = values(found(text))
    assert least <= mass <= NEAR * least


def test_the_lightest_gantry_takes_the_way_over_the_crate() -> None:
    (mass,) = values(found(GANTRY))
    assert LEAST_OF_GANTRY <= mass <= NEAR * LEAST_OF_GANTRY


def test_of_equal_lengths_the_lightest_is_taken() -> None:
    """Both regions begin 1.2 m from the base; the upper arm is the heavier one."""
    length, mass = values(found(ARM))
    assert 1.2 <= length <= NEAR * 1.2
    assert 0.4 * 2 + 0.8 * 0.8 <= mass <= NEAR * (0.4 * 2 + 0.8 * 0.8)
