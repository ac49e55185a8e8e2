"""Each mesh that an import of a robot writes has a file of its own, and pieces hold their mesh."""

from __future__ import annotations

import re
from fractions import Fraction
from itertools import product

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
