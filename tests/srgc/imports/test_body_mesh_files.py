"""Each mesh that an import of a robot writes has a file of its own, and pieces hold their mesh."""

from __future__ import annotations

import re
from fractions import Fraction
from itertools import product

import numpy as np
import pytest
import trimesh

from srgc.imports.urdf.urdf_import import urdf_import

ROBOT = """<robot name="pair"><link name="base">
<visual><geometry><mesh filename="seen/part.obj"/></geometry></visual>
<collision><geometry><mesh filename="met/part.obj"/></geometry></collision>
</link></robot>"""
TURN = ((0.8, -0.48, 0.36), (0.6, 0.64, -0.48), (0.0, 0.6, 0.8))
SIDES = ((0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3))


def turned_boxes(places):
    """The text of an OBJ file of turned boxes 0.1 x 0.2 x 0.3 m at places along x."""
    lines = []
    for number, place in enumerate(places):
        for x, y, z in product((0, 0.1), (0, 0.2), (0, 0.3)):
            corner = [a * (x + place) + b * y + c * z for a, b, c in TURN]
            lines.append("v " + " ".join(map(repr, corner)))
        lines += ["f " + " ".join(str(8 * number + i + 1) for i in side) for side in SIDES]
    return "\n".join(lines) + "\n"


def rows(text, kind):
    return [line.split()[1:] for line in text.splitlines() if line.startswith(f"{kind} ")]


def outside(text, point):
    """Whether a point is beyond a side of the convex piece of an OBJ file, in rationals."""
    corners = [[Fraction(x) for x in row] for row in rows(text, "v")]
    for a, b, c in ([corners[int(i) - 1] for i in row] for row in rows(text, "f")):
        (ux, uy, uz), (vx, vy, vz) = ([p - q for p, q in zip(e, a, strict=True)] for e in (b, c))
        normal = uy * vz - uz * vy, uz * vx - ux * vz, ux * vy - uy * vx
        if sum(n * (p - q) for n, p, q in zip(normal, point, a, strict=True)) > 0:
            return True
    return False


def test_pictures_do_not_replace_pieces(tmp_path):
    met, seen = turned_boxes([0.0, 2.0, 5.0]), turned_boxes([0.0])
    for folder, text in (("met", met), ("seen", seen)):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "part.obj").write_text(text)
    (tmp_path / "pair.urdf").write_text(ROBOT)
    found = urdf_import(tmp_path / "pair.urdf")
    hulls = re.findall(r'hull\(frame: \w+, file: "([^"]+)"', found.text)
    (picture,) = re.findall(r'visual\(frame: \w+, file: "([^"]+)"', found.text)
    assert len({*hulls, picture}) == len(found.files) == 4
    assert found.files[picture] == seen.encode()
    pieces = [found.files[each].decode() for each in hulls]
    for row in rows(met, "v"):
        point = [Fraction(float(x)) for x in row]
        assert not all(outside(piece, point) for piece in pieces)


def test_what_of_a_mesh_is_not_taken_is_told(tmp_path):
    (tmp_path / "met").mkdir()
    (tmp_path / "seen").mkdir()
    box = turned_boxes([0.0])
    (tmp_path / "met" / "part.obj").write_text(f"{box}f 1 2\n")
    (tmp_path / "seen" / "part.obj").write_text(box)
    (tmp_path / "pair.urdf").write_text(ROBOT)
    remarks = urdf_import(tmp_path / "pair.urdf").remarks
    assert any("1 faces of one or two corners: left out" in each for each in remarks)


BOX = np.array([0.1, 0.2, 0.3])
ROUNDED = 2e-4
"""Metres: a piece holds its mesh, with room for decimals."""


def boxed(folder, suffix, up="Y_UP"):
    """A URDF of a link that collides as a box, whose file says that another axis is up."""
    box = trimesh.creation.box(BOX).apply_translation((0.5, 0.7, 0.9))
    data = box.export(file_type=suffix)
    if suffix == "dae":
        data = data.replace(b"Y_UP", up.encode())
        assert b"<up_axis>" + up.encode() in data
    (folder / f"part.{suffix}").write_bytes(data)
    text = '<robot name="one"><link name="base"><collision><geometry><mesh filename="{}"/>'
    (folder / "one.urdf").write_text(
        text.format(f"part.{suffix}") + "</geometry></collision></link></robot>"
    )
    return folder / "one.urdf"


def corners_of(found):
    (piece,) = found.files.values()
    return np.array(rows(piece.decode(), "v"), dtype=float)


@pytest.mark.parametrize("case", ["dae Y_UP", "dae X_UP", "dae Z_UP", "glb"])
def test_meshes_of_bodies_keep_their_axes(case, tmp_path):
    """As in RViz, MoveIt, Pinocchio and Gazebo, whatever the format says is up."""
    suffix, _, up = case.partition(" ")
    found = urdf_import(boxed(tmp_path, suffix, up))
    corners = corners_of(found)
    assert np.ptp(corners, axis=0) == pytest.approx(BOX, abs=3 * ROUNDED)
    assert corners.mean(axis=0) == pytest.approx([0.5, 0.7, 0.9], abs=ROUNDED)
    told = [each for each in found.remarks if f"`up_axis` {up} turns nothing" in each]
    assert len(told) == (case in ("dae Y_UP", "dae X_UP"))


@pytest.mark.slow
@pytest.mark.parametrize("case", ["dae Y_UP", "dae X_UP", "dae Z_UP", "glb"])
def test_axes_are_those_of_the_meshes_of_pinocchio(case, tmp_path):
    import coal

    suffix, _, up = case.partition(" ")
    corners = corners_of(urdf_import(boxed(tmp_path, suffix, up)))
    loaded = coal.MeshLoader().load(str(tmp_path / f"part.{suffix}"), np.ones(3))
    known = np.array([loaded.vertex(number) for number in range(loaded.num_vertices)])
    assert corners.min(axis=0) == pytest.approx(known.min(axis=0), abs=ROUNDED)
    assert corners.max(axis=0) == pytest.approx(known.max(axis=0), abs=ROUNDED)
