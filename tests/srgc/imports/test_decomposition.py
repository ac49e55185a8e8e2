"""Convex pieces of meshes: what they hold, and what they add, against algebra and trimesh."""

from __future__ import annotations

import hashlib
import subprocess
import sys

import numpy as np
import pytest
import trimesh

from srgc.faults import UsageFault
from srgc.imports.meshes.containment import uncovered
from srgc.imports.meshes.convex_piece import MOST_CORNERS
from srgc.imports.meshes.decomposition import decomposed
from srgc.imports.meshes.mesh_file import read_mesh
from srgc.imports.meshes.piece_files import pieces_text, written_pieces
from tests.conftest import ROOT
from tests.srgc.imports.random_meshes import open_mesh, random_mesh


def of(mesh):
    return np.asarray(mesh.vertices, dtype=float), np.asarray(mesh.faces, dtype=np.int64)


def both(*meshes):
    return of(trimesh.util.concatenate(meshes))


def contained(points, pieces):
    """Whether points are in a piece, by planes of scipy."""
    from scipy.spatial import ConvexHull

    inside = np.zeros(len(points), dtype=bool)
    for piece in pieces:
        planes = ConvexHull(piece.points()).equations
        inside |= (points @ planes[:, :3].T + planes[:, 3] <= 1e-12).all(axis=1)
    return inside


def box(lower, upper):
    return trimesh.creation.box(bounds=[lower, upper])


def prism(outline, height):
    from shapely.geometry import Polygon

    from srgc.imports.scenes.polygons import triangulated

    corners, triangles = triangulated(outline, "prism")
    assert Polygon(outline).is_valid
    return trimesh.creation.extrude_triangulation(corners, triangles, height)


@pytest.mark.parametrize("size", [1e-5, 1e-7])
def test_a_mesh_smaller_than_the_thinnest_piece_is_one_piece(size):
    """As of a file whose unit was mistaken; it was split on and on, in vain."""
    corners = size * np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1.0]])
    found = decomposed(corners, np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]]))
    assert len(found.pieces) == 1
    assert contained(corners, found.pieces).all()
    assert found.measures.farthest < 2e-5


L_SHAPE = [(0, 0), (0.4, 0), (0.4, 0.1), (0.1, 0.1), (0.1, 0.5), (0, 0.5)]


def test_an_l_is_two_boxes():
    found = decomposed(*of(prism(L_SHAPE, 0.3)))
    assert len(found.pieces) == 2
    assert all(piece.box() for piece in found.pieces)
    assert found.measures.volume == pytest.approx((0.4 * 0.1 + 0.1 * 0.4) * 0.3)
    assert found.measures.added < 0.01
    assert found.measures.farthest < 1e-3


def test_a_ring_keeps_its_hole():
    mesh = trimesh.creation.annulus(r_min=0.1, r_max=0.15, height=0.08, sections=32)
    found = decomposed(*of(mesh))
    sides = 32 * np.sin(2 * np.pi / 32) / 2
    assert found.measures.volume == pytest.approx(sides * (0.15**2 - 0.1**2) * 0.08)
    assert found.measures.union <= 1.1 * found.measures.volume
    along = np.column_stack([np.zeros(9), np.zeros(9), np.linspace(-0.04, 0.04, 9)])
    assert not contained(along, found.pieces).any()
    angles = np.linspace(0, 2 * np.pi, 500)
    middle = np.column_stack([0.125 * np.cos(angles), 0.125 * np.sin(angles), 0 * angles])
    assert contained(middle, found.pieces).all()


def test_a_solid_is_filled():
    found = decomposed(*of(box((0, 0, 0), (1, 1, 1))))
    assert contained(np.array([[0.5, 0.5, 0.5]]), found.pieces).all()
    assert found.notes == ()


def test_an_open_mesh_is_a_shell():
    vertices, triangles = of(box((0, 0, 0), (1, 1, 1)))
    up = np.isclose(vertices[triangles][:, :, 2], 1).all(axis=1)
    found = decomposed(vertices, triangles[~up])
    assert not contained(np.array([[0.5, 0.5, 0.5], [0.5, 0.5, 1.0]]), found.pieces).any()
    assert contained(np.array([[0.5, 0.5, 0.0], [0.0, 0.5, 0.5]]), found.pieces).all()
    assert found.measures.volume == 0
    assert found.measures.union < 0.01
    assert len(found.thickened) == len(found.pieces)
    assert any("shell" in note for note in found.notes)


def test_triangles_that_look_inwards_are_turned():
    vertices, triangles = of(box((0, 0, 0), (1, 2, 3)))
    found = decomposed(vertices, triangles[:, ::-1])
    assert found.measures.volume == pytest.approx(6)
    assert any("inwards" in note for note in found.notes)
    assert contained(np.array([[0.5, 1.0, 1.5]]), found.pieces).all()


def test_mixed_winding_is_repaired():
    vertices, triangles = of(box((0, 0, 0), (1, 2, 3)))
    mixed = triangles.copy()
    mixed[::3] = mixed[::3, ::-1]
    found = decomposed(vertices, mixed)
    assert found.measures.volume == pytest.approx(6)
    assert any("mixed winding" in note for note in found.notes)


def test_a_box_in_a_box_is_a_cavity_where_it_looks_inwards():
    outer, inner = box((0, 0, 0), (1, 1, 1)), box((0.25, 0.25, 0.25), (0.75, 0.75, 0.75))
    solid = decomposed(*both(outer, inner))
    assert solid.measures.volume == pytest.approx(1)
    assert len(solid.pieces) == 1
    inner.invert()
    hollow = decomposed(*both(outer, inner), detail=0.02)
    assert hollow.measures.volume == pytest.approx(1 - 1 / 8)
    assert not contained(np.array([[0.5, 0.5, 0.5]]), hollow.pieces).any()


def test_a_ball_in_a_cavity_is_solid():
    outer, inner = box((0, 0, 0), (1, 1, 1)), box((0.2, 0.2, 0.2), (0.8, 0.8, 0.8))
    inner.invert()
    core = box((0.45, 0.45, 0.45), (0.55, 0.55, 0.55))
    found = decomposed(*both(outer, inner, core))
    assert found.measures.volume == pytest.approx(1 - 0.6**3 + 0.1**3)
    assert contained(np.array([[0.5, 0.5, 0.5]]), found.pieces).all()


def test_a_crack_is_closed_and_a_hole_is_not():
    ball = trimesh.creation.icosphere(subdivisions=3)
    vertices, triangles = of(ball)
    cracked = decomposed(vertices, triangles[1:])
    assert cracked.measures.volume == pytest.approx(ball.volume, rel=0.01)
    assert any("filled" in note for note in cracked.notes)
    holed = decomposed(vertices, triangles[vertices[triangles][:, :, 2].min(axis=1) < 0.8])
    assert holed.measures.volume == 0


def test_a_part_that_is_a_speck_beside_the_rest():
    vertices, triangles = of(box((0, 0, 0), (1, 1, 1)))
    speck = np.array([[2.0, 0, 0], [2.0 + 1e-9, 0, 0], [2.0, 1e-9, 0]])
    found = decomposed(np.concatenate([vertices, speck]), np.concatenate([triangles, [[8, 9, 10]]]))
    assert found.measures.volume == pytest.approx(1)
    assert contained(speck, found.pieces).all()


def test_vertices_of_corners_of_their_own_are_one():
    corners = box((0, 0, 0), (1, 1, 1)).triangles.reshape(-1, 3)
    found = decomposed(np.asarray(corners), np.arange(36).reshape(-1, 3))
    assert found.measures.volume == pytest.approx(1)


@pytest.mark.parametrize("seed", range(8))
def test_random_solids(seed):
    vertices, triangles = random_mesh(seed)
    found = decomposed(vertices, triangles)
    mesh = trimesh.Trimesh(vertices, triangles)
    assert uncovered(vertices, triangles, found.pieces) == ()
    assert found.measures.volume == pytest.approx(mesh.volume)
    assert found.measures.added < 0.1
    assert all(len(piece.corners) <= MOST_CORNERS for piece in found.pieces)
    weights = np.random.default_rng(seed).dirichlet((1, 1, 1), size=300)
    chosen = mesh.triangles[np.random.default_rng(seed).integers(len(triangles), size=300)]
    assert contained(np.einsum("ij,ijk->ik", weights, chosen), found.pieces).all()


@pytest.mark.parametrize("seed", range(4))
def test_random_open_meshes(seed):
    vertices, triangles = open_mesh(seed)
    found = decomposed(vertices, triangles)
    assert uncovered(vertices, triangles, found.pieces) == ()
    assert found.measures.added < 0.1


def test_the_number_of_pieces_can_be_bounded():
    mesh = trimesh.creation.torus(0.2, 0.04, major_sections=24, minor_sections=12)
    several = decomposed(*of(mesh))
    few = decomposed(*of(mesh), pieces=3)
    assert len(few.pieces) <= 3 < len(several.pieces)
    assert few.measures.added > 0.1 > several.measures.added
    assert uncovered(*of(mesh), few.pieces) == ()
    (one,) = decomposed(*of(mesh), pieces=1).pieces
    assert contained(np.zeros((1, 3)), [one]).all()


def test_a_finer_detail_adds_less():
    mesh = trimesh.creation.torus(0.2, 0.04, major_sections=24, minor_sections=12)
    fine = decomposed(*of(mesh), detail=0.05)
    assert fine.measures.added <= 0.05
    assert len(fine.pieces) > len(decomposed(*of(mesh), detail=0.3).pieces)


def test_degenerate_triangles_are_held_too():
    vertices, triangles = of(box((0, 0, 0), (1, 1, 1)))
    vertices = np.concatenate([vertices, [[3.0, 0, 0], [4.0, 0, 0]]])
    triangles = np.concatenate([triangles, [[8, 9, 9]]])
    found = decomposed(vertices, triangles)
    assert uncovered(vertices, triangles, found.pieces) == ()
    (alone,) = decomposed(vertices, triangles[-1:]).pieces
    assert contained(np.array([[3.5, 0, 0]]), [alone]).all()


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        ({"detail": 0.0}, "detail"), ({"detail": float("nan")}, "detail"), ({"pieces": 0}, "piece"),
    ],
)  # fmt: skip
def test_what_cannot_be_asked_for(arguments, said):
    with pytest.raises(UsageFault, match=said):
        decomposed(*of(box((0, 0, 0), (1, 1, 1))), **arguments)


def test_no_triangle_is_no_mesh():
    with pytest.raises(UsageFault, match="without triangles"):
        decomposed(np.zeros((3, 3)), np.zeros((0, 3), dtype=np.int64))


def test_files_are_read_back_as_they_are(tmp_path):
    found = decomposed(*of(prism(L_SHAPE, 0.3)))
    paths = written_pieces(found.pieces, tmp_path, "l")
    assert [path.name for path in paths] == ["l_1.obj", "l_2.obj"]
    for path, piece in zip(paths, found.pieces, strict=True):
        mesh = trimesh.load(path)
        assert mesh.is_watertight
        assert sorted(map(tuple, mesh.vertices.tolist())) == sorted(
            map(tuple, piece.points().tolist())
        )
    text = pieces_text(found.pieces, ["a", "b"], ["two"])
    whole = trimesh.load(trimesh.util.wrap_as_stream(text), file_type="obj", split_object=True)
    assert whole.volume == pytest.approx(found.measures.union, rel=0.01)


SCRIPT = """
import sys
from tests.srgc.imports.random_meshes import random_mesh
from srgc.imports.meshes.decomposition import decomposed
from srgc.imports.meshes.piece_files import pieces_text
pieces = decomposed(*random_mesh(5)).pieces
sys.stdout.write(pieces_text(pieces, [str(i) for i in range(len(pieces))], []))
"""


def test_the_same_bytes_whatever_the_hash_seed():
    digests = {
        hashlib.sha256(
            subprocess.run(
                [sys.executable, "-c", SCRIPT],
                cwd=ROOT,
                env={"PYTHONHASHSEED": seed, "PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": threads},
                check=True,
                capture_output=True,
            ).stdout
        ).hexdigest()
        for seed, threads in (("1", "1"), ("2", "2"))
    }
    assert len(digests) == 1


def test_a_housing_with_walls_along_its_cuts() -> None:
    """A machine tool, whose faces lie in many common planes: few pieces, and little is added."""
    mesh = read_mesh(ROOT / "specs" / "imports" / "machine.stl", 0.001)
    found = decomposed(mesh.vertices, mesh.triangles)
    assert found.measures.added <= 0.1
    assert len(found.pieces) <= 15
