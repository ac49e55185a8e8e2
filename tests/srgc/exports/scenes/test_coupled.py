"""Robots whose coordinate moves several frames, and those with inertias that no body has."""

from __future__ import annotations

import io
import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from mcap.reader import make_reader

from srgc.exports.scenes.link_motion import link_motion
from srgc.view.shown_designs import shown_designs
from tests.oracles import shaped_arm
from tests.oracles.coupled_robots import COUPLED, GRIPPER, WHEELS, Coupled
from tests.oracles.driven_claims import CRANE
from tests.oracles.found_folders import claim_found
from tests.oracles.glb_files import GlbFile
from tests.oracles.mesh_files import WEDGE
from tests.oracles.small_specs import replaced
from tests.srgc.conftest import Ran

Export = Callable[..., Ran]
SINGLE = 2e-6
"""Metres: a chain of poses in single precision."""


@pytest.fixture(params=COUPLED)
def robot(request: pytest.FixtureRequest) -> Coupled:
    return COUPLED[request.param]


def z_up(pose: np.ndarray) -> np.ndarray:
    """glTF has y up."""
    x, y, z = pose[:3, 3]
    return np.array([x, -z, y])


def test_effectors_are_where_algebra_puts_them(
    srgc: Export, robot: Coupled, tmp_path: Path
) -> None:
    """In the log by the coordinate that it states, in the picture and the page at the same times.

    Of robots that resist by one number the coordinate itself is known.
    """
    folder = robot.folder(tmp_path / "out")
    said = srgc("export", folder, "--to", "mcap", "-o", tmp_path / "run.mcap")
    assert said == Ran(
        0, "", "note: no /robot_description: degree of freedom 1 moves several frames\n"
    )
    assert srgc("export", folder, "--to", "gltf", "-o", tmp_path / "r.glb") == Ran(0, "", "")
    file = GlbFile.read((tmp_path / "r.glb").read_bytes())
    (shown,) = shown_designs([folder], tubes=False).designs
    assert shown.scene.robot.names.links == robot.links
    places, states = logged((tmp_path / "run.mcap").read_bytes())
    assert len(states) == 7 or robot.inertia is None
    coordinates = []
    for time, joint in states.items():
        assert joint["name"] == robot.joint
        q = joint["position"]
        if robot.inertia is not None:
            assert q == pytest.approx(robot.coordinate(time), abs=1e-9)
        coordinates.append(q)
        poses = file.poses(time)
        scene = shown.scene
        tips = link_motion(scene.robot.tree, scene.instants.at(time)).effectors.origins[0]
        for number, (name, place) in enumerate(zip(robot.effectors, robot.places(q), strict=True)):
            np.testing.assert_allclose(places[time][name], place, atol=1e-9)
            np.testing.assert_allclose(z_up(poses[name]), place, atol=SINGLE)
            np.testing.assert_allclose(tips[number], place, atol=1e-9)
        assert {*robot.links} <= places[time].keys()
    assert abs(coordinates[-1] - coordinates[0]) > 0.05


def logged(
    data: bytes,
) -> tuple[dict[float, dict[str, list[float]]], dict[float, dict[str, float]]]:
    """Where frames are, and the first joint, by time."""
    places = dict[float, dict[str, list[float]]]()
    states = dict[float, dict[str, float]]()
    for _, channel, message in make_reader(io.BytesIO(data)).iter_messages():
        content, time = json.loads(message.data), message.log_time / 1e9
        if channel.topic == "/tf":
            places[time] = {
                each["child_frame_id"]: [each["translation"][axis] for axis in "xyz"]
                for each in content["transforms"]
            }
        elif channel.topic == "/joint_states":
            states[time] = content["joints"][0]
    return places, states


def test_between_instants_each_link_turns_about_its_own_axis(srgc: Export, tmp_path: Path) -> None:
    """The rim of either wheel stays on its circle."""
    folder = COUPLED["wheels"].folder(tmp_path / "out")
    assert srgc("export", folder, "--to", "gltf", "-o", tmp_path / "r.glb").status == 0
    file = GlbFile.read((tmp_path / "r.glb").read_bytes())
    times = file.table(file.content["animations"][0]["samplers"][0]["input"])[:, 0]
    for time in (times[:-1] + times[1:]) / 2:
        poses = file.poses(float(time))
        for name, centre, radius in (
            ("effector_1", (0, 0, 0), 0.15), ("effector_2", (0.3, 0, 0.2), 0.1),
        ):  # fmt: skip
            assert np.linalg.norm(z_up(poses[name]) - centre) == pytest.approx(radius, abs=SINGLE)


def test_urdf_and_mjcf_still_refuse_them(srgc: Export, robot: Coupled, tmp_path: Path) -> None:
    folder = robot.folder(tmp_path / "out")
    for form in ("urdf", "mjcf", "mujoco", "ros2-package"):
        ran = srgc("export", folder, "--to", form, "-o", tmp_path / form)
        assert (ran.status, ran.out) == (2, "")
        assert ran.err == (
            "error: the robot cannot be exported: degree of freedom 1 moves several frames\n"
        )


def test_a_wheel_that_is_a_visual_alone_turns(srgc: Export, tmp_path: Path) -> None:
    """It is a link of its own, behind those of the robot, which has one joint without it."""
    text = replaced(
        WHEELS,
        "    solid(frame: crown, mass: 1 kg, com: (0, 0, 0) m, "
        "inertia: (0.02, 0.02, 0.03, 0, 0, 0));\n",
        '    visual(frame: crown, file: "wedge.obj", scale: 1 mm);\n',
    )
    text = replaced(text, "    cylinder(frame: crown, axis: z, length: 2 cm, radius: 10 cm);\n", "")
    text = replaced(text, "    effector(frame: crown * move(x, 10 cm));\n", "")
    folder = claim_found(tmp_path / "out", text, "B R E", [], {"wedge.obj": WEDGE.encode()})
    (shown,) = shown_designs([folder], tubes=False).designs
    robot = shown.scene.robot
    assert robot.names.links == ("B_0", "R_1_link", "R_1_link_no2")
    assert [mesh.link for mesh in shown.scene.meshes] == [2]
    for q in (0.0, 0.7, -2.0):
        found = link_motion(robot.tree, np.array([[q]])).links
        c, s = np.cos(q), np.sin(q)
        np.testing.assert_allclose(found.origins[0], [[0, 0, 0], [0, 0, 0], [0.3, 0, 0.2]])
        crown = np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]]) @ [[c, -s, 0], [s, c, 0], [0, 0, 1]]
        np.testing.assert_allclose(found.turns[0, 2], crown, atol=1e-12)
    said = srgc("export", folder, "--to", "urdf", "-o", tmp_path / "r.urdf")
    assert "moves several frames" in said.err


# --- inertias that no body has --------------------------------------------------------------------


UNREAL = {
    "shaped arm": (
        replaced(
            shaped_arm.SPEC, "inertia: (0.002, 0.006, 0.006,", "inertia: (0.002, 0.006, 0.0601,"
        ),
        shaped_arm.WORD, [], [shaped_arm.place((0, 0, 0))],
    ),
    "crane": (
        replaced(CRANE, "(0.2, 0.3, 0.4, 0,", "(0.2, 0.3, 9, 0,"), "B eps V eps L eps EN", ["1"],
        [(1, 0, 0)],
    ),
    "gripper": (
        GRIPPER.replace("inertia: (0.01, 0.01, 0.01,", "inertia: (0.01, 0.01, 0.05,"), "B F E", [],
        COUPLED["gripper"].places(0),
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", UNREAL)
def test_a_picture_needs_no_inertia(srgc: Export, tmp_path: Path, name: str) -> None:
    text, word, values, expected = UNREAL[name]
    files = {"parts/wedge.obj": WEDGE.encode()} if name == "shaped arm" else {}
    folder = claim_found(tmp_path / "out", text, word, values, files)
    assert srgc("export", folder, "--to", "urdf", "-o", tmp_path / "r.urdf").status == 2
    assert srgc("export", folder, "--to", "gltf", "-o", tmp_path / "r.glb") == Ran(0, "", "")
    ran = srgc("export", folder, "--to", "mcap", "-o", tmp_path / "run.mcap")
    assert (ran.status, ran.err.startswith("note: no /robot_description: ")) == (0, True)
    file = GlbFile.read((tmp_path / "r.glb").read_bytes())
    (shown,) = shown_designs([folder], tubes=False).designs
    places, _ = logged((tmp_path / "run.mcap").read_bytes())
    names, tips = shown.scene.robot.names.effectors, shown.scene.motion.effectors.origins[0]
    for tool, tip, place in zip(names, tips, expected, strict=True):
        np.testing.assert_allclose(tip, place, atol=1e-12)
        np.testing.assert_allclose(places[0.0][tool], place, atol=1e-12)
        np.testing.assert_allclose(z_up(file.poses(0.0)[tool]), place, atol=SINGLE)
