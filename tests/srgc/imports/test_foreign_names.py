"""Names of other alphabets, very long ones, and ones that differ in what names cannot hold."""

from __future__ import annotations

import re

import pytest

import srgc
from srgc.faults import UsageFault
from srgc.imports.names import Names
from srgc.imports.scenes.scene_import import scene_import
from srgc.imports.urdf.urdf_import import urdf_import
from tests.oracles.urdf_files import LIMIT, joint, link, robot
from tests.srgc.imports.test_scenes import obj, scene_file

BOX = '<collision><geometry><box size="0.1 0.1 0.1"/></geometry></collision>'
UP = '<origin xyz="0 0 0.1"/>'
LONG = "very_long_name_" * 20
NAMES = re.compile(r"^(?:module|grammar) (\w+)|^  (?:port|frame|dof) (\w+)", re.MULTILINE)


@pytest.mark.parametrize(
    ("wanted", "due"),
    [
        ("база", "baza"), ("Рычаг_2", "Rychag_2"), ("щётка", "shchetka"),
        ("βραχίονας", "vrachionas"),
        ("über-arm", "uber_arm"), ("Straße", "Strasse"), ("関節1", "joint_1"), ("関節", "joint"),
        ("関節_elbow", "elbow"), ("2nd part", "_2nd_part"), ("12", "_12"), ("", "_"), ("/", "_"),
        ("world", "_world"), ("_a__b_", "a__b"),
    ],
)  # fmt: skip
def test_names_are_legible(wanted, due):
    assert Names().name(wanted, "joint") == due


def test_names_are_distinct_and_short():
    names = Names(ignore_case=True)
    found = [
        names.name(text) for text in ("Arm", "arm", "a rm", "a/rm", "関節", "部屋", LONG, LONG)
    ]
    assert found[:6] == ["Arm", "arm_2", "a_rm", "a_rm_2", "part", "part_2"]
    assert len({name.lower() for name in found}) == len(found)
    assert max(map(len, found)) < 70


@pytest.mark.parametrize("module", [False, True])
def test_links_of_other_alphabets(tmp_path, module):
    text = robot(
        link("база"), link("関節1"), link("關節1"), link(LONG),
        joint("revolute", LIMIT, name="поворот", parent="база", child="関節1"),
        joint("fixed", UP, name="固定", parent="関節1", child="關節1"),
        joint("revolute", UP + LIMIT, name="回転", parent="關節1", child=LONG),
        name="робот",
    )  # fmt: skip
    path = tmp_path / "r.urdf"
    path.write_text(text, encoding="utf-8")
    found = urdf_import(path, module=module)
    names = [one or other for one, other in NAMES.findall(found.text)]
    assert all(len(re.findall("[a-z]", name.lower())) >= 1 for name in names)
    assert max(map(len, names)) < 150
    comments = re.sub(r"\n *// ", " ", found.text).replace(" ", "")
    for each in ("база", "関節1", "關節1", LONG, "поворот", "回転"):
        assert each in comments
    assert [d for d in srgc.check(text=found.text) if d.severity.value == "error"] == []
    assert "Robot" in found.text


def test_a_port_is_no_name_of_another_alphabet(tmp_path):
    path = tmp_path / "r.urdf"
    path.write_text(robot(link("a"), link("b"), joint("revolute", LIMIT)))
    with pytest.raises(UsageFault, match="NAME=LINK:TYPE"):
        urdf_import(path, module=True, ports=["выход=b:Flange"])


def test_obstacles_of_other_alphabets(tmp_path):
    names = ("стол", "部屋", "部品", "box 1", "Box-1", LONG)
    path = scene_file(tmp_path, *(obj(name, "box\n1 1 1") for name in names), name="部屋")
    found = scene_import(path)
    written = re.findall(r"^  obstacle (\w+) ", found.text, re.MULTILINE)
    assert written[:5] == ["stol", "obstacle", "obstacle_2", "box_1", "Box_1_2"]
    assert "workspace Scene {" in found.text
    comments = re.sub(r"\n *// ", " ", found.text).replace(" ", "")
    for each in ("стол", "部屋", "部品", "Box-1", LONG):
        assert each.replace(" ", "") in comments
    assert "`box 1`" not in found.text
    assert [d for d in srgc.check(text=found.text) if d.severity.value == "error"] == []


def tetrahedron(first):
    corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\n"
    faces = ((1, 3, 2), (1, 2, 4), (1, 4, 3), (2, 3, 4))
    return corners + "".join(f"f {' '.join(str(i + first) for i in face)}\n" for face in faces)


def test_objects_that_differ_in_case_have_files_of_their_own(tmp_path):
    """Each is two tetrahedra, which one piece would not hold."""
    lines = []
    for number, name in enumerate(("Cup", "cup", "CUP")):
        other = tetrahedron(8 * number + 4).replace("v ", "v 3")
        lines += [f"o {name}", tetrahedron(8 * number), other]
    (tmp_path / "cups.obj").write_text("\n".join(lines))
    files = [*scene_import(tmp_path / "cups.obj").files]
    assert len({name.lower() for name in files}) == len(files) == 3


def test_files_of_meshes_that_differ_in_case(tmp_path):
    for name in ("Part.obj", "part.obj"):
        (tmp_path / name).write_text(tetrahedron(0).replace("v 1 0 0", f"v {len(name)} 0 0"))
    (tmp_path / "PART.OBJ").write_text(tetrahedron(0))
    shapes = "".join(
        f'<{kind}><geometry><mesh filename="{name}"/></geometry></{kind}>'
        for kind in ("visual", "collision")
        for name in ("Part.obj", "part.obj", "PART.OBJ")
    )
    (tmp_path / "r.urdf").write_text(f'<robot name="r"><link name="a">{shapes}</link></robot>')
    files = [*urdf_import(tmp_path / "r.urdf").files]
    assert len({name.lower() for name in files}) == len(files) == 6
