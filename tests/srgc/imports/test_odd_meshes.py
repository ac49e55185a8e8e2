"""Meshes as other programs write them: polygons that are not convex, two sides, units unsaid."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import trimesh
from shapely.geometry import Polygon

from srgc.faults import UsageFault
from srgc.imports.meshes.decomposition import decomposed
from srgc.imports.meshes.mesh_file import read_mesh
from srgc.imports.meshes.solids import anatomy
from srgc.imports.scenes.scene_import import scene_import

ANGLE = [(0, 0), (4, 0), (4, 1), (1, 1), (1, 5), (0, 5)]
DART = [(0, 0), (2, -1), (1, 0), (2, 1)]


def polygon_obj(ring: list[tuple[int, int]], first: int) -> str:
    """A polygon of the plane, turned in space, that begins with one of its corners."""
    ring = [*ring[first:], *ring[:first]]
    lines = [f"v {0.6 * x - 0.8 * y} {0.8 * x + 0.6 * y} {0.5 * x}" for x, y in ring]
    return "\n".join([*lines, "f " + " ".join(str(i - len(ring)) for i in range(len(ring)))]) + "\n"


@pytest.mark.parametrize("ring", [ANGLE, ANGLE[::-1], DART])
def test_faces_that_are_not_convex_are_their_triangles(tmp_path: Path, ring) -> None:
    """The triangles are in the polygon and have its area, whichever corner comes first."""
    for first in range(len(ring)):
        (tmp_path / "face.obj").write_text(polygon_obj(ring, first))
        mesh = read_mesh(tmp_path / "face.obj")
        turned = [*ring[first:], *ring[:first]]
        triangles = [Polygon([turned[i] for i in row]) for row in mesh.triangles.tolist()]
        whole = Polygon(ring)
        assert sum(each.area for each in triangles) == pytest.approx(whole.area)
        assert all(whole.buffer(1e-9).contains(each) for each in triangles)
        signs = [each.exterior.is_ccw for each in triangles]
        assert set(signs) == {whole.exterior.is_ccw}


def test_a_face_that_names_vertex_0(tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 0 1 2\nv 0 0 1\n")
    with pytest.raises(UsageFault, match=r"a\.obj:4.*not there"):
        read_mesh(tmp_path / "a.obj")


def test_a_box_with_two_sides_is_solid() -> None:
    """As drawing programs write walls that are to be seen from either side."""
    box = trimesh.creation.box((0.4, 0.3, 0.2))
    faces = np.concatenate([box.faces, box.faces[:, ::-1]])
    parts = anatomy(np.asarray(box.vertices), faces)
    assert [each.volume() for each in parts.solids] == [pytest.approx(0.024)]
    assert len(decomposed(np.asarray(box.vertices), faces).pieces) == 1


@pytest.mark.parametrize("seed", range(3))
def test_mixed_winding_of_many_triangles(seed: int) -> None:
    """Turned at random; the volume is that of the ball."""
    ball = trimesh.creation.icosphere(subdivisions=3)
    rng = np.random.default_rng(seed)
    mixed = np.where(rng.random(len(ball.faces))[:, None] < 0.4, ball.faces[:, ::-1], ball.faces)
    parts = anatomy(np.asarray(ball.vertices), mixed.astype(np.int64))
    assert [each.volume() for each in parts.solids] == [pytest.approx(ball.volume)]
    assert "mixed winding" in parts.notes[0]


def test_a_file_in_millimetres_is_asked_about(tmp_path: Path) -> None:
    path = tmp_path / "part.stl"
    trimesh.creation.box((400, 30, 20)).export(path)
    assert scene_import(path).remarks[0] == (
        "part.stl is 400 m large; --unit mm if it is in millimetres"
    )
    assert not any("--unit" in remark for remark in scene_import(path, unit="mm").remarks)
