"""``srgc export --to gltf``: other readers, and MuJoCo's own motion."""

from __future__ import annotations

import io
import json
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import trimesh

from srgc.cli import run
from tests.conftest import srgc_process
from tests.oracles import result_files
from tests.oracles import shaped_arm as arm
from tests.oracles.driven_claims import CASES, Driven
from tests.oracles.found_folders import claim_found
from tests.oracles.glb_files import GlbFile
from tests.oracles.mujoco_motions import Sampled, sampled
from tests.oracles.small_specs import TURNER, replaced
from tests.oracles.some_cases import some
from tests.srgc.conftest import Ran

Export = Callable[..., Ran]
SINGLE = 2e-6
"""Metres: a chain of poses in single precision."""
VALIDATE = """
const validator = require("gltf-validator");
const chunks = [];
process.stdin.on("data", (chunk) => chunks.push(chunk));
process.stdin.on("end", async () => {
  const report = await validator.validateBytes(new Uint8Array(Buffer.concat(chunks)));
  console.log(JSON.stringify(report.issues));
});
"""


def exported(folder: Path, form: str, path: Path) -> bytes:
    assert run(["export", str(folder), "--to", form, "-o", str(path)]) == 0
    return path.read_bytes()


@pytest.fixture(params=some([*sorted(CASES.keys() - {"branches"}), "branches"], -1))
def driven(request: pytest.FixtureRequest) -> Driven:
    return CASES[request.param]


@pytest.fixture(scope="module")
def shaped(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    folder = tmp_path_factory.mktemp("shaped")
    return exported(arm.shaped_arm(folder / "out"), "gltf", folder / "arm.glb")


def upright(place: np.ndarray) -> np.ndarray:
    """glTF has y up: x, y, z of the robot are x, -z, y there."""
    x, y, z = place
    return np.array([x, z, -y])


def test_effectors_move_as_in_mujoco(driven: Driven, tmp_path: Path) -> None:
    folder = driven.folder(tmp_path / "claimed")
    mjcf = exported(folder, "mjcf", tmp_path / "robot.xml").decode()
    expected: Sampled = sampled(mjcf, result_files.read(folder), driven.joints, driven.effectors)
    file = GlbFile.read(exported(folder, "gltf", tmp_path / "robot.glb"))
    moved = 0.0
    for time, tips in zip(expected.times, expected.tips, strict=True):
        poses = file.poses(float(time))
        for name, tip in zip(driven.effectors, tips, strict=True):
            np.testing.assert_allclose(poses[name][:3, 3], upright(tip), atol=SINGLE)
            moved = max(moved, float(np.abs(tip - expected.tips[0]).max()))
    assert moved > 1e-3
    assert file.content["animations"][0]["name"] == "motion"


def test_within_steps_links_are_as_long_as_they_are(tmp_path: Path) -> None:
    """Joints are animated, not links: a hand on a rod stays on its circle between instants."""
    driven = CASES["friction"]
    file = GlbFile.read(exported(driven.folder(tmp_path / "o"), "gltf", tmp_path / "r.glb"))
    times = file.table(file.content["animations"][0]["samplers"][0]["input"])[:, 0]
    for time in (times[:-1] + times[1:]) / 2:
        place = file.poses(float(time))["EN_6"][:3, 3]
        assert np.linalg.norm(place) == pytest.approx(1.5, abs=SINGLE)


def test_another_library_sees_the_shapes(shaped: bytes) -> None:
    scene = trimesh.load(io.BytesIO(shaped), file_type="glb")
    volumes = {
        "B_0": np.pi * 0.15**2 * 0.2,
        "Z_1_link": np.pi * 0.06**2 * 0.3 + 4 / 3 * np.pi * (0.06**3 + 0.09**3),
        "Y_2_link": 0.3 * 0.08 * 0.1,
        "P_3_link": trimesh.convex.convex_hull(arm.CORNERS).volume,
        "O": 0.2 * 0.4 * 0.4,
    }
    for name, volume in volumes.items():
        nodes = [
            node for node in scene.graph.nodes_geometry
            if node == name or node.startswith(f"{name}_")
        ]  # fmt: skip
        meshes = [scene.geometry[scene.graph[node][1]] for node in nodes]
        assert meshes, name
        for mesh in meshes:
            assert mesh.is_volume, name
        assert sum(mesh.volume for mesh in meshes) == pytest.approx(volume, rel=0.03), name


def test_regions_are_seen_through_and_named(shaped: bytes) -> None:
    content = GlbFile.read(shaped).content
    nodes = {node["name"]: node for node in content["nodes"]}
    names = {content["nodes"][i]["name"] for i in nodes["regions"]["children"]}
    assert names == {"S", "O", "T"}
    for name in names:
        (primitive,) = content["meshes"][nodes[name]["mesh"]]["primitives"]
        material = content["materials"][primitive["material"]]
        assert material["alphaMode"] == "BLEND"
        assert material["pbrMetallicRoughness"]["baseColorFactor"][3] < 1
    assert content["asset"]["extras"]["about"][0] == f"robot: {arm.WORD}"


def test_same_design_same_bytes(tmp_path: Path, shaped: bytes) -> None:
    folder = arm.shaped_arm(tmp_path / "out")
    for seed in ("1", "2"):
        process = srgc_process(["export", folder, "--to", "gltf"], tmp_path, PYTHONHASHSEED=seed)
        assert process.communicate() == (shaped, b"")


def test_a_robot_that_cannot_move_is_a_picture(srgc: Export, tmp_path: Path) -> None:
    pole = replaced(TURNER, " and starts with B eps JO", "")
    folder = claim_found(tmp_path / "out", pole, "B eps L eps EN", ["1.5"])
    file = GlbFile.read(exported(folder, "gltf", tmp_path / "pole.glb"))
    assert "animations" not in file.content
    np.testing.assert_allclose(file.poses(0.0)["EN_4"][:3, 3], (1.5, 0, 0), atol=SINGLE)


@pytest.mark.slow
def test_the_validator_of_khronos_has_nothing_to_say(shaped: bytes, tmp_path: Path) -> None:
    """Empty nodes, which are frames of effectors and links without shapes, are no fault."""
    node, npm = shutil.which("node"), shutil.which("npm")
    if node is None or npm is None:
        pytest.skip("no Node is installed")
    install = [
        npm,
        "install",
        "--silent",
        "--no-fund",
        "--no-audit",
        "gltf-validator@2.0.0-dev.3.10",
    ]
    if subprocess.run(install, cwd=tmp_path, check=False, capture_output=True).returncode:
        pytest.skip("the validator cannot be installed")
    files = [shaped]
    for name in ("branches", "friction"):
        made = CASES[name].folder(tmp_path / name)
        files.append(exported(made, "gltf", tmp_path / f"{name}.glb"))
    for data in files:
        ran = subprocess.run(
            [node, "-e", VALIDATE], cwd=tmp_path, input=data, capture_output=True, check=True
        )
        issues = json.loads(ran.stdout)
        assert (issues["numErrors"], issues["numWarnings"]) == (0, 0), issues
        assert {each["code"] for each in issues["messages"]} <= {"NODE_EMPTY"}
