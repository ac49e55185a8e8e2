"""A mesh as obstacles, from the text to the verdict: found, verified, copied, refused."""

from __future__ import annotations

import contextlib
import io
from pathlib import Path

import mujoco
import numpy as np
import pytest

from solvers.verifier.verification import Outcome, verify_directory
from srgc.cli import run
from tests.oracles import result_files
from tests.oracles.command_line import quiet, synthesised
from tests.oracles.exported_motions import replay

SPEC = """\
include std "gantry.srg";
workspace Table {
  space xyz;
  bounds box [-0.6, 0.6] x [-0.6, 0.6] x [0, 1.3] m;
  region Tray box [-0.3, -0.2] x [-0.2, -0.1] x [0.2, 0.3] m;
  target Shelf box [0.1, 0.2] x [0.1, 0.2] x [0.25, 0.35] m;
  obstacles from "scene.obj" in mm at move((-0.075, 0, 0) m) * rot(z, 8 deg) * rot(y, 5 deg);
}
task Place {
  robot Std_Gantry; workspace Table;
  start in Tray at rest; reach Shelf at rest;
  avoid self, scene with body, margin 1 cm;
  avoid scene with effector;
  gravity (0, 0, -9.81) m/s^2;
  horizon 20 steps of 0.1 s;
}
"""
WALL = np.array([(x, y, z) for x in (-25, 25) for y in (-400, 400) for z in (0, 400)])
POST = np.array([(x, y, z) for x in (270, 330) for y in (-330, -270) for z in (0, 200)])
QUADS = ((1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4))


def said(*arguments: object) -> tuple[int, str]:
    """The exit status of a command, and all that it prints."""
    out = io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
        status = run([str(argument) for argument in arguments])
    return status, out.getvalue()


def scene() -> str:
    lines = []
    for first, (name, corners) in enumerate((("wall", WALL), ("post", POST))):
        lines.append(f"o {name}")
        lines += [f"v {x} {y} {z}" for x, y, z in corners]
        lines += ["f " + " ".join(str(8 * first + i) for i in quad) for quad in QUADS]
    return "\n".join(lines)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("mesh")
    (path / "scene.obj").write_text(scene(), encoding="utf-8")
    return synthesised(path, SPEC)


def test_a_motion_over_a_tilted_wall_is_found_and_proved(folder: Path) -> None:
    report = verify_directory(folder)
    assert report.outcome is Outcome.VALID
    assert any("scene.2" in condition.name for condition in report.conditions)
    assert (folder / "spec" / "scene.obj").read_text(encoding="utf-8") == scene()


def placed(corners: np.ndarray) -> np.ndarray:
    """The corners in the workspace, in metres, by matrices of NumPy."""
    a, b = np.radians(8), np.radians(5)
    about_z = [[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]]
    about_y = [[np.cos(b), 0, np.sin(b)], [0, 1, 0], [-np.sin(b), 0, np.cos(b)]]
    found: np.ndarray = corners / 1000 @ (np.array(about_z) @ about_y).T + [-0.075, 0, 0]
    return found


def test_mujoco_keeps_the_distance(folder: Path) -> None:
    """The links stay as far from the true wall and post as the task says, in MuJoCo."""
    exported = folder / "robot.xml"
    assert quiet("export", folder, "--to", "mjcf", "-o", exported) == 0
    text = exported.read_text(encoding="utf-8")
    states = replay(text, result_files.read(folder)).states
    spec = mujoco.MjSpec.from_string(text)
    for name, corners in (("wall", WALL), ("post", POST)):
        mesh = spec.add_mesh(name=name)
        mesh.uservert = placed(corners).ravel().tolist()
        geom = spec.worldbody.add_geom(type=mujoco.mjtGeom.mjGEOM_MESH, meshname=name, group=3)
        geom.name = name
    model = spec.compile()
    data = mujoco.MjData(model)
    scene_geoms = [model.geom("wall").id, model.geom("post").id]
    moving = [g for g in range(model.ngeom) if model.geom_group[g] == 3 and g not in scene_geoms]
    least = np.inf
    for state in states[:: max(1, len(states) // 200)]:
        data.qpos[:] = state[: model.nq]
        mujoco.mj_kinematics(model, data)
        for geom in moving:
            for other in scene_geoms:
                apart = mujoco.mj_geomDistance(model, data, geom, other, 5.0, None)
                least = min(least, apart)
    assert 0.01 <= least < 0.2


def test_a_higher_wall_is_not_avoided(folder: Path) -> None:
    """The hand passes nearer than 3 cm over it: 3 cm higher, the same motion is refuted."""
    old, new = "move((-0.075, 0, 0) m)", "move((-0.075, 0, 0.03) m)"
    result_files.alter_spec(folder, old, new, sign=True)
    report = verify_directory(folder)
    result_files.alter_spec(folder, new, old, sign=True)
    assert report.outcome is Outcome.REFUTED
    assert "scene" in str(report.reason)


def test_other_bytes_are_another_specification(folder: Path) -> None:
    mesh = folder / "spec" / "scene.obj"
    kept = mesh.read_bytes()
    mesh.write_bytes(kept + b"# more\n")
    status, text = said("verify", folder)
    mesh.write_bytes(kept)
    assert status != 0
    assert "sha256" in text or "altered" in text


# --- what check says -----------------------------------------------------------------------------

CHECKED = """\
workspace W {{
  {dimension};
  bounds box [-9, 9] x [-9, 9]{third} m;
  {clause}
}}
"""


def checked(
    folder: Path, clause: str, mesh: str = "", name: str = "scene.obj", size: int = 3
) -> tuple[int, str]:
    (folder / name).write_text(mesh or scene(), encoding="utf-8")
    dimension, third = ("space xyz", " x [-9, 9]") if size == 3 else ("plane xy", "")
    text = CHECKED.format(dimension=dimension, third=third, clause=clause)
    (folder / "a.srg").write_text(text, encoding="utf-8")
    return said("check", folder / "a.srg")


@pytest.mark.parametrize(
    ("place", "size", "says"),
    [
        (" in mm", 3, "note[SRG0611]: obstacle `scene`: 2 convex pieces from 24 triangles\n"),
        (" in mm at world", 2, "2 convex pieces from 24 triangles\n"),
        (" in mm at rot(z, 45 deg) * move(x, 1 m)", 2, "rounded outwards by at most"),
        (" in mm at move((8.75, 0, 0) m)", 3, "1 convex piece from 24 triangles, 1 more piece"),
        (" at move(x, 1000 m)", 3, "[SRG0605]: obstacle `scene` lies outside the bounds"),
    ],
)
def test_what_is_said_of_a_mesh(tmp_path: Path, place: str, size: int, says: str) -> None:
    status, text = checked(tmp_path, f'obstacles from "scene.obj"{place};', size=size)
    assert status == 0, text
    assert says in text


@pytest.mark.parametrize(
    ("clause", "size", "says"),
    [
        ('obstacles from "scene.obj" in kg;', 3, "error[SRG0301]"),
        ('obstacles from "scene.obj" in m*deg;', 3, "not a rational number"),
        ('obstacles from "scene.obj" at 3 m;', 3, "expected a frame"),
        ('obstacles from "scene.obj" at rot(z, q);', 3, "unknown name `q`"),
        ('obstacles from "scene.obj" at rot(z, 3 m);', 3, "error[SRG0301]"),
        ('obstacles from "scene.obj" at rot(x, 3 deg);', 2, "a rotation about x leaves the plane"),
        ('obstacles from "scene.obj" at move((0, 0, 1) m);', 2, "this component leaves the plane"),
        ('obstacles from "scene.obj" at move(z, 1 m);', 2, "a move along z leaves the plane"),
        ('obstacles from "scene.stl";', 3, "cannot read `scene.stl`"),
        ('obstacles from "scene.dae";', 3, "`srgc import scene scene.dae`"),
        ('obstacles from "scene.scene";', 3, "`srgc import scene scene.scene`"),
        ('obstacles from "scene.sdf";', 3, "`srgc import scene scene.sdf`"),
        ('obstacles from "scene.ply";', 3, "meshes (`.stl`, `.obj`)"),
        ('obstacles from "../scene.obj";', 3, "outside the folder"),
        ('obstacles from "scene.obj"; region scene box [0, 1] x [0, 1] x [0, 1];', 3, "SRG0202"),
        ('obstacles from "y.geojson" in mm;', 2, "only meshes take a unit and a frame"),
        ('obstacles from "y.geojson" at rot(z, 1);', 2, "only meshes take a unit and a frame"),
        ('obstacles from "y.geojson";', 3, "a map of obstacles lies in the plane"),
    ],
)
def test_what_is_wrong_with_the_clause(tmp_path: Path, clause: str, size: int, says: str) -> None:
    empty = '{"type": "FeatureCollection", "features": []}'
    (tmp_path / "y.geojson").write_text(empty, encoding="utf-8")
    status, text = checked(tmp_path, clause, size=size)
    assert status == 1
    assert says in text


FLAT = "o Sheet of paper\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3 4\n"


@pytest.mark.parametrize(
    ("mesh", "name", "says"),
    [
        (FLAT, "a.obj", "error[SRG0608]: object `Sheet of paper` of this mesh has no interior"),
        ("v 1 2 3\n", "a.obj", "this is not a mesh: it has no triangle"),
        ("solid a\nendsolid a\n", "a.stl", "this is not a mesh: it has no triangle"),
        ("PK\x03\x04", "a.stl", "this is not a mesh"),
    ],
)
def test_what_is_wrong_with_the_file(tmp_path: Path, mesh: str, name: str, says: str) -> None:
    status, text = checked(tmp_path, f'obstacles from "{name}";', mesh, name)
    assert status == 1
    assert says in text
    assert "Traceback" not in text


def test_the_pieces_are_regions_of_a_picture(tmp_path: Path) -> None:
    checked(
        tmp_path, 'region A box [-1, 0] x [-1, 0] x [-1, 0] m; obstacles from "scene.obj" in mm;'
    )
    drawn = tmp_path / "a.dot"
    assert quiet("graph", tmp_path / "a.srg", "--of", "workspace", "-o", drawn) == 0
    text = drawn.read_text(encoding="utf-8")
    assert "scene.1" in text
    assert "scene.2" in text
