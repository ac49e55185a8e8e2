"""Obstacles of meshes are the round numbers of their files, and hold what the files say, exactly.

What a file says is read here by fractions of its text, or of its single-precision numbers.
"""

from __future__ import annotations

import struct
from fractions import Fraction
from itertools import product

import numpy as np
import pytest

from srgc.imports.meshes.containment import uncovered
from srgc.imports.meshes.convex_piece import convex_piece
from srgc.imports.meshes.exact_places import ExactPlaces, exact_decimal
from srgc.imports.meshes.mesh_file import read_mesh
from srgc.imports.scenes.scene_import import scene_import
from tests.srgc.imports.test_mesh_files import DAE
from tests.srgc.imports.test_scenes import named, obj, regions, scene_file, sides, world

FACES = (
    (0, 1, 3), (0, 3, 2), (4, 6, 7), (4, 7, 5), (0, 4, 5), (0, 5, 1),
    (2, 3, 7), (2, 7, 6), (0, 2, 6), (0, 6, 4), (1, 5, 7), (1, 7, 3),
)  # fmt: skip


def box_obj(xs, ys, zs):
    """An OBJ file of a box between decimals that are texts."""
    lines = [f"v {x} {y} {z}" for x, y, z in product(xs, ys, zs)]
    lines += [f"f {a + 1} {b + 1} {c + 1}" for a, b, c in FACES]
    return "\n".join(lines) + "\n"


def only(tmp_path, imported):
    ((_, region),) = named(regions(tmp_path, imported)).items()
    return sides(region)


def spans(*texts):
    return [tuple(map(Fraction, text.split())) for text in texts]


@pytest.mark.parametrize(
    ("box", "options", "due"),
    [
        ((("0", "100"), ("0", "300"), ("0", "700")), {"unit": "mm"}, ("0 .1", "0 .3", "0 .7")),
        ((("0", "0.1"), ("0", "0.1"), ("0", "0.1")), {"at": "(0.1, 0.2, 0.3) m"},
         (".1 .2", ".2 .3", ".3 .4")),
        ((("-1.1", "2.3"), ("0.123456", "0.2"), ("7e-1", "1")), {"at": "(1, 2, 3) mm"},
         ("-1.099 2.301", ".125456 .202", ".703 1.003")),
        ((("0", "3"), ("0", "1"), ("0", "1")), {"unit": "in"}, ("0 .0762", "0 .0254", "0 .0254")),
    ],
)  # fmt: skip
def test_boxes_of_decimals_stay_as_they_are(tmp_path, box, options, due):
    (tmp_path / "box.obj").write_text(box_obj(*box))
    assert only(tmp_path, scene_import(tmp_path / "box.obj", **options)) == spans(*due)


def test_what_is_a_little_more_than_a_round_number_is_held(tmp_path):
    """In doubles the text is 0.1, so no double tells that it is more."""
    wide = "0.10000000000000000001"
    (tmp_path / "box.obj").write_text(box_obj(("0", wide), ("0", "0.1"), ("0", "0.1")))
    assert float(wide) == 0.1
    (low, high), *others = only(tmp_path, scene_import(tmp_path / "box.obj"))
    assert low <= 0 < Fraction(wide) <= high <= Fraction("0.1001")
    assert all(a <= 0 and Fraction("0.1") <= b <= Fraction("0.1001") for a, b in others)


@pytest.mark.parametrize("unit", ["mm", "m"])
def test_single_precision_is_held_as_it_is(tmp_path, unit):
    size = 100 if unit == "mm" else 0.1
    corners = np.array([*product((0, size), repeat=3)], dtype="<f4")[np.array(FACES)]
    rows = [struct.pack("<12fH", 0, 0, 0, *row.ravel().tolist(), 0) for row in corners]
    data = bytes(80) + struct.pack("<I", len(rows)) + b"".join(rows)
    (tmp_path / "box.stl").write_bytes(data)
    found = only(tmp_path, scene_import(tmp_path / "box.stl", unit=unit))
    true = Fraction(float(np.float32(size))) / (1000 if unit == "mm" else 1)
    for low, high in found:
        assert low <= 0 < true <= high <= Fraction("0.1001")
        assert high == true or unit == "m"


def ascii_stl(text):
    rows = [line.split()[1:] for line in text.splitlines() if line.startswith("v ")]
    facets = [
        "facet normal 0 0 0\nouter loop\n"
        + "".join(f"vertex {' '.join(rows[i])}\n" for i in face)
        + "endloop\nendfacet\n"
        for face in FACES
    ]
    return f"solid box\n{''.join(facets)}endsolid box\n"


def test_ascii_stl(tmp_path):
    (tmp_path / "box.stl").write_text(ascii_stl(box_obj(("0.1", "0.3"), ("0", "0.7"), ("0", "1"))))
    found = only(tmp_path, scene_import(tmp_path / "box.stl", at="0.1, 0.2, 0.3"))
    assert found == spans(".2 .4", ".2 .9", ".3 1.3")


def test_collada_is_read_in_doubles(tmp_path):
    """The library that reads it has single precision, in which 0.1 is more than 1/10."""
    values = {"doctype": "", "unit": "0.001", "up": "Z_UP", "image": "x.png", "shift": "0 0 0"}
    text = DAE.format(**values).replace("0 0 0 1 0 0 0 0 2", "0 0 0 0.1 0 0 0 0.123456789 2")
    (tmp_path / "plate.dae").write_text(text)
    mesh = read_mesh(tmp_path / "plate.dae")
    places = mesh.exact()
    assert places.of(1) == (Fraction("0.0001"), 0, 0)
    assert places.of(2) == (0, Fraction("0.000123456789"), Fraction("0.002"))


def test_meshes_of_sdf_are_scaled_and_placed_in_decimals(tmp_path):
    (tmp_path / "box.obj").write_text(box_obj(("0", "100"), ("0", "200"), ("0", "300")))
    mesh = "<mesh><uri>box.obj</uri><scale>0.001 0.001 -0.001</scale></mesh>"
    pose = "0.1 0.2 0.3 0 0 1.5707963267948966"
    model = (
        f"<model name='m'><static>1</static><pose>{pose}</pose><link name='l'><collision name='c'>"
        f"<geometry>{mesh}</geometry></collision></link></model>"
    )
    # A quarter turn about z: x is along y, and y along -x.
    found = only(tmp_path, scene_import(world(tmp_path, model), at="(0, 0, 0.1) m"))
    assert found == spans("-.1 .1", ".2 .3", ".1 .4")


def test_meshes_of_moveit_are_placed_in_decimals(tmp_path):
    text = box_obj(("0", "0.1"), ("0", "0.2"), ("0", "0.3"))
    rows = [line[2:] for line in text.splitlines() if line.startswith("v ")]
    lines = [f"mesh\n8 {len(FACES)}", *rows, *(" ".join(map(str, face)) for face in FACES)]
    own = "0.1 0.2 0.3\n0 0 0 1\n"
    path = scene_file(tmp_path, obj("b", "\n".join(lines), own=own))
    assert only(tmp_path, scene_import(path)) == spans(".1 .2", ".2 .4", ".3 .6")


def test_the_check_believes_rationals_and_no_doubles():
    """A triangle whose corner is beyond a plane by less than doubles tell, and one on it."""
    piece = convex_piece([*product((0, 1), repeat=3)], 1)
    read = np.array([[0.0, 0, 0], [0.1, 0, 0], [0, 0.1, 0]])
    triangles = np.array([[0, 1, 2]])
    assert uncovered(read, triangles, [piece], ExactPlaces(read)) == ()
    assert len(uncovered(read, triangles, [piece])) == 1  # 0.1 in doubles is more than 1/10
    beyond = ExactPlaces(read, longer={(1, 0): exact_decimal("0.1000000000000000000001")})
    (found,) = uncovered(read, triangles, [piece], beyond)
    assert any(x > Fraction(1, 10) for polygon in found.polygons for x, _, _ in polygon)


def test_places_are_near_their_doubles():
    rng = np.random.default_rng(30)
    places = ExactPlaces(rng.normal(size=(50, 3)) * 10.0 ** rng.integers(-9, 5, (50, 1)))
    turn = np.array([[0.0, -1, 0], [0, 0, 1], [-1, 0, 0]])
    moved = places.scaled([Fraction(1, 1000), Fraction(-3, 7), Fraction(2)]).placed(
        turn, [Fraction("1000.1"), Fraction("-0.3"), Fraction(0)]
    )
    vertices, slack = moved.vertices(), Fraction(moved.slack())
    for number, row in enumerate(vertices.tolist()):
        x, y, z = (Fraction(repr(float(value))) for value in places.read[number])
        due = (Fraction("1000.1") + Fraction(3, 7) * y, 2 * z - Fraction("0.3"), -x / 1000)
        assert moved.of(number) == due
        assert all(abs(Fraction(a) - b) <= slack for a, b in zip(row, due, strict=True))
