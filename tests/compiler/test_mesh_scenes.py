"""Meshes as obstacles: their objects, and the pieces in the workspace that hold these.

Turned frames are those of mpmath, volumes those of SciPy's hulls.
"""

from __future__ import annotations

import random
from collections.abc import Sequence
from fractions import Fraction
from itertools import product

import mpmath
import numpy as np
import pytest
from scipy.spatial import ConvexHull

from compiler.workspaces.closed_frame import rational_frame
from compiler.workspaces.convex_objects import hollow_objects
from compiler.workspaces.map_header import MapFault
from compiler.workspaces.mesh_scene import scene_pieces
from compiler.workspaces.pieces import Pieces
from compiler.workspaces.polytope import Polytope
from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code
from grammar_lang.files.meshes import MeshError
from grammar_lang.files.scenes import scene_of
from tests.oracles.mesh_files import binary_stl, text_stl

F = Fraction
Corner = tuple[float, float, float]
BOX = [(x, y, z) for x, y, z in product((0, 1), repeat=3)]
QUADS = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]


def box(at: Corner = (0, 0, 0), size: Corner = (1, 1, 1)) -> list[list[Corner]]:
    """The twelve triangles of a box."""
    corners = [(at[0] + size[0] * x, at[1] + size[1] * y, at[2] + size[2] * z) for x, y, z in BOX]
    return [[corners[i] for i in part] for a, b, c, d in QUADS for part in ((a, b, c), (a, c, d))]


def obj(*objects: tuple[str, Sequence[Sequence[Corner]]]) -> bytes:
    lines, count = list[str](), 0
    for name, faces in objects:
        lines += [name] if name else []
        for face in faces:
            lines += [f"v {x!r} {y!r} {z!r}" for x, y, z in face]
            lines.append("f " + " ".join(str(count + i + 1) for i in range(len(face))))
            count += len(face)
    return "\n".join(lines).encode()


def labels(data: bytes, name: str = "a.obj") -> list[tuple[str, int]]:
    return [(each.label, len(each.faces)) for each in scene_of(name, data).objects]


def degrees(value: int) -> ir.Expr:
    return ir.Binary("*", ir.Num(F(value, 180)), ir.Pi())


def frame(*steps: ir.Expr) -> ir.Expr:
    found: ir.Expr = ir.World()
    for step in steps:
        found = ir.Compose(found, step)
    return found


def shift(x: Fraction, y: Fraction, z: Fraction) -> ir.Shift:
    return ir.Shift(ir.Vector(ir.Num(x), ir.Num(y), ir.Num(z)))


def pieces(data: bytes, name: str = "a.obj", **changes: object) -> Pieces:
    found = scene_of(name, data)
    values = {"scale": found.scale, "frame": found.frame, "dimension": 3, **changes}
    return scene_pieces(ir.Scene(found.digest, found.objects, **values))  # type: ignore[arg-type]


# --- objects -------------------------------------------------------------------------------------


@pytest.mark.parametrize("write", [binary_stl, text_stl])
def test_stl_falls_into_what_hangs_together(write: object) -> None:
    """Two boxes that share an edge's corner are one object, a third one another."""
    assert callable(write)
    data = write([*box(), *box((1, 1, 1)), *box((5, 0, 0))])
    data = data if isinstance(data, bytes) else data.encode()
    assert labels(data, "a.STL") == [("1", 24), ("2", 12)]


def test_obj_has_the_objects_that_it_names() -> None:
    one, two, three = box(), box((3, 0, 0)), box((6, 0, 0))
    assert labels(obj(("o a", one), ("g part", two), ("o b c", three))) == [
        ("`a`", 24), ("`b c`", 12),
    ]  # fmt: skip
    assert labels(obj(("g a", one), ("g b", two), ("g a", three))) == [("`a`", 24), ("`b`", 12)]
    assert labels(obj(("", one), ("", two), ("o b", three))) == [("1", 12), ("2", 12), ("`b`", 12)]
    assert labels(obj(("", [*one, *two]))) == [("1", 12), ("2", 12)]


def test_faces_name_corners_in_every_form() -> None:
    text = b"""# comment with v 1 2
v 0 0 0 1.0
v 1 0 0
v 1 1 0 # corner
v 0 1 0
vt 0 0
vn 0 0 1
f 1/1/1 2//1 3/1 \\
  4
v 0 0 2
f -1 -5 -4
usemtl red
f 5 1 4
"""
    [found] = scene_of("a.obj", text).objects
    assert [tuple(map(int, corner)) for corner in found.corners] == [
        (0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 2),
    ]  # fmt: skip
    assert found.faces == ((0, 1, 2), (0, 2, 3), (4, 0, 1), (4, 0, 3))


CORNERS = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (f"{CORNERS}f 1 2 4", "the face in line 4 names no vertex"),
        (f"{CORNERS}f 1 2 0", "the face in line 4 names no vertex"),
        (f"{CORNERS}f 1 2 -4", "the face in line 4 names no vertex"),
        (f"{CORNERS}f 1 2 x", "the face in line 4 names no vertex"),
        (f"{CORNERS}f 1 2 {'9' * 5000}", "the face in line 4 names no vertex"),
        (f"{CORNERS}f 1 2", "fewer than three corners"),
        (f"{CORNERS}f 1 2 3\nl 1 2", "line 5 has `l`, which is not a face"),
        (f"{CORNERS}f 1 2 3\np 1", "line 5 has `p`, which is not a face"),
        (f"{CORNERS}f 1 2 \\", "its last line goes on"),
        (CORNERS, "it has no triangle"),
        ("", "it has no triangle"),
        ("v 1 nan 2\nf 1 1 1", "line 1 does not have three numbers"),
        (f"v 0.{'1' * 5000} 1 2\nf 1 1 1", "line 1 does not have three numbers"),
        ("v 1 2 3\0\nf 1 1 1", "neither binary"),
    ],
)
def test_obj_that_is_no_scene(text: str, says: str) -> None:
    with pytest.raises(MeshError, match=says):
        scene_of("a.obj", text.encode())


@pytest.mark.parametrize(
    ("data", "says"),
    [
        (binary_stl(box())[:-1], "neither binary"),
        (b"solid\nendsolid\n", "it has no triangle"),
        (b"facet\nvertex 1 2 3\nendfacet\n", "the facet that ends in line 3 has 1 corners"),
        (text_stl(box()).partition(b"endsolid")[0], "no `endsolid`"),
        (text_stl(box()).rpartition(b"vertex")[0], "its last facet does not end"),
        (bytes(80) + (60_000_000).to_bytes(4, "little"), "neither binary"),
    ],
)
def test_stl_that_is_no_scene(data: bytes | str, says: str) -> None:
    with pytest.raises(MeshError, match=says):
        scene_of("a.stl", data if isinstance(data, bytes) else data.encode())


# --- pieces --------------------------------------------------------------------------------------


def test_a_box_is_itself() -> None:
    """Exact, in millimetres, moved and turned by quarters."""
    place = frame(shift(F(1), F(2), F(3)), ir.Rot("z", degrees(90)), ir.Move("-x", ir.Num(F(1, 2))))
    found = pieces(obj(("", box(size=(100, 200, 300)))), scale=F(1, 1000), frame=place)
    [piece] = found.polytopes
    assert found.inflation == 0
    # (x, y, z) -> (1 - y, 2 - 1/2 + x, 3 + z)
    assert piece.vertices == tuple(
        sorted(product((F(4, 5), F(1)), (F(3, 2), F(8, 5)), (F(3), F(33, 10))))
    )
    assert piece.volume == F(6, 1000)


def exact_image(corner: Sequence[Fraction], steps: Sequence[tuple[str, int]]) -> mpmath.matrix:
    """A corner turned about axes by degrees, the last one first, in mpmath."""
    point = mpmath.matrix([mpmath.mpf(x.numerator) / x.denominator for x in corner])
    for axis, angle in reversed(steps):
        cosine, sine = mpmath.cos(mpmath.radians(angle)), mpmath.sin(mpmath.radians(angle))
        i = "xyz".index(axis)
        j, k = (i + 1) % 3, (i + 2) % 3
        a, b = point[j], point[k]
        point[j], point[k] = cosine * a - sine * b, sine * a + cosine * b
    return point


@pytest.mark.parametrize("seed", range(12))
def test_turned_objects_are_held(seed: int) -> None:
    """Corners by mpmath are within all facets, and within the said distance of one at least."""
    chance = random.Random(seed)
    count = chance.choice((4, 9, 20, 32, 33, 60))
    points = [tuple(round(chance.uniform(-5, 5), 3) for _ in range(3)) for _ in range(count)]
    data = obj(("o a", [points[i : i + 3] for i in range(count - 2)]))  # type: ignore[misc]
    steps = [(chance.choice("xyz"), chance.randint(-170, 170)) for _ in range(3)]
    place = frame(*(ir.Rot(axis, degrees(angle)) for axis, angle in steps))  # type: ignore[arg-type]
    found = pieces(data, frame=place)
    [piece] = found.polytopes
    assert 0 < found.inflation < F(1, 10**9)
    assert piece.has_interior
    assert len(piece.rows) <= (26 if count > 32 else 2 * count)
    assert Polytope(piece.rows).vertices == piece.vertices
    with mpmath.workdps(60):
        images = [exact_image([F(str(x)) for x in point], steps) for point in points]
        for row in piece.rows:
            a, b, c = (mpmath.mpf(int(x)) for x in row.normal)
            heights = [a * p[0] + b * p[1] + c * p[2] for p in images]
            offset = mpmath.mpf(row.offset.numerator) / row.offset.denominator
            length = mpmath.sqrt(a * a + b * b + c * c)
            assert max(heights) <= offset
            assert (offset - max(heights)) / length <= float(found.inflation)


def test_many_corners_are_enclosed_by_the_planes_of_bodies() -> None:
    """In the 26 directions the piece of a ball is as large as the ball, and not larger."""
    chance = np.random.default_rng(1)
    points = chance.normal(size=(200, 3))
    points = (points / np.linalg.norm(points, axis=1)[:, None]).round(4)
    hull = ConvexHull(points)
    data = obj(("", points[hull.simplices].tolist()))
    found = pieces(data)
    [piece] = found.polytopes
    assert "1 of more than 32 corners by 26 planes" in found.origin
    corners = np.array(piece.vertices, float)
    for normal in product((-1, 0, 1), repeat=3):
        assert abs((corners @ normal).max() - (points @ normal).max()) < 1e-12
    assert hull.volume < float(piece.volume) < 1.3 * hull.volume


def test_in_the_plane_an_object_is_its_shadow() -> None:
    wedge = [[(0, 0, 0), (2, 0, 0), (0, 1, 0)], [(0, 0, 0), (2, 0, 0), (0, 0, 5)],
             [(0, 0, 0), (0, 1, 0), (0, 0, 5)], [(2, 0, 0), (0, 1, 0), (0, 0, 5)]]  # fmt: skip
    found = pieces(
        obj(("", wedge)),
        dimension=2,
        frame=frame(shift(F(1), F(0), F(0)), ir.Rot("-z", degrees(90))),
    )
    [piece] = found.polytopes
    assert set(piece.vertices) == {(1, 0), (1, -2), (2, 0)}


@pytest.mark.parametrize(
    ("faces", "size", "says"),
    [
        ([[(0, 0, 0), (1, 0, 0), (0, 1, 0)]], 3, "`Plate` of this mesh has no interior"),
        ([[(0, 0, 0), (1, 1, 1), (2, 2, 2)]], 3, "lie in one plane"),
        ([[(0, 0, 0), (1, 0, 0), (0.5, 0, 3)]], 2, "lie in one line, seen along z"),
    ],
)
def test_flat_objects_are_refused(faces: list[list[Corner]], size: int, says: str) -> None:
    data = obj(("o Rest", box()), ("o Plate", faces))
    with pytest.raises(MapFault, match=says) as fault:
        pieces(data, dimension=size)
    assert fault.value.code is Code.FLAT_POLYTOPE


def test_a_frame_too_far_away_to_be_rounded_is_refused() -> None:
    far = ir.Binary("*", ir.Num(F(10) ** 100), ir.Unary("sqrt", ir.Num(F(2))))
    with pytest.raises(MapFault, match="too far away"):
        pieces(obj(("", box())), frame=frame(ir.Rot("x", ir.Num(F(10) ** 200)), ir.Move("x", far)))


# --- hollows -------------------------------------------------------------------------------------


def turned(faces: Sequence[Sequence[Corner]], seed: int) -> list[list[Corner]]:
    """Triangles turned at random and rounded to single precision, as STL has them."""
    chance = np.random.default_rng(seed)
    turn, _ = np.linalg.qr(chance.normal(size=(3, 3)))
    return np.array(faces, dtype=float).dot(turn.T).astype(np.float32).astype(float).tolist()


def hollow(data: bytes) -> int:
    return hollow_objects(scene_of("a.obj", data))


L_SHAPE = [*box(size=(2, 1, 1)), *box(size=(1, 2, 1))]
OPEN = box()[2:]
THROUGH = [face for face in box() if len({z for _, _, z in face}) > 1]


@pytest.mark.parametrize("seed", range(5))
def test_objects_that_are_not_convex_are_counted(seed: int) -> None:
    """Two boxes that cross, a box without a side, a tube; boxes, plates and balls are convex."""
    for faces in (L_SHAPE, OPEN, THROUGH):
        assert hollow(obj(("o a", turned(faces, seed)), ("o b", box()))) == 1
    points = np.random.default_rng(seed).normal(size=(300, 3))
    ball = points[ConvexHull(points).simplices].tolist()
    flipped = [face[::-1] if i % 3 else face for i, face in enumerate(box(size=(9, 5, 0.01)))]
    for faces in (box(), flipped, ball):
        assert hollow(obj(("o a", turned(faces, seed)))) == 0


@pytest.mark.parametrize("angle", [60, 37])
def test_turns_that_cancel_are_no_turn(angle: int) -> None:
    """The errors of such a frame are balls about 0, whose squares are not known to be positive."""
    steps = [ir.Rot("z", degrees(angle)), ir.Rot("z", degrees(-angle))]
    found = rational_frame(frame(*steps))
    point = (F(3), F(-2), F(7))
    error = found.turned * 8 + found.moved
    assert error < F(1, 10**9)
    assert all(abs(a - b) <= error for a, b in zip(found.apply(point), point, strict=True))
