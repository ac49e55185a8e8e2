"""Meshes for the eye alone: they change no robot, stand beside exports, and are seen in place."""

from __future__ import annotations

import contextlib
import io
import json
import struct
import xml.etree.ElementTree as ET
from pathlib import Path

import mujoco
import numpy as np
import pytest

from srgc.cli import run
from tests.oracles.command_line import quiet
from tests.oracles.mesh_files import WEDGE, binary_stl, text_stl, tube

SPEC = """\
module B { role base; port out: T; frame out = in; VISUAL_BASE }
module J { role joint; dof q: revolute z in [-170, 170] deg; port in: T;
  frame seen = in * rot(z, q); port out: T; frame out = seen * move(x, 25 cm); VISUAL_ARM
  solid(frame: seen, mass: 2 kg, com: (10, 0) cm, inertia: 0.02 kg*m^2); }
module C { role joint; dof q: revolute z; port in: T; frame turned = in * rot(z, q);
  VISUAL_CAMERA effector(frame: in); }
grammar G from ports { start B; with J, C; accept matches B J C; }
workspace W {
  plane xy;
  bounds box [-1, 1] x [-1, 1] m;
  region S box [0.2, 0.3] x [-0.1, 0.1] m;
  target T box [-0.1, 0.1] x [0.2, 0.3] m;
}
task Go { robot G; workspace W; start in S at rest; reach T;
  effort <= 5 N*m; horizon 12 steps of 0.1 s; }
"""
VISUALS = {
    "VISUAL_BASE": 'visual(frame: in, file: "seen/any.dae", scale: 1 m);',
    "VISUAL_ARM": 'visual(frame: seen * move((10, 2) cm) * rot(z, 30 deg), file: "seen/tube.stl", '
    'scale: 1 mm); visual(frame: seen, file: "seen/wedge.obj", scale: 2 mm);',
    "VISUAL_CAMERA": 'visual(frame: turned, file: "seen/wedge.obj", scale: 1 mm);',
}
ANYTHING = b"\x00\xff neither XML nor anything else"


def said(*arguments: object) -> tuple[int, str]:
    """The exit status of a command, and all that it prints."""
    out = io.TextIOWrapper(io.BytesIO(), encoding="utf-8", write_through=True)
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(out):
        status = run([str(argument) for argument in arguments])
    out.seek(0)
    return status, out.read()


def written(folder: Path, *, seen: bool = True, **changed: str) -> Path:
    (folder / "seen").mkdir(exist_ok=True)
    (folder / "seen" / "any.dae").write_bytes(ANYTHING)
    (folder / "seen" / "tube.stl").write_bytes(text_stl(tube()))
    (folder / "seen" / "wedge.obj").write_text(WEDGE, encoding="utf-8")
    text = SPEC
    for place, visual in VISUALS.items():
        text = text.replace(place, changed.get(place, visual) if seen else "")
    (folder / "g.srg").write_text(text, encoding="utf-8")
    return folder / "g.srg"


@pytest.fixture(scope="module")
def folders(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, Path]:
    """The results without visuals, and with them."""
    found = []
    for name, seen in (("bare", False), ("seen", True)):
        scratch = tmp_path_factory.mktemp(name)
        assert quiet("synth", written(scratch, seen=seen), "-o", scratch / "out", "-q") == 0
        found.append(scratch / "out")
    return found[0], found[1]


def test_the_robot_and_its_motion_are_the_same(folders: tuple[Path, Path]) -> None:
    bare, seen = (json.loads((f / "certificate.json").read_text("utf-8")) for f in folders)
    assert bare["spec_sha256"] != seen["spec_sha256"]
    for each in (bare, seen):
        del each["spec_sha256"], each["digest"]
    assert bare == seen
    trajectories = [(folder / "trajectory.csv").read_bytes() for folder in folders]
    assert trajectories[0] == trajectories[1]
    assert quiet("verify", folders[1]) == 0


def test_the_files_are_copied_and_part_of_the_specification(folders: tuple[Path, Path]) -> None:
    copy = folders[1] / "spec" / "seen" / "any.dae"
    assert copy.read_bytes() == ANYTHING
    copy.write_bytes(ANYTHING + b".")
    status, text = said("verify", folders[1])
    copy.write_bytes(ANYTHING)
    assert status != 0
    assert "sha256" in text or "altered" in text


def triangles(data: bytes) -> np.ndarray:
    """The corners (n, 3, 3) of a binary STL, read without the project."""
    (count,) = struct.unpack_from("<I", data, 80)
    assert len(data) == 84 + 50 * count
    rows = [struct.unpack_from("<12f", data, 84 + 50 * i)[3:] for i in range(count)]
    return np.array(rows).reshape(-1, 3, 3)


def test_urdf_names_files_beside_it(folders: tuple[Path, Path], tmp_path: Path) -> None:
    output = tmp_path / "arm.urdf"
    assert quiet("export", folders[1], "--to", "urdf", "-o", output) == 0
    root = ET.fromstring(output.read_text(encoding="utf-8"))
    found = []
    for link in root.findall("link"):
        for visual in link.findall("visual"):
            mesh, origin = visual.find("geometry/mesh"), visual.find("origin")
            assert mesh is not None
            assert origin is not None
            place = [float(x) for key in ("xyz", "rpy") for x in str(origin.get(key)).split()]
            found.append((link.get("name"), mesh.get("filename"), mesh.get("scale"), place))
        assert not link.findall("collision")
    assert found == [
        ("B_0", "arm.visual_1.dae", "1.0 1.0 1.0", [0] * 6),
        ("J_1_link", "arm.visual_2.stl", "0.001 0.001 0.001",
         pytest.approx([0.1, 0.02, 0, 0, 0, np.pi / 6])),
        ("J_1_link", "arm.visual_3.obj", "0.002 0.002 0.002", [0] * 6),
        ("J_1_link", "arm.visual_3.obj", "0.001 0.001 0.001", [0.25, 0, 0, 0, 0, 0]),
    ]  # fmt: skip
    assert (tmp_path / "arm.visual_1.dae").read_bytes() == ANYTHING
    assert (tmp_path / "arm.visual_3.obj").read_text(encoding="utf-8") == WEDGE
    # Text becomes binary, which MuJoCo reads; the triangles are the same.
    corners = triangles((tmp_path / "arm.visual_2.stl").read_bytes())
    assert np.allclose(corners, np.array(tube()), atol=1e-4)


def test_what_moves_visuals_alone_is_no_joint(folders: tuple[Path, Path], tmp_path: Path) -> None:
    """The camera turns, and nothing else behind it: it is fixed, as without its picture."""
    output = tmp_path / "arm.urdf"
    assert quiet("export", folders[1], "--to", "urdf", "-o", output) == 0
    root = ET.fromstring(output.read_text(encoding="utf-8"))
    assert [j.get("name") for j in root.findall("joint") if j.get("type") != "fixed"] == ["J_1"]
    places = [
        origin.get("xyz")
        for visual in root.iter("visual")
        if (mesh := visual.find("geometry/mesh")) is not None
        and mesh.get("scale") == "0.001 0.001 0.001"
        and str(mesh.get("filename")).endswith(".obj")
        and (origin := visual.find("origin")) is not None
    ]
    assert places == ["0.25 0.0 0.0"]


def test_mujoco_sees_them_where_they_are(folders: tuple[Path, Path], tmp_path: Path) -> None:
    """Vertices in the world at q = 0.7, by NumPy; no mass, no collision, group 2."""
    output = tmp_path / "arm.xml"
    status, text = said("export", folders[1], "--to", "mjcf", "-o", output)
    assert status == 0
    assert "the visual any.dae is left out of the MJCF" in text
    assert not (tmp_path / "arm.visual_1.dae").exists()
    model = mujoco.MjModel.from_xml_path(str(output))
    assert model.geom_contype.tolist() == [0] * model.ngeom
    assert model.geom_group.tolist() == [2] * model.ngeom
    assert sum(model.body_mass) == pytest.approx(2.0)
    data = mujoco.MjData(model)
    data.qpos[:] = 0.7
    mujoco.mj_kinematics(model, data)
    seen = []
    for geom in np.flatnonzero(model.geom_type == mujoco.mjtGeom.mjGEOM_MESH):
        mesh = model.geom_dataid[geom]
        first, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
        local = model.mesh_vert[first : first + count]
        seen.append(local @ data.geom_xmat[geom].reshape(3, 3).T + data.geom_xpos[geom])
    wedge = np.array([list(map(float, line.split()[1:])) for line in WEDGE.splitlines()
                      if line.startswith("v ")])  # fmt: skip
    stl = np.unique(np.array(tube()).reshape(-1, 3), axis=0)

    def turn(angle: float) -> np.ndarray:
        c, s = np.cos(angle), np.sin(angle)
        return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])

    expected = [
        ((stl / 1000) @ turn(np.pi / 6).T + [0.1, 0.02, 0]) @ turn(0.7).T,
        (wedge / 500) @ turn(0.7).T,
        (wedge / 1000 + [0.25, 0, 0]) @ turn(0.7).T,
    ]
    assert len(seen) == 3
    for there in expected:
        assert any(len(each) <= len(there) and np.all(nearest(each, there) < 1e-6) for each in seen)


def nearest(points: np.ndarray, others: np.ndarray) -> np.ndarray:
    """For each point its distance from the nearest of others."""
    found: np.ndarray = np.linalg.norm(points[:, None] - others, axis=2).min(axis=1)
    return found


@pytest.mark.parametrize("form", ["urdf", "mjcf"])
def test_a_printed_robot_says_what_it_lacks(folders: tuple[Path, Path], form: str) -> None:
    status, text = said("export", folders[1], "--to", form)
    assert status == 0
    assert "visuals are files of their own" in text
    assert "visual_1" not in text


def test_everything_has_the_files(folders: tuple[Path, Path], tmp_path: Path) -> None:
    assert quiet("export", folders[1], "--to", "all", "-o", tmp_path / "all") == 0
    names = {path.name for path in (tmp_path / "all").iterdir()}
    assert {"robot.visual_1.dae", "robot.visual_2.stl", "robot.visual_3.obj"} <= names
    assert mujoco.MjModel.from_xml_path(str(tmp_path / "all" / "robot.xml")).nmesh == 3


@pytest.mark.parametrize(
    ("name", "data"),
    [
        ("tube.stl", b"solid that is none"),
        ("tube.stl", binary_stl(tube())[:-9]),
        ("tube.stl", binary_stl([[(0, 0, 0), (1, 0, 0), (0, 1, 0)]])),
        ("tube.stl", binary_stl([[(0, 0, float("nan"))] * 3])),
        ("wedge.obj", b"v 0 0 0\nf 1 2 3\n"),
        ("wedge.obj", b""),
    ],
)
def test_damaged_files_are_left_out_of_mjcf(
    folders: tuple[Path, Path], tmp_path: Path, name: str, data: bytes
) -> None:
    """A result of damaged files: URDF has them, MuJoCo loads a robot without them."""
    scratch = tmp_path / "work"
    scratch.mkdir()
    spec = written(scratch)
    (scratch / "seen" / name).write_bytes(data)
    assert quiet("synth", spec, "-o", scratch / "out", "-q") == 0
    output = tmp_path / "arm.xml"
    status, text = said("export", scratch / "out", "--to", "mjcf", "-o", output)
    assert status == 0
    assert f"the visual {name} is left out" in text
    assert mujoco.MjModel.from_xml_path(str(output)).nq == 1
    assert quiet("export", scratch / "out", "--to", "urdf", "-o", tmp_path / "arm.urdf") == 0
    assert data in {path.read_bytes() for path in tmp_path.glob("arm.visual_*")}


@pytest.mark.parametrize(
    ("visual", "says"),
    [
        (
            'visual(frame: in, file: "seen/any.ply", scale: 1 m);',
            "this file extension is not that of a visual",
        ),
        ('visual(frame: in, file: "seen/anny.dae", scale: 1 m);', "did you mean"),
        ('visual(frame: in, file: "../any.dae", scale: 1 m);', "outside the folder"),
        ('visual(frame: in, file: "seen/any.dae");', "`visual` lacks `scale`"),
        ('visual(frame: in, file: "seen/any.dae", scale: 0 m);', "not positive"),
        ('visual(frame: in, file: "seen/any.dae", scale: 1 kg);', "expected a length"),
        ("visual(frame: in, file: 3, scale: 1 m);", "the file of a visual is a path in quotes"),
        ('visual(frame: 3, file: "seen/any.dae", scale: 1 m);', "expected a frame"),
        ('visual(frame: in * rot(x, 1), file: "seen/any.dae", scale: 1 m);', "leaves the plane"),
    ],
)
def test_what_is_wrong_with_a_visual(tmp_path: Path, visual: str, says: str) -> None:
    status, text = said("check", written(tmp_path, VISUAL_BASE=visual))
    assert status == 1
    assert says in text


def test_a_visual_is_no_shape(tmp_path: Path) -> None:
    """The solid collides as a point all the same, and `check` says so."""
    spec = written(tmp_path)
    text = spec.read_text(encoding="utf-8").replace("reach T;", "reach T; bounds with body;")
    spec.write_text(text, encoding="utf-8")
    status, found = said("check", spec)
    assert status == 0
    assert "warning[SRG0719]" in found


def test_a_frame_that_only_a_visual_needs(tmp_path: Path) -> None:
    """An attribute that no emission reads: it is evaluated for the export, with its parameter."""
    spec = written(tmp_path)
    text = spec.read_text(encoding="utf-8")
    start, end = text.index("module B"), text.index("workspace W")
    spec.write_text(
        """module B { role base; }
module J { role joint; dof q: revolute z in [-170, 170] deg; }
module E { role effector; const up = 3 cm; }
grammar G { start N; all: N -> Arm; arm: Arm -> B J E; }
semantics G {
  all { visual(frame: Arm.camera * rot(z, 90 deg), file: "seen/wedge.obj", scale: 1 mm); }
  arm { this.turned = rot(z, J.q); this.camera = this.turned * move(x, E.up);
    solid(frame: this.turned, mass: 2 kg, com: (10, 0) cm, inertia: 0.02 kg*m^2);
    effector(frame: this.turned * move(x, 25 cm)); }
}
"""
        + text[end:],
        encoding="utf-8",
    )
    assert start == 0
    assert quiet("synth", spec, "-o", tmp_path / "out", "-q") == 0
    output = tmp_path / "arm.urdf"
    assert quiet("export", tmp_path / "out", "--to", "urdf", "-o", output) == 0
    (visual,) = [v for v in ET.fromstring(output.read_text("utf-8")).iter("visual")
                 if v.find("geometry/mesh") is not None]  # fmt: skip
    origin = visual.find("origin")
    assert origin is not None
    assert (origin.get("xyz"), origin.get("rpy")) == ("0.03 0.0 0.0", f"0.0 0.0 {np.pi / 2!r}")
