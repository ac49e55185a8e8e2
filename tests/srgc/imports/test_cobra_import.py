"""``srgc import cobra``: goals, rules, places and costs as clauses, what is said of the rest."""

from __future__ import annotations

import json
import math
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
import trimesh

import srgc as interface
from srgc.faults import UsageFault
from srgc.imports.cobra.cobra_import import cobra_import
from srgc.imports.timor.timor_import import timor_import
from srgc.imports.written_import import write_import
from tests.conftest import ROOT

FOLDER = ROOT / "specs" / "imports"
KIT = FOLDER / "scara_modules"
RULES = [{"type": "joint", "parts": ["q", "dq", "tau"]}, {"type": "allGoalsFulfilled"}]
ACCEPTED = {"SRG0408", "SRG0607", "SRG0610", "SRG0611", "SRG0718"}
"""Notes that are about what a task asks for, not about mistakes."""


def at(x: float, y: float, z: float) -> list[list[float]]:
    found = np.eye(4)
    found[:3, 3] = x, y, z
    return found.tolist()


def tolerated(x: float, y: float = 0.3, z: float = 0.3, **more: Any) -> dict[str, Any]:
    box = {"toleranceProjection": ["x", "y", "z"], "tolerance": [[-0.02, 0.02]] * 3}
    return {"nominal": at(x, y, z), **box, **more}


def goal(name: str, x: float, kind: str = "reach", **more: Any) -> dict[str, Any]:
    return {"ID": name, "type": kind, "goalPose": tolerated(x, **more)}


def order(*names: str) -> dict[str, Any]:
    return {"type": "allGoalsFulfilledInOrder", "order": [*names]}


def imported(
    tmp_path: Path, goals: list[Any], rules: list[Any] | None = None, **more: Any
) -> tuple[str, list[str]]:
    """The lines of the task and the remarks, after a check without mistakes."""
    options = more.pop("options", {})
    task = {
        "header": {"ID": "a/test"},
        "goals": goals,
        "constraints": RULES + (rules or []),
        **more,
    }
    file = tmp_path / "test.json"
    file.write_text(json.dumps(task), encoding="utf-8")
    found = cobra_import(file, **options)
    spec = tmp_path / "out" / "test.srg"
    write_import(found, spec, force=True)
    assert {each.code.value for each in interface.check(spec)} <= ACCEPTED
    return " ".join(found.text.split()), list(found.remarks)


def test_two_goals_are_a_start_and_an_end(tmp_path: Path) -> None:
    text, remarks = imported(tmp_path, [goal("a", 0.5), goal("b", 0.3, "at")], [order("b", "a")])
    assert "region B box [280, 320] x [280, 320] x [280, 320] mm;" in text
    assert "start in B at rest; reach A at rest;" in text
    assert any("begins there at rest" in each for each in remarks)
    assert not any("order of the file" in each for each in remarks)


def test_goals_between_are_a_formula(tmp_path: Path) -> None:
    goals = [goal(name, x) for name, x in (("a", 0.2), ("b", 0.3), ("c", 0.4), ("d", 0.5))]
    text, remarks = imported(tmp_path, goals)
    assert "start in A at rest; satisfy eventually (B and eventually C); reach D at rest;" in text
    assert sum("rests there is not asked for" in each for each in remarks) == 2
    assert any("order of the file" in each for each in remarks)


def test_any_order(tmp_path: Path) -> None:
    goals = [goal("a", 0.2, "at"), goal("b", 0.3, "at")]
    text, remarks = imported(tmp_path, goals, options={"any_order": True})
    assert "start in Anywhere at rest; satisfy eventually A; satisfy eventually B;" in text
    assert not any("order" in each for each in remarks)


def test_pauses(tmp_path: Path) -> None:
    goals = [goal("a", 0.2), goal("b", 0.3), {"ID": "w", "type": "pause", "duration": 0.4}]
    text, _ = imported(tmp_path, goals, [order("a", "b")])
    assert "reach B at rest for 0.4 s;" in text
    assert "horizon 24 steps of 0.1 s;" in text
    text, remarks = imported(tmp_path, [*goals, goal("c", 0.4)], [order("a", "b", "w", "c")])
    assert "satisfy eventually (B and always[0 s, 0.4 s] B); reach C at rest;" in text
    assert any("it pauses in the region" in each for each in remarks)


def test_a_return(tmp_path: Path) -> None:
    goals = [goal("a", 0.2), goal("b", 0.3), {"ID": "r", "type": "returnTo", "returnToGoal": "a"}]
    text, remarks = imported(tmp_path, goals, [order("a", "b", "r")])
    assert "start in A at rest; satisfy eventually B; reach A at rest;" in text
    assert any("not to its joint angles" in each for each in remarks)


def test_a_path_with_times(tmp_path: Path) -> None:
    poses = [tolerated(0.2), tolerated(0.3), tolerated(0.4)]
    path = {"ID": "p", "type": "follow", "trajectory": {"pose": poses, "t": [0, 0.5, 1.2]}}
    text, _ = imported(tmp_path, [goal("a", 0.1), path, goal("b", 0.5)])
    assert (
        "eventually (P_1 and eventually[0.5 s, 0.5 s] (P_2 and eventually[0.7 s, 0.7 s] P_3))"
        in text
    )


def test_a_long_path_is_thinned(tmp_path: Path) -> None:
    poses = [tolerated(0.2 + 0.001 * number) for number in range(100)]
    path = {"ID": "p", "type": "follow", "trajectory": {"pose": poses}}
    text, remarks = imported(tmp_path, [goal("a", 0.1), path, goal("b", 0.5)])
    assert "P_1 " in text
    assert "P_100" in text
    assert any("12 of its 100 poses" in each for each in remarks)


def test_turns_at_the_start_are_a_formula(tmp_path: Path) -> None:
    turned = {"toleranceProjection": ["r_sph", "Theta_R"], "tolerance": [[0, 0.02], [-0.1, 0.1]]}
    goals = [goal("a", 0.2, **turned), goal("b", 0.3, **turned)]
    text, remarks = imported(tmp_path, goals)
    assert "satisfy A oriented rot(z, 0 deg) within 0.1 rad;" in text
    assert "reach B oriented rot(z, 0 deg) within 0.1 rad at rest;" in text
    assert "region A box" in text
    assert "target B ball (300, 300, 300) mm radius 20 mm;" in text
    assert any("cube" in each for each in remarks)


def test_a_pose_without_tolerances_has_those_of_timor(tmp_path: Path) -> None:
    exact = {"ID": "b", "type": "at", "goalPose": {"nominal": at(0.3, 0, 0.3)}}
    text, remarks = imported(tmp_path, [goal("a", 0.2), exact])
    assert "target B box [299, 301] x [-1, 1] x [299, 301] mm;" in text
    assert "oriented rot(z, 0 deg) within 0.5 deg" in text
    assert any("without tolerances" in each for each in remarks)


def test_where_the_base_stands(tmp_path: Path) -> None:
    pose = {"nominal": at(0.1, 0, 0.2), "toleranceProjection": ["x", "y", "z", "Theta_R"],
            "tolerance": [[-0.3, 0.2], [-0.001, 0.001], [-0.5, 0.5], [0, 3]],
            "toleranceFrame": ["world"] * 4}  # fmt: skip
    pose["nominal"] = [[0, -1, 0, 0.1], [1, 0, 0, 0], [0, 0, 1, 0.2], [0, 0, 0, 1]]
    rule = {"type": "basePlacement", "pose": pose}
    text, remarks = imported(tmp_path, [goal("a", 0.2), goal("b", 0.3)], [rule])
    assert "param east in [-300, 200] mm; param up in [-500, 500] mm;" in text
    assert (
        "frame out = in * move((100, 0, 200) mm) * move(x, east) * move(z, up) * rot(z, 90 deg);"
        in text
    )
    assert any("stands as nominal there" in each for each in remarks)


def test_a_base_that_moves_in_its_own_frame(tmp_path: Path) -> None:
    pose = {"nominal": [[0, -1, 0, 0.1], [1, 0, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]],
            "toleranceProjection": ["x"], "tolerance": [[-0.3, 0.3]]}  # fmt: skip
    rule = {"type": "basePlacement", "pose": pose}
    text, _ = imported(tmp_path, [goal("a", 0.2), goal("b", 0.3)], [rule])
    assert "frame out = in * move((100, 0, 0) mm) * rot(z, 90 deg) * move(x, east);" in text


def test_obstacles(tmp_path: Path) -> None:
    turned = [[0.8, -0.6, 0, 1], [0.6, 0.8, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]
    shapes = [
        {"type": "box", "parameters": {"x": 0.2, "y": 0.4, "z": 0.6}, "pose": at(1, 0, 0)},
        {"type": "box", "parameters": {"x": 0.2, "y": 0.4, "z": 0.6}, "pose": turned},
        {"type": "sphere", "parameters": {"r": 0.1}, "pose": at(1, 1, 0)},
        {"type": "cylinder", "parameters": {"r": 0.1, "z": 0.4}, "pose": turned},
    ]
    obstacles = [{"ID": "9", "name": "Wall", "collision": shapes}]
    rules = [{"type": "collisionFree", "safety_margin": 0.01}]
    text, _ = imported(tmp_path, [goal("a", 0.2), goal("b", 0.3)], rules, obstacles=obstacles)
    assert "obstacle Wall box [0.9, 1.1] x [-0.2, 0.2] x [-0.3, 0.3] m;" in text
    assert "obstacle Wall_2 hull (1040, -220, -300) mm," in text
    assert "obstacle Wall_3 ball (1, 1, 0) m radius 100 mm;" in text
    assert "obstacle Wall_4 cylinder (1, 0, -0.2) m, (1, 0, 0.2) m radius 100 mm;" in text
    assert (
        "avoid self with body; avoid Wall, Wall_2, Wall_3, Wall_4 with body, margin 10 mm;" in text
    )


def test_what_of_obstacles_is_not_carried_over_is_listed(tmp_path: Path) -> None:
    shape = {"type": "sphere", "parameters": {"r": 0.1}, "pose": at(1, 0, 0)}
    composed = {"type": "composed", "geometries": [shape], "pose": at(5, 0, 0)}
    obstacles = [
        {"ID": "1", "collision": [composed]},
        {"ID": "2", "collision": [shape], "pose": at(0, 0, 3)},
        {"ID": "3", "collision": [shape], "pose": at(0, 0, 0)},
    ]
    rules = [{"type": "collisionFree"}, {"type": "selfCollisionFree", "safety_margin": 0.05}]
    goals = [goal("a", 0.2), goal("b", 0.3)]
    _, remarks = imported(tmp_path, goals, rules, obstacles=obstacles)
    assert any("constraints[3].safety_margin: a margin between" in each for each in remarks)
    assert any("obstacles[0].collision[0].pose: an unknown key" in each for each in remarks)
    assert not any("geometries: an unknown key" in each for each in remarks)
    assert any("obstacles[1].pose: a pose of the whole" in each for each in remarks)
    assert not any("obstacles[2]" in each for each in remarks)


def test_a_mesh_has_the_unit_of_its_file(tmp_path: Path) -> None:
    """A cube of 400 mm in COLLADA, whose unit is the millimetre; scaled by 2 it is 800 mm."""
    box = trimesh.creation.box((400, 400, 400))
    text = box.export(file_type="dae").decode()
    assert "<asset>" in text
    unit = '<unit meter="0.001" name="millimeter"/>'
    (tmp_path / "box.dae").write_text(re.sub(r"(<up_axis>)", rf"{unit}\1", text), encoding="utf-8")
    shape = {"type": "mesh", "parameters": {"file": "box.dae", "scale": 2}}
    goals = [goal("a", 1.2), goal("b", 1.3)]
    rules = [{"type": "collisionFree"}]
    imported(tmp_path, goals, rules, obstacles=[{"ID": "Box", "collision": [shape]}])
    (path,) = (tmp_path / "out" / "test_meshes").iterdir()
    corners = [line.split()[1:] for line in path.read_text().splitlines() if line[:2] == "v "]
    sizes = np.ptp(np.array(corners, dtype=float), axis=0)
    assert sizes == pytest.approx([0.8, 0.8, 0.8], abs=1e-3)


def test_obstacles_that_may_be_touched_are_left_out(tmp_path: Path) -> None:
    shape = {"type": "sphere", "parameters": {"r": 0.1}}
    obstacles = [{"ID": "9", "collision": [shape]}]
    text, remarks = imported(tmp_path, [goal("a", 0.2), goal("b", 0.3)], obstacles=obstacles)
    assert "avoid" not in text
    assert "obstacle " not in text
    assert any("does not forbid to touch obstacles" in each for each in remarks)


def test_what_cannot_be_said_is_listed(tmp_path: Path) -> None:
    goals = [
        goal("a", 0.2),
        goal("b", 0.3) | {"constraints": [{"type": "selfCollisionFree"}, {"type": "endEffector"}]},
        {"ID": "c", "type": "pick", "objectID": "box"},
    ]
    goals[0]["goalPose"]["toleranceProjection"] = ["x", "y", "phi"]
    rules = [
        {"type": "endEffector", "v_max": 0.2, "pose": tolerated(0.3, tolerance=[[-0.5, 0.5]] * 3)}
    ]
    objects = [{"ID": "box", "collision": []}]
    text, remarks = imported(tmp_path, goals, rules, objects=objects, colour="red")
    said = "\n".join(remarks)
    for place in (
        *("goals[0].goalPose.toleranceProjection[2]", "goals[2]", "1 objects", "colour"),
        *("goals[1].constraints[0]", "goals[1].constraints[1]", "constraints[2].v_max"),
    ):
        assert place in said
    assert "satisfy always Kept;" in text


@pytest.mark.parametrize(
    ("cost", "clause", "said"),
    [
        (
            "cyc",
            "horizon at most 20 steps of 0.1 s;",
            0,
        ),
        ("mass_2,cyc_0.5", "minimize mass then time;", 1),
        ("mechEnergy", "minimize energy;", 0),
        ("qDist", "modules <= 8; // a choice }", 1),
    ],
)
def test_costs(cost: str, clause: str, said: int, tmp_path: Path) -> None:
    goals = [goal("a", 0.2), goal("b", 0.3)]
    text, remarks = imported(tmp_path, goals, options={"cost": cost})
    assert clause in text
    assert sum("cost" in each for each in remarks) == said


def test_an_unknown_cost(srgc: Callable[..., Any]) -> None:
    ran = srgc("import", "cobra", FOLDER / "sort_parts.json", "--cost", "beauty", "-o", "-")
    assert ran.status == 2
    assert "unknown cost `beauty`" in ran.err


def test_modules_of_a_set_or_of_a_spec(tmp_path: Path, srgc: Callable[..., Any]) -> None:
    kit = tmp_path / "kit.srg"
    write_import(timor_import(KIT), kit, force=True)
    goals = [goal("a", 0.2), goal("b", 0.3)]
    with_set, _ = imported(tmp_path, goals, options={"modules": KIT})
    included, _ = imported(tmp_path, goals, options={"modules": kit})
    assert 'include "kit.srg";' in included
    assert "module Pivot" in with_set
    assert "module Pivot" not in included
    listed = "start Floor; with Column, Pivot, BeamShort, BeamLong, Quill;"
    assert listed in with_set
    assert listed in included
    ran = srgc("words", tmp_path / "out" / "test.srg", "--grammar", "TestArms", "--limit", 2)
    assert ran.out.splitlines() == ["Floor Column Quill", "Floor Column Pivot BeamShort Quill"]
    refused = srgc("import", "cobra", FOLDER / "sort_parts.json", "--modules", KIT, "--base", "Top")
    assert refused.status == 2
    assert "it has Column" in refused.err


def test_a_mesh_is_pieces_that_the_workspace_names(
    tmp_path: Path, srgc: Callable[..., Any]
) -> None:
    spec = tmp_path / "mill.srg"
    ran = srgc("import", "cobra", FOLDER / "tend_machine.json", "--modules", KIT, "-o", spec)
    assert ran.status == 0
    assert "convex pieces that hold every triangle" in ran.err
    text = spec.read_text(encoding="utf-8")
    assert 'obstacles from "mill_meshes/Machine.obj" at move((340, 0, 0) mm);' in text
    assert {each.code.value for each in interface.check(spec)} <= ACCEPTED


def test_the_mesh_is_what_its_generator_makes() -> None:
    from tests.oracles.machine_meshes import machine, stl_bytes

    assert (FOLDER / "machine.stl").read_bytes() == stl_bytes(machine())


BALLS: dict[str, tuple[list[str], list[list[float]], str, str]] = {
    "no limit": (
        ["r_sph", "x"], [[0, math.inf], [-0.01, 0.01]],
        "target B box [0.29, 0.31] x [-", "",
    ),
    "a point": (
        ["r_sph"], [[0, 0]],
        "target B ball (300, 300, 300) mm radius 0.1 mm;", "a radius of 0 became 0.1 mm",
    ),
    "the smaller": (
        ["r_sph", "r_sph"], [[0, 0.05], [0, 0.02]],
        "target B ball (300, 300, 300) mm radius 20 mm;", "",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", BALLS)
def test_balls_of_any_size(name: str, tmp_path: Path) -> None:
    projections, limits, text, remark = BALLS[name]
    ball = {"toleranceProjection": projections, "tolerance": limits}
    found, remarks = imported(tmp_path, [goal("a", 0.2), goal("b", 0.3, "at", **ball)])
    assert text in found
    assert any(remark in each for each in remarks)


def test_the_cube_of_a_formula_is_in_the_smaller_ball(tmp_path: Path) -> None:
    """20 mm / sqrt(3) is 11.547 mm."""
    balls = {"toleranceProjection": ["r_sph"] * 2, "tolerance": [[0, 0.05], [0, 0.02]]}
    goals = [goal("a", 0.2), goal("b", 0.3, **balls), goal("c", 0.4)]
    text, _ = imported(tmp_path, goals)
    assert "region B box [288.5, 311.5] x [288.5, 311.5] x [288.5, 311.5] mm;" in text


def test_a_kit_whose_grammar_names_no_module_is_refused(tmp_path: Path) -> None:
    kit = tmp_path / "kit.srg"
    kit.write_text("module A { role base; port in: P; }\ngrammar G from ports { }\n")
    with pytest.raises(UsageFault, match="names no modules"):
        imported(tmp_path, [goal("a", 0.2), goal("b", 0.3)], options={"modules": kit})
