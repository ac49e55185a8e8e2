"""What counts as one metre, the first margin, and programs that are alike whatever the size."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from grammar_lang import ir
from grammar_lang.load import load_text
from solvers.trajectory.control import synthesise_control
from solvers.trajectory.task_size import LEAST_MARGIN, SMALLEST, least_margin, length_unit
from tests.oracles.planes import box
from tests.oracles.turning_link import ANGLE, LENGTH, beyond, double_integrator, one_link

SPEC = """
module B { role base; }
module E { role effector; }
grammar G { start R; r: R -> B E; }
semantics G { r { this.at = world; effector(frame: this.at); } }
workspace W {
  plane xy; bounds box [-2, 2] x [-1, 1] m;
  region H box [0, 1] x [0, 0.5] m; region V box [-1, -0.99] x [0, 1] m;
}
task T { robot G; workspace W; start in H; reach H; horizon 4 steps of 0.1 s; }
task U { robot G; workspace W; start in H; satisfy eventually V; horizon 4 steps of 0.1 s; }
"""


def program() -> ir.Program:
    found = load_text(SPEC, "test.srg").program
    assert found is not None
    return found


@pytest.mark.parametrize(
    ("side", "wanted"), [(4, 1.0), ("0.03", 0.01), (200, 100.0), (11, 1.0), (16, 10.0)]
)
def test_the_unit_is_the_power_of_ten_below_the_size(side: int | str, wanted: float) -> None:
    length = Fraction(side)
    bounds = box("bounds", "bounds", (0, length), (0, length))
    workspace = replace(program().workspaces["W"], bounds=bounds)
    assert length_unit(workspace) == pytest.approx(wanted)


def test_the_first_margin_leaves_room_in_what_is_to_be_reached() -> None:
    found = program()
    workspace = found.workspaces["W"]
    assert least_margin(workspace, found.tasks["T"]) == LEAST_MARGIN
    # V is 1 cm wide.
    assert least_margin(workspace, found.tasks["U"]) == LEAST_MARGIN
    several = replace(found.tasks["U"], repeat=True)
    assert least_margin(workspace, several) == pytest.approx(0.0005)
    narrow = box("V", "region", (0, Fraction("0.001")), (0, 1))
    small = replace(workspace, regions=(workspace.regions[0], narrow))
    assert least_margin(small, found.tasks["U"]) == pytest.approx(0.00005)
    line = box("V", "region", (0, 0), (0, 1))
    flat = replace(workspace, regions=(workspace.regions[0], line))
    assert least_margin(flat, found.tasks["U"]) == pytest.approx(SMALLEST)


@pytest.mark.parametrize("scale", [0.01, 1.0, 100.0])
def test_the_least_torque_is_found_whatever_the_size(scale: float) -> None:
    """A rod so many times as long has so many times cubed the inertia."""
    steps, bound = 12, 20.0
    problem, seed = one_link(steps, bound, 0.0)
    rows, longer = beyond(steps, ANGLE, scale * LENGTH), scale**3
    groups = (replace(problem.groups[0], lower=-bound * longer, upper=bound * longer),)
    problem = replace(problem, groups=groups, rows_of=lambda *_: rows, unit=scale)
    outcome = synthesise_control(problem, replace(seed, theta=scale * seed.theta))
    assert outcome.feasible
    least = double_integrator(steps, rest=True, reach=ANGLE)
    assert outcome.robustness / longer == pytest.approx(bound - least, abs=2e-3)
