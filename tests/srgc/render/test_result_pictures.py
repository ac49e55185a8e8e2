"""The pictures of a result, against the geometry of a turning pole."""

from __future__ import annotations

from xml.etree import ElementTree

import numpy as np
import pytest

from grammar_lang.load import load
from solvers.run_context import RunContext
from solvers.search.synthesis import synthesise
from srgc.render.result_pictures import _effector_line, input_figure, workspace_figure
from srgc.render.robot_drawing import drawn_robot
from tests.oracles.small_specs import TURNER

POINT = "point(frame: N.frame * move(x, L.length), mass: 1 kg);"
ROD = "rod(frame: N.frame, axis: x, length: L.length, density: L.density);"


@pytest.fixture(scope="module")
def drawn(tmp_path_factory):
    path = tmp_path_factory.mktemp("skeleton") / "spec.srg"
    path.write_text(TURNER.replace(ROD, POINT), encoding="utf-8")
    program = load(path).program
    task = program.tasks["Turn"]
    return program, task, synthesise(program, task, RunContext())


def robot_of(result):
    return drawn_robot(result.design.model, np.array([float(p) for p in result.design.parameters]))


def test_a_point_mass_hangs_on_a_line_from_the_base(drawn):
    _, _, result = drawn
    (length,) = (float(p) for p in result.design.parameters)
    angles = result.design.configuration.outcome.trajectory.x[:, :1]
    tips = length * np.concatenate([np.cos(angles), np.sin(angles)], axis=1)
    robot = robot_of(result)
    points = robot.points(angles)
    last = robot.bones[-1][1]
    np.testing.assert_allclose(points[:, robot.bones[0][0]], 0, atol=1e-12)
    np.testing.assert_allclose(points[:, last], tips, atol=1e-9)
    np.testing.assert_allclose(points[:, robot.masses[0].point], tips, atol=1e-9)


def test_the_trace_does_not_cut_corners(drawn):
    _, task, result = drawn
    (length,) = (float(p) for p in result.design.parameters)
    trajectory = result.design.configuration.outcome.trajectory
    design = result.design
    line = _effector_line(
        design.model, design.leader, robot_of(result), trajectory.x, float(task.step)
    )
    angles = np.unwrap(np.arctan2(line[:, 1], line[:, 0]))
    assert np.abs(np.diff(angles)).max() < np.abs(np.diff(trajectory.x[:, 0])).max() / 5
    middles = np.hypot(*((line[1:] + line[:-1]) / 2).T)
    np.testing.assert_allclose(middles, length, rtol=1e-3)
    # The torque is held and nothing else acts: the pole turns with a constant acceleration.
    h, count = float(task.step), (len(line) - 1) // (len(trajectory.x) - 1)
    assert count % 2 == 0
    turns, rates = trajectory.x[:-1].T
    half = turns + rates * h / 2 + (trajectory.x[1:, 1] - rates) * h / 8
    np.testing.assert_allclose(angles[count // 2 :: count] - angles[0], half - turns[0], atol=1e-6)


def test_the_pictures_are_made_twice_alike(drawn):
    program, task, result = drawn
    workspace = program.workspaces["Table"]
    pictures = [workspace_figure(result, result.design, workspace, task) for _ in range(2)]
    assert pictures[0] == pictures[1]
    assert pictures[0].lstrip().startswith("<?xml")
    assert input_figure(result.design, task) == input_figure(result.design, task)


def test_pictures_are_called_after_task_and_robot(drawn):
    program, task, result = drawn
    robot = f"robot {' '.join(result.design.derivation.word)}"
    workspace = workspace_figure(result, result.design, program.workspaces["Table"], task)
    for picture in (workspace, input_figure(result.design, task)):
        title = ElementTree.fromstring(picture)[0]
        assert title.tag.endswith("}title")
        assert task.name in title.text
        assert robot in title.text


def test_the_legend_tells_the_cells_of_the_path_from_regions(drawn):
    program, task, result = drawn
    picture = ElementTree.fromstring(
        workspace_figure(result, result.design, program.workspaces["Table"], task)
    )
    kinds = {
        each.get("class") for each in picture.iter() if "shape" in each.get("class", "").split()
    }
    assert {"shape cell here", "shape cell covered here", "shape region"} <= kinds
    says = {each.text for each in picture.iter("{http://www.w3.org/2000/svg}text")}
    assert {"region", "target", "obstacle", "cell of the path", "cell path"} <= says


def test_units_are_spelled_as_in_the_spec(drawn):
    program, task, result = drawn
    inputs = input_figure(result.design, task)
    assert "effort (N*m), bound ±10 N*m" in inputs
    workspace = workspace_figure(result, result.design, program.workspaces["Table"], task)
    robustness = result.design.configuration.outcome.robustness
    assert f"robustness {robustness:.4g} N*m" in workspace
    for other in ("N m", "N·m"):
        assert other not in inputs + workspace
