"""``srgc export --to mcap``, read back: another library's kinematics and MuJoCo's own motion."""

from __future__ import annotations

import builtins
import io
import json
import math
from collections import defaultdict
from collections.abc import Callable
from pathlib import Path
from typing import Any

import mujoco
import numpy as np
import pytest
from mcap.reader import make_reader

from srgc.cli import run
from tests.conftest import srgc_process
from tests.oracles import result_files
from tests.oracles import shaped_arm as arm
from tests.oracles.driven_claims import CASES, Driven
from tests.oracles.mujoco_motions import sampled
from tests.oracles.some_cases import some
from tests.srgc.conftest import Ran

Export = Callable[..., Ran]
Log = dict[str, list[tuple[float, dict[str, Any]]]]
"""By channel the messages, each with its time in seconds."""
CHANNELS = {
    "/robot_description": "std_msgs/String", "/tf": "foxglove.FrameTransforms",
    "/joint_states": "foxglove.JointStates", "/scene": "foxglove.SceneUpdate",
    "/efforts": "srgc.Efforts",
}  # fmt: skip


def exported(folder: Path, form: str, path: Path) -> bytes:
    assert run(["export", str(folder), "--to", form, "-o", str(path)]) == 0
    return path.read_bytes()


def read(data: bytes) -> Log:
    import jsonschema  # Takes seconds: it makes the parsers of all formats.

    found: Log = defaultdict(list)
    for schema, channel, message in make_reader(
        io.BytesIO(data), validate_crcs=True
    ).iter_messages():
        assert schema is not None
        assert (schema.encoding, channel.message_encoding) == ("jsonschema", "json")
        assert schema.name == CHANNELS[channel.topic]
        content = json.loads(message.data)
        rules = json.loads(schema.data)
        jsonschema.Draft202012Validator.check_schema(rules)
        jsonschema.validate(content, rules)
        assert message.publish_time == message.log_time
        found[channel.topic].append((message.log_time / 1e9, content))
    return found


@pytest.fixture(params=some([*sorted(CASES.keys() - {"branches"}), "branches"], -1))
def driven(request: pytest.FixtureRequest) -> Driven:
    return CASES[request.param]


@pytest.fixture(scope="module")
def shaped(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    folder = tmp_path_factory.mktemp("shaped")
    return exported(arm.shaped_arm(folder / "out"), "mcap", folder / "run.mcap")


def frames(message: dict[str, Any]) -> dict[str, dict[str, Any]]:
    found = {each["child_frame_id"]: each for each in message["transforms"]}
    assert len(found) == len(message["transforms"])
    assert {each["parent_frame_id"] for each in message["transforms"]} == {"world"}
    return found


def vector(place: dict[str, float]) -> np.ndarray:
    return np.array([place["x"], place["y"], place["z"]])


def test_the_hand_and_the_joints_move_as_in_mujoco(driven: Driven, tmp_path: Path) -> None:
    folder, n = driven.folder(tmp_path / "claimed"), len(driven.joints)
    mjcf = exported(folder, "mjcf", tmp_path / "robot.xml").decode()
    claim = result_files.read(folder)
    expected = sampled(mjcf, claim, driven.joints, driven.effectors)
    log = read(exported(folder, "mcap", tmp_path / "run.mcap"))
    places = {round(time, 9): frames(message) for time, message in log["/tf"]}
    for time, tips in zip(expected.times, expected.tips, strict=True):
        for name, tip in zip(driven.effectors, tips, strict=True):
            found = vector(places[round(float(time), 9)][name]["translation"])
            np.testing.assert_allclose(found, tip, atol=1e-9)
    assert [time for time, _ in log["/joint_states"]] == pytest.approx(list(expected.times))
    for (_, message), state in zip(log["/joint_states"], expected.states, strict=True):
        assert [joint["name"] for joint in message["joints"]] == list(driven.joints)
        q = [joint["position"] for joint in message["joints"]]
        v = [joint["velocity"] for joint in message["joints"]]
        np.testing.assert_allclose(q, state[:n], atol=1e-9)
        np.testing.assert_allclose(v, state[n:], atol=1e-9)
    stated = [[float(u) for u in row] for row in claim["inputs"]]
    given = [[row[name] for name in driven.joints] for _, row in log["/efforts"]]
    assert given == [*stated, stated[-1]]


def test_in_between_the_robot_is_one_that_the_urdf_describes(shaped: bytes) -> None:
    """The joints' values follow from where two links are; where the others are, MuJoCo says."""
    log = read(shaped)
    ((_, description),) = log["/robot_description"]
    text = description["data"].replace(
        "</robot>", '<mujoco><compiler fusestatic="false"/></mujoco></robot>'
    )
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    assert len(log["/tf"]) == 6 * math.ceil(0.125 * 30) + 1
    for time, message in log["/tf"]:
        found = frames(message)
        assert found.keys() == {*arm.LINKS, *arm.EFFECTORS}
        place = vector(found["P_3_link"]["translation"]) - (0, 0, 0.55)
        reach = float(np.linalg.norm(place))
        assert place[0] > 0  # it has not come over the top
        data.qpos[:] = (
            math.atan2(place[1], place[0]), -math.asin(place[2] / reach), reach - 0.4,
        )  # fmt: skip
        mujoco.mj_kinematics(model, data)
        for name in (*arm.LINKS[1:], *arm.EFFECTORS):
            np.testing.assert_allclose(
                vector(found[name]["translation"]), data.body(name).xpos, atol=1e-9
            )
            turn = found[name]["rotation"]
            quaternion = np.array([turn[key] for key in "wxyz"])
            assert abs(abs(quaternion @ data.body(name).xquat) - 1) < 1e-9
        stamp = message["transforms"][0]["timestamp"]
        assert stamp["sec"] + stamp["nsec"] / 1e9 == pytest.approx(time, abs=1e-9)


def test_shapes_are_those_of_the_spec(shaped: bytes) -> None:
    ((_, scene),) = read(shaped)["/scene"]
    entities = {each["id"]: each for each in scene["entities"]}
    assert {name: entities[name]["frame_id"] for name in arm.LINKS} == {
        name: name for name in arm.LINKS
    }
    assert all(each["frame_locked"] for each in entities.values())

    def parts(name: str, kind: str) -> list[tuple[tuple[float, ...], tuple[float, ...]]]:
        return [
            (tuple(vector(each["pose"]["position"])), tuple(vector(each["size"])))
            for each in entities[name][kind]
        ]

    near = pytest.approx
    ((place, size),) = parts("B_0", "cylinders")
    assert (place, size) == (near((0, 0, 0.1)), near((0.3, 0.3, 0.2)))
    ((place, size),) = parts("Z_1_link", "cylinders")
    assert (place, size) == (near((0, 0, 0.15)), near((0.12, 0.12, 0.3)))
    balls = sorted(parts("Z_1_link", "spheres"), key=lambda each: (each[1], each[0]))
    assert [size for _, size in balls] == [near((0.12,) * 3), near((0.12,) * 3), near((0.18,) * 3)]
    assert [place for place, _ in balls] == [
        near((0, 0, 0), abs=1e-12), near((0, 0, 0.3)), near((0, 0, 0.3)),
    ]  # fmt: skip
    ((place, size),) = parts("Y_2_link", "cubes")
    assert (place, size) == (near((0.25, 0, 0)), near((0.3, 0.08, 0.1)))
    (triangles,) = entities["P_3_link"]["triangles"]
    corners = np.array([vector(point) for point in triangles["points"]])
    gaps = np.linalg.norm(corners[:, None] - arm.CORNERS, axis=2)
    assert gaps.min(axis=0).max() < 1e-12
    assert gaps.min(axis=1).max() < 1e-12
    (obstacle,) = entities["obstacle O"]["triangles"]
    points = np.array([vector(point) for point in obstacle["points"]])
    assert points.min(axis=0).tolist() == [0.5, -0.9, 0]
    assert points.max(axis=0).tolist() == [0.7, -0.5, 0.4]
    assert 0 < obstacle["color"]["a"] < 1


def test_it_says_what_it_is_of(shaped: bytes) -> None:
    (metadata,) = make_reader(io.BytesIO(shaped)).iter_metadata()
    assert metadata.metadata["robot"] == f"robot: {arm.WORD}"


def test_same_design_same_bytes(tmp_path: Path, shaped: bytes) -> None:
    folder = arm.shaped_arm(tmp_path / "out")
    for seed in ("1", "2"):
        process = srgc_process(["export", folder, "--to", "mcap"], tmp_path, PYTHONHASHSEED=seed)
        assert process.communicate() == (shaped, b"")


def test_what_urdf_cannot_hold_is_told(srgc: Export, tmp_path: Path) -> None:
    text = arm.SPEC.replace("inertia: (0.002, 0.006, 0.006,", "inertia: (0.002, 0.006, 0.0601,")
    folder = arm.shaped_arm(tmp_path / "out", text)
    ran = srgc("export", folder, "--to", "mcap", "-o", tmp_path / "run.mcap")
    assert ran.status == 0
    assert ran.err.startswith("note: no /robot_description: no body has such an inertia")
    log = read((tmp_path / "run.mcap").read_bytes())
    assert log.keys() == CHANNELS.keys() - {"/robot_description"}


def test_without_the_library_one_message(
    srgc: Export, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    there = builtins.__import__

    def without(name: str, *rest: Any) -> Any:
        if name.partition(".")[0] == "mcap":
            raise ModuleNotFoundError(name)
        return there(name, *rest)

    folder = arm.shaped_arm(tmp_path / "out")
    monkeypatch.setattr(builtins, "__import__", without)
    ran = srgc("export", folder, "--to", "mcap", "-o", tmp_path / "run.mcap")
    assert (ran.status, ran.out) == (2, "")
    assert ran.err == 'error: a log needs the library mcap: pip install "srgc[log]"\n'
    assert not (tmp_path / "run.mcap").exists()
