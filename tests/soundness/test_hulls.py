"""Links that collide as the hulls of meshes: read, kept apart, copied, exported, refuted."""

from __future__ import annotations

import contextlib
import io
from pathlib import Path

import mujoco
import numpy as np
import pytest
from scipy.integrate import solve_ivp

import srgc
from solvers.verifier.verification import Outcome, verify_directory
from srgc.cli import run
from tests.oracles import result_files
from tests.oracles.mesh_files import WEDGE, binary_stl, text_stl, tube

SPEC = """\
module B { role base; }
module J { role joint; dof q: revolute z in [-170, 170] deg; }
module E { role effector; }
grammar G { start N; all: N -> B J E; }
semantics G { all {
  this.turned = rot(z, J.q);
  solid(frame: this.turned, mass: 2 kg, com: (0.1, 0) m, inertia: 0.02 kg*m^2);
  hull(frame: this.turned, file: "parts/wedge.obj", scale: 1 mm);
  effector(frame: this.turned * move(x, 0.25 m));
} }
workspace W {
  plane xy;
  bounds box [-1, 1] x [-1, 1] m;
  region S box [0.2, 0.3] x [-0.1, 0.1] m;
  target T box [-0.1, 0.1] x [0.2, 0.3] m;
  obstacle O box [WEST, 0.3] x [0.2, 0.3] m;
}
task Go { robot G; workspace W; start in S at rest; reach T; avoid O with body;
  effort <= 5 N*m; horizon 12 steps of 0.1 s; }
"""


def quiet(*arguments: object) -> tuple[int, str]:
    out = io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(io.StringIO()):
        status = run([str(argument) for argument in arguments])
    return status, out.getvalue()


def written(folder: Path, west: str, mesh: str | bytes = WEDGE, name: str = "wedge.obj") -> Path:
    (folder / "parts").mkdir()
    data = mesh.encode() if isinstance(mesh, str) else mesh
    (folder / "parts" / name).write_bytes(data)
    text = SPEC.replace("WEST", west).replace("wedge.obj", name)
    (folder / "g.srg").write_text(text, encoding="utf-8")
    return folder / "g.srg"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    scratch = tmp_path_factory.mktemp("hulls")
    spec = written(scratch, "0.195")
    assert quiet("synth", spec, "-o", scratch / "out", "-q")[0] == 0
    return scratch / "out"


CORNERS = np.array([[0, -30], [0, 30], [250, -10], [250, 10]]) / 1000


def sweep(folder: Path) -> np.ndarray:
    """The corners of the wedge at 20 instants of every step, (t, 4, 2): one mass that turns."""
    certificate = result_files.read(folder)
    state, found = np.array([float(x) for x in certificate["start"]]), []
    inertia = 0.02 + 2 * 0.1**2
    for row in certificate["inputs"]:
        pull = float(row[0]) / inertia
        done = solve_ivp(
            lambda _, x, a=pull: [x[1], a], (0, 0.1), state, t_eval=np.linspace(0, 0.1, 21)
        )
        for angle in done.y[0]:
            turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
            found.append(CORNERS @ turn.T)
        state = done.y[:, -1]
    return np.array(found)


def test_the_corners_pass_beside_the_obstacle(folder: Path) -> None:
    """Its south-western corner is 0.28 m away, the wedge's tip 0.2502 m; edges do not reach it."""
    assert verify_directory(folder).outcome is Outcome.VALID
    at = sweep(folder)
    inside = (at[..., 0] > 0.195) & (at[..., 1] > 0.2)
    assert not inside.any()
    assert np.linalg.norm(at, axis=2).max() < np.hypot(0.195, 0.2)


def test_the_mesh_goes_with_the_results(folder: Path) -> None:
    assert (folder / "spec" / "parts" / "wedge.obj").read_text(encoding="utf-8") == WEDGE
    path = folder / "spec" / "parts" / "wedge.obj"
    path.write_text(WEDGE.replace("250", "251"), encoding="utf-8")
    assert verify_directory(folder).outcome is Outcome.REFUTED
    path.write_text(WEDGE, encoding="utf-8")
    assert verify_directory(folder).outcome is Outcome.VALID


def test_a_longer_mesh_is_in_the_way(tmp_path: Path) -> None:
    """The tip is 0.32 m away then, and sweeps what is nearer."""
    spec = written(tmp_path, "0.195", WEDGE.replace("v 250", "v 320"))
    status, _ = quiet("synth", spec, "-o", tmp_path / "out", "-q")
    assert status in {3, 4}


def test_the_export_has_the_corners(folder: Path) -> None:
    exported = folder / "robot.xml"
    assert quiet("export", folder, "--to", "mjcf", "-o", exported)[0] == 0
    model = mujoco.MjModel.from_xml_path(str(exported))
    data = mujoco.MjData(model)
    data.qpos[0] = 0.7
    mujoco.mj_forward(model, data)
    (geom,) = [g for g in range(model.ngeom) if model.geom_group[g] == 3]
    turned = model.mesh_vert @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
    turn = np.array([[np.cos(0.7), -np.sin(0.7)], [np.sin(0.7), np.cos(0.7)]])
    expected = {tuple(np.round(corner, 5)) for corner in CORNERS @ turn.T}
    assert {tuple(np.round(vertex[:2], 5)) for vertex in turned.astype(float)} == expected


def triangles(file: Path) -> tuple[np.ndarray, np.ndarray]:
    """The normals (n, 3) and the corners (n, 3, 3) of a binary STL."""
    data = file.read_bytes()
    count = int.from_bytes(data[80:84], "little")
    assert len(data) == 84 + 50 * count
    rows = [np.frombuffer(data, "<f4", 12, 84 + 50 * i).reshape(4, 3) for i in range(count)]
    found = np.array(rows, float)
    return found[:, 0], found[:, 1:]


def test_a_urdf_has_the_hull_beside_it(folder: Path, tmp_path: Path) -> None:
    exported = tmp_path / "arm.urdf"
    (tmp_path / "arm.hull_2.stl").write_bytes(b"of another robot")
    status, said = quiet("export", folder, "--to", "urdf", "-o", exported)
    assert status == 0
    assert said == f"{exported}\n{tmp_path / 'arm.hull_1.stl'}\n"
    normals, corners = triangles(tmp_path / "arm.hull_1.stl")
    flat = {tuple(np.round(corner[:2], 6)) for corner in corners.reshape(-1, 3)}
    assert flat == {tuple(corner) for corner in CORNERS}
    # Closed and seen from outside: the sum of signed tetrahedra is the volume, 250 x 40 x 10 mm^3.
    one, two, three = corners[:, 0], corners[:, 1], corners[:, 2]
    across = np.cross(two - one, three - one)
    assert np.sum(one * np.cross(two, three)) / 6 == pytest.approx(0.25 * 0.04 * 0.01, rel=1e-5)
    assert np.allclose(across / np.linalg.norm(across, axis=1, keepdims=True), normals, atol=1e-5)
    # MuJoCo reads the URDF with what stands beside it.
    model = mujoco.MjModel.from_xml_path(str(exported))
    data = mujoco.MjData(model)
    data.qpos[0] = 0.7
    mujoco.mj_forward(model, data)
    geom = next(g for g in range(model.ngeom) if model.geom_type[g] == mujoco.mjtGeom.mjGEOM_MESH)
    turned = model.mesh_vert @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom]
    turn = np.array([[np.cos(0.7), -np.sin(0.7)], [np.sin(0.7), np.cos(0.7)]])
    expected = {tuple(np.round(corner, 5)) for corner in CORNERS @ turn.T}
    assert {tuple(np.round(vertex[:2], 5)) for vertex in turned.astype(float)} == expected


def test_a_printed_urdf_has_a_box_about_the_hull(folder: Path) -> None:
    text = srgc.export(folder, "urdf")
    assert text.count('<box size="0.25 0.06 0.01"/>') == 2  # for the eye, and for collisions
    assert "<mesh" not in text


def test_hulls_of_an_earlier_export_are_named(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    old = tmp_path / "all" / "robot.hull_2.stl"
    assert run(["export", str(folder), "--to", "all", "-o", str(old.parent)]) == 0
    assert old.with_name("robot.hull_1.stl").exists()
    old.write_bytes(b"")
    capsys.readouterr()
    assert run(["export", str(folder), "--to", "all", "-o", str(old.parent)]) == 0
    assert f"{old} is of an earlier export" in capsys.readouterr().err
    assert run(["export", str(folder), "--to", "urdf", "-o", str(old.parent / "robot.urdf")]) == 0
    assert f"{old} is of an earlier export" in capsys.readouterr().err


@pytest.mark.slow
def test_pinocchio_finds_the_hull(folder: Path, tmp_path: Path) -> None:
    pinocchio = pytest.importorskip("pinocchio")
    exported = tmp_path / "arm.urdf"
    assert quiet("export", folder, "--to", "urdf", "-o", exported)[0] == 0
    model = pinocchio.buildModelFromUrdf(str(exported))
    kind = pinocchio.GeometryType.COLLISION
    place = [str(tmp_path)]
    found = pinocchio.buildGeomFromUrdf(model, str(exported), kind, package_dirs=place)
    (shape,) = found.geometryObjects
    flat = {tuple(np.round(point[:2], 6)) for point in shape.geometry.vertices()}
    assert flat == {tuple(corner) for corner in CORNERS}


@pytest.mark.parametrize("write", [binary_stl, text_stl])
def test_stl_in_both_forms(tmp_path: Path, write: object) -> None:
    assert callable(write)
    spec = written(tmp_path, "0.195", write(tube()), "tube.stl")
    status, said = quiet("check", spec)
    assert status == 0, said


@pytest.mark.parametrize(
    ("mesh", "name", "says"),
    [
        (b"", "a.stl", "no line begins with `facet`"),
        (binary_stl(tube())[:-1], "a.stl", "neither binary of the size that its header says"),
        ("v 1 2\nf 1 1 1\n", "a.obj", "line 1 does not have three numbers of a usual size"),
        ("v 1 2 nan\nf 1 1 1\n", "a.obj", "line 1 does not have three numbers"),
        ("v 1 2 1/0\nf 1 1 1\n", "a.obj", "line 1 does not have three numbers"),
        ("v 1 2 1e999\nf 1 1 1\n", "a.obj", "line 1 does not have three numbers"),
        ("v 1e-999999999 2 3\nf 1 1 1\n", "a.obj", "line 1 does not have three numbers"),
        (b"\n".join(text_stl(tube()).splitlines()[:-5]), "a.stl", "it may have been cut off"),
        ("f 1 2 3\n", "a.obj", "it has no vertex"),
        ("v 1 2 3\n", "a.obj", "no line begins with `f`"),
        ("v 1 2 3\nf 1 1 1\n", "a.ply", "this file extension is not that of a mesh"),
        (binary_stl([[(0, 0, float("inf"))] * 3]), "a.stl", "triangle 1 has a corner that is not"),
    ],
)
def test_what_is_no_mesh(tmp_path: Path, mesh: str | bytes, name: str, says: str) -> None:
    status, said = quiet("check", written(tmp_path, "0.195", mesh, name))
    assert status == 1
    assert says in said


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        ('file: "parts/wedge.obj"', 'file: "parts/wedje.obj"', "did you mean"),
        ('file: "parts/wedge.obj"', 'file: "/etc/wedge.obj"', "absolute path"),
        ('file: "parts/wedge.obj"', 'file: "../wedge.obj"', "outside the folder"),
        ('file: "parts/wedge.obj"', "file: 3 m", "a path in quotes"),
        ("scale: 1 mm", "scale: 0 mm", "not positive"),
        ("scale: 1 mm", "scale: 1 kg", "expected a length"),
        (", scale: 1 mm", "", "`hull` lacks `scale`"),
        ("move(x, 0.25 m)", 'move(x, y: "a.stl")', "error"),
    ],
)
def test_what_is_wrong_with_a_hull(tmp_path: Path, old: str, new: str, says: str) -> None:
    spec = written(tmp_path, "0.195")
    spec.write_text(spec.read_text(encoding="utf-8").replace(old, new), encoding="utf-8")
    status, said = quiet("check", spec)
    assert status == 1
    assert says in said


@pytest.mark.parametrize(
    "vertices", ["v 0 0 0", "v 0 0 0\nv 250 0 0", "v 0 0 0\nv 99 9 0\nv 9 99 0"]
)
def test_meshes_without_volume_are_exported_as_something_thin(
    tmp_path: Path, vertices: str
) -> None:
    spec = written(tmp_path, "0.195", f"{vertices}\nf 1 1 1\n")
    assert quiet("synth", spec, "-o", tmp_path / "out", "-q")[0] == 0
    exported = tmp_path / "robot.xml"
    assert quiet("export", tmp_path / "out", "--to", "mjcf", "-o", exported)[0] == 0
    assert mujoco.MjModel.from_xml_path(str(exported)).nmesh == 1
