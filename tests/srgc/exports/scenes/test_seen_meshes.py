"""Visuals in ``srgc export --to gltf`` and ``srgc view``: where planar algebra puts them."""

from __future__ import annotations

import builtins
import re
import subprocess
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from srgc.cli import run
from srgc.exports.design_export import export_bytes
from srgc.results.found_design import found_design
from srgc.view.shown_designs import shown_designs
from tests.oracles import pictured_arm as arm
from tests.oracles import result_files
from tests.oracles.glb_files import GlbFile
from tests.oracles.mujoco_motions import Sampled, sampled
from tests.srgc.conftest import Ran

Export = Callable[..., Ran]
SINGLE = 2e-6
"""Metres: a chain of poses in single precision."""


def exported(folder: Path, form: str, path: Path) -> bytes:
    assert run(["export", str(folder), "--to", form, "-o", str(path)]) == 0
    return path.read_bytes()


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return arm.pictured_arm(tmp_path_factory.mktemp("pictured") / "out")


@pytest.fixture(scope="module")
def expected(folder: Path) -> Sampled:
    mjcf = export_bytes(found_design(folder), "mjcf").decode()
    return sampled(mjcf, result_files.read(folder), arm.JOINTS, arm.EFFECTORS)


def same(points: np.ndarray, others: np.ndarray) -> None:
    """Two sets of points are equal, but for rounding."""
    gaps = np.linalg.norm(points[:, None] - others, axis=2)
    assert gaps.min(axis=0).max() < SINGLE
    assert gaps.min(axis=1).max() < SINGLE


def corners(file: GlbFile, name: str, pose: np.ndarray) -> np.ndarray:
    """The vertices of a node in the world of the robot, whose z is up."""
    node = file.content["nodes"][file.node(name)]
    primitives = file.content["meshes"][node["mesh"]]["primitives"]
    local = np.concatenate([file.table(each["attributes"]["POSITION"]) for each in primitives])
    x, y, z = (local @ pose[:3, :3].T + pose[:3, 3]).T
    return np.stack([x, -z, y], axis=1)


def test_vertices_move_with_their_links(folder: Path, expected: Sampled, tmp_path: Path) -> None:
    file = GlbFile.read(exported(folder, "gltf", tmp_path / "arm.glb"))
    for time, state in zip(expected.times, expected.states, strict=True):
        poses = file.poses(float(time))
        for name, points in arm.seen(state[:2]).items():
            same(corners(file, name, poses[name]), points)
    assert np.ptp(expected.states[:, :2], axis=0).min() > 0.02


def test_triangles_are_those_of_the_files(folder: Path, tmp_path: Path) -> None:
    """Their areas add up, and both sides are seen."""
    file = GlbFile.read(exported(folder, "gltf", tmp_path / "arm.glb"))
    stl = np.array(arm.tube()) / 1000
    content = file.content
    for name, area in (
        ("B_0", arm.FOOT.area), ("J_1_link", areas(stl)),
    ):  # fmt: skip
        (primitive,) = content["meshes"][content["nodes"][file.node(name)]["mesh"]]["primitives"]
        points = file.table(primitive["attributes"]["POSITION"])
        faces = file.table(primitive["indices"]).reshape(-1, 3)
        assert areas(points[faces]) == pytest.approx(area, rel=1e-5)
        assert content["materials"][primitive["material"]]["doubleSided"]


def areas(triangles: np.ndarray) -> float:
    one, two, three = np.moveaxis(triangles, 1, 0)
    return float(np.linalg.norm(np.cross(two - one, three - one), axis=1).sum() / 2)


@pytest.fixture
def page(folder: Path) -> Iterator[Any]:
    pytest.importorskip("viser", reason="the extra view is not installed")
    from srgc.view.page import ViewPage
    from srgc.view.serving import viewer_server

    page = ViewPage(server := viewer_server(None), shown_designs([folder], tubes=False).designs)
    yield page
    server.stop()


def placed(page: Any, part: str) -> dict[str, np.ndarray]:
    """The vertices of what is drawn of each link, in the world, by viser's tree of nodes."""
    from scipy.spatial.transform import Rotation

    frames = {frame.name: frame for frame in page.frames[0]["links"]}
    found = dict[str, list[np.ndarray]]()
    for handle in page.parts[part]:
        frame = frames[handle.name.rpartition("/")[0]]
        w, x, y, z = frame.wxyz
        points = Rotation.from_quat([x, y, z, w]).apply(handle.vertices + handle.position)
        found.setdefault(frame.name.rpartition("/")[2], []).append(points + frame.position)
    return {name: np.concatenate(points) for name, points in found.items()}


def test_the_page_has_them_where_they_are(page: Any, expected: Sampled) -> None:
    for time, state in zip(expected.times, expected.states, strict=True):
        page.show(float(time))
        found = placed(page, "Links")
        assert found.keys() == arm.seen(state[:2]).keys()
        for name, points in arm.seen(state[:2]).items():
            same(found[name], points)


def test_the_page_has_collision_bodies_once_they_are_chosen(page: Any) -> None:
    """The boxes of the spec, a centimetre thick, and its effector has no body."""
    assert not any(handle.visible for handle in page.parts["Collision bodies"])
    page.show(0.0)
    found = placed(page, "Collision bodies")
    q, half = arm.START, np.array([[x, y, z] for x in (-1, 1) for y in (-1, 1) for z in (-1, 1)])
    fore = arm.turn(q[0] + q[1])
    same(found["B_0"], half * (0.03, 0.03, 0.005))
    same(found["J_1_link"], (half * (0.2, 0.02, 0.005) + (0.2, 0, 0)) @ arm.turn(q[0]).T)
    elbow = arm.turn(q[0]) @ (0.4, 0, 0)
    same(found["K_2_link"], elbow + (half * (0.12, 0.02, 0.005) + (0.12, 0, 0)) @ fore.T)
    page._hide("Collision bodies", visible=True)
    assert all(handle.visible for handle in page.parts["Collision bodies"])


def test_bounds_hold_what_is_drawn(folder: Path, expected: Sampled) -> None:
    (shown,) = shown_designs([folder], tubes=False).designs
    low, high = shown.bounds
    for state in expected.states:
        for points in arm.seen(state[:2]).values():
            assert (points > low - 1e-9).all()
            assert (points < high + 1e-9).all()


# --- what cannot be drawn -------------------------------------------------------------------------


BROKEN = {
    "seen/foot.dae": (b"<COLLADA>", "seen/foot.dae:1:10: error[SRG0801]: this is not XML"),
    "seen/tube.stl": (b"solid that is none", "seen/tube.stl:1:1: error[SRG0801]: it was cut off"),
    "seen/wedge.obj": (
        b"v 0 0 0\nf 1 2 3\n",
        "seen/wedge.obj:1:1: error[SRG0801]: a face names a vertex",
    ),
    "seen/hand.glb": (
        b"glTF\x02\0\0\0",
        "seen/hand.glb:1:1: error[SRG0801]: it cannot be read as binary glTF 2.0",
    ),
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_damaged_file_is_left_out_with_a_note(srgc: Export, tmp_path: Path, name: str) -> None:
    content, says = BROKEN[name]
    folder = arm.pictured_arm(tmp_path / "out", {name: content})
    ran = srgc("export", folder, "--to", "gltf", "-o", tmp_path / "arm.glb")
    assert (ran.status, ran.err.count("\n")) == (0, 1)
    assert ran.err.startswith(f"note: a visual is not drawn: {says}")
    assert shown_designs([folder], tubes=False).notes == (f"out: {ran.err[6:-1]}",)
    file = GlbFile.read((tmp_path / "arm.glb").read_bytes())
    poses, q = file.poses(0.0), np.array(arm.START)
    if name == "seen/wedge.obj":  # the hand is in this link, too
        same(corners(file, "K_2_link", poses["K_2_link"]), arm.seen(q)["K_2_link"][8:])
    if name == "seen/tube.stl":  # the shape of the link, 40 by 4 by 1 cm
        points = corners(file, "J_1_link", poses["J_1_link"]) @ arm.turn(q[0])
        assert np.ptp(points, axis=0) == pytest.approx([0.4, 0.04, 0.01], abs=SINGLE)


@pytest.mark.parametrize("form", ["gltf", "mcap", "view"])
def test_a_missing_file_is_told_as_of_other_exports(
    srgc: Export, tmp_path: Path, form: str
) -> None:
    folder = arm.pictured_arm(tmp_path / "out")
    (folder / "spec" / "seen" / "tube.stl").unlink()
    there = srgc("export", folder, "--to", "urdf", "-o", tmp_path / "arm.urdf")
    command = ("view", folder) if form == "view" else ("export", folder, "--to", form)
    if form == "view":
        pytest.importorskip("viser", reason="the extra view is not installed")
    assert srgc(*command) == Ran(there.status, "", there.err)
    assert (there.status, there.err.count("\n")) == (2, 1)


def test_without_a_library_shapes_are_drawn(
    srgc: Export, folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    there = builtins.__import__

    def without(name: str, *rest: Any) -> Any:
        if name.partition(".")[0] in ("trimesh", "collada"):
            raise ModuleNotFoundError(name, name=name.partition(".")[0])
        return there(name, *rest)

    monkeypatch.setattr(builtins, "__import__", without)
    ran = srgc("export", folder, "--to", "gltf", "-o", tmp_path / "arm.glb")
    assert ran.status == 0
    assert ran.err == "".join(
        f"note: a visual is not drawn: seen/{name} needs the library {library}: "
        'pip install "srgc[import]"\n'
        for name, library in (("foot.dae", "collada"), ("tube.stl", "trimesh"))
    )


def test_what_may_touch_is_told_with_visuals_too(srgc: Export, tmp_path: Path) -> None:
    """MJCF excludes the pairs of neighbours, as without visuals."""
    text = arm.SPEC.replace("reach T;", "reach T; avoid self with body;")
    folder = arm.pictured_arm(tmp_path / "out", text=text)
    found = re.findall(
        r"<exclude body1=.(\w+). body2=.(\w+).", srgc("export", folder, "--to", "mjcf").out
    )
    assert found == [("B_0", "J_1_link"), ("J_1_link", "K_2_link")]


def test_same_design_same_bytes(folder: Path, tmp_path: Path) -> None:
    from tests.conftest import srgc_process

    first = exported(folder, "gltf", tmp_path / "arm.glb")
    process: subprocess.Popen[bytes] = srgc_process(
        ["export", folder, "--to", "gltf"], tmp_path, PYTHONHASHSEED="7"
    )
    assert process.communicate() == (first, b"")
