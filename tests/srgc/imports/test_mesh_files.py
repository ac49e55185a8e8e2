"""Meshes of files: against trimesh, and files that mean harm or were cut off."""

from __future__ import annotations

import gzip
import re
import struct
import zipfile
from fractions import Fraction

import numpy as np
import pytest
import trimesh

from grammar_lang.files import meshes as language
from srgc.faults import UsageFault
from srgc.imports.meshes import mesh_file, mesh_limits
from srgc.imports.meshes.mesh_file import read_mesh

ANNULUS = trimesh.creation.annulus(r_min=1, r_max=2, height=1, sections=12)


def written(tmp_path, suffix, mesh=ANNULUS, **options):
    path = tmp_path / f"part{suffix}"
    content = mesh.export(file_type=suffix[1:].removesuffix("_ascii"), **options)
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


def same_surface(mesh, other):
    a = np.sort(mesh.vertices[mesh.triangles].reshape(-1, 9), axis=0)
    b = np.sort(np.asarray(other.triangles).reshape(-1, 9), axis=0)
    return a.shape == b.shape and np.allclose(a, b, atol=1e-6)


@pytest.mark.parametrize("suffix", [".stl", ".obj", ".dae"])
def test_triangles_are_those_of_trimesh(tmp_path, suffix):
    path = written(tmp_path, suffix)
    mesh = read_mesh(path)
    if suffix == ".dae":  # trimesh writes y up, which its reader does not turn
        turned = ANNULUS.copy()
        turned.apply_transform(trimesh.transformations.rotation_matrix(np.pi / 2, (1, 0, 0)))
        assert same_surface(mesh, turned)
    else:
        assert same_surface(mesh, ANNULUS)
    assert mesh.notes == ()


def test_stl_as_text(tmp_path):
    path = tmp_path / "part.stl"
    path.write_text(ANNULUS.export(file_type="stl_ascii"))
    assert same_surface(read_mesh(path), ANNULUS)


def test_the_unit_scales(tmp_path):
    path = written(tmp_path, ".stl")
    assert np.ptp(read_mesh(path, 1e-3).vertices, axis=0) == pytest.approx([0.004, 0.004, 0.001])


def test_vertices_are_those_that_the_language_reads(tmp_path):
    path = written(tmp_path, ".stl")
    found = {tuple(map(Fraction, row)) for row in read_mesh(path).vertices.tolist()}
    assert found == set(language._stl(path.read_bytes()))


OBJ = """\
mtllib ../../secret.mtl
o Rack
v 0 0 0
v 1 0 0
v 1 1 0
v 0 1 0
v 0 0 1
usemtl gold
f 1 2 3 4
g lid
f 1 2 -1
o Cone
f 3/1/1 4/1/1 5/1/1
l 1 2
f 1 2
"""


def test_objects_of_obj_in_their_order(tmp_path, monkeypatch):
    path = tmp_path / "two.obj"
    path.write_text(OBJ)
    (tmp_path.parent / "secret.mtl").write_text("newmtl gold\n")
    opened = []
    real = mesh_file.source_bytes
    monkeypatch.setattr(mesh_file, "source_bytes", lambda p, *a: opened.append(p) or real(p, *a))
    mesh = read_mesh(path)
    assert len(mesh.triangles) == 4
    assert opened == [path]
    assert [part.name for part in mesh.objects] == ["Rack", "Cone"]
    assert [part.stop - part.start for part in mesh.objects] == [3, 1]
    assert mesh.triangles.tolist() == [[0, 1, 2], [0, 2, 3], [0, 1, 4], [2, 3, 4]]
    assert "1 faces of one or two corners" in mesh.notes[0]
    assert mesh.notes[1] == "two.obj: 1 `l`: only faces (`f`) are read"
    cone = mesh.part(mesh.objects[-1])
    assert sorted(map(tuple, cone.vertices.tolist())) == [(0, 0, 1), (0, 1, 0), (1, 1, 0)]


DAE = """\
<?xml version="1.0"?>{doctype}
<COLLADA xmlns="http://www.collada.org/2005/11/COLLADASchema" version="1.4.1">
<asset><unit meter="{unit}"/><up_axis>{up}</up_axis></asset>
<library_images><image id="i"><init_from>{image}</init_from></image></library_images>
<library_effects><effect id="e"><profile_COMMON><newparam sid="s"><surface type="2D">
<init_from>i</init_from></surface></newparam><technique sid="t"><lambert/></technique>
</profile_COMMON></effect></library_effects>
<library_materials><material id="m"><instance_effect url="#e"/></material></library_materials>
<library_geometries><geometry id="g" name="plate"><mesh>
<source id="p"><float_array id="a" count="9">0 0 0 1 0 0 0 0 2</float_array>
<technique_common><accessor source="#a" count="3" stride="3"><param name="X" type="float"/>
<param name="Y" type="float"/><param name="Z" type="float"/></accessor></technique_common></source>
<vertices id="v"><input semantic="POSITION" source="#p"/></vertices>
<triangles count="1" material="m"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1 2</p>
</triangles></mesh></geometry></library_geometries>
<library_visual_scenes><visual_scene id="s"><node><translate>{shift}</translate>
<instance_geometry url="#g"><bind_material><technique_common><instance_material symbol="m"
target="#m"/></technique_common></bind_material></instance_geometry></node></visual_scene>
</library_visual_scenes><scene><instance_visual_scene url="#s"/></scene></COLLADA>
"""


def dae(tmp_path, **changed):
    values = {"doctype": "", "unit": "0.01", "up": "Y_UP", "image": "x.png", "shift": "0 0 10"}
    path = tmp_path / "plate.dae"
    path.write_text(DAE.format(**(values | changed)))
    return path


@pytest.mark.parametrize(
    ("up", "corners"),
    [
        ("Z_UP", [(0, 0, 0.1), (0.01, 0, 0.1), (0, 0, 0.12)]),
        ("Y_UP", [(0, -0.1, 0), (0.01, -0.1, 0), (0, -0.12, 0)]),
        ("X_UP", [(0, -0.1, 0), (0, -0.1, 0.01), (0, -0.12, 0)]),
    ],
)
def test_collada_has_a_unit_and_an_axis_that_is_up(tmp_path, up, corners):
    mesh = read_mesh(dae(tmp_path, up=up))
    assert np.allclose(mesh.vertices[mesh.triangles[0]], corners)
    assert mesh.objects[0].name == "plate"
    other = read_mesh(dae(tmp_path, up=up), 1.0)
    assert np.allclose(other.vertices, 100 * mesh.vertices)


TETRAHEDRON = """v 0 0 0
v 1 0 0
v 0 1 0
v 0 0 1
f 1 3 2 # the floor
f 1 2 4
f 1 4 3
f 2 3 4
"""


def test_comments_of_obj_take_no_other_line_away(tmp_path):
    path = tmp_path / "part.obj"
    path.write_text("# C:\\parts\\\n" + TETRAHEDRON + "# C:\\end\\\n")
    mesh = read_mesh(path)
    plain = tmp_path / "plain.obj"
    plain.write_text(re.sub("#.*", "", TETRAHEDRON))
    loaded = trimesh.load(plain, force="mesh", process=False)
    assert len(mesh.triangles) == 4
    assert same_surface(mesh, loaded)


def test_statements_of_obj_that_are_not_read_are_counted(tmp_path):
    others = "surf 0 1 0 1 1 2 3\np 1\nl 1 2\nl 2 3\ncurv 0 1 1 2\ncurv2 1 2\nF 1 2 3\n"
    read = "vn 0 0 1\nvt 0 0\nusemtl a\nmtllib b\ns off\ng c\ng\ncstype bezier\n"
    (tmp_path / "part.obj").write_text(TETRAHEDRON + others + read)
    (note,) = read_mesh(tmp_path / "part.obj").notes
    assert note == (
        "part.obj: 1 `surf`, 1 `p`, 2 `l`, 1 `curv`, 1 `curv2`, 1 `F`: only faces (`f`) are read"
    )


@pytest.mark.parametrize("tag", ["lines", "linestrips"])
def test_lines_of_collada_are_left_out_with_a_note(tmp_path, tag):
    path = dae(tmp_path)
    lines = f'<{tag} count="1"><input semantic="VERTEX" source="#v" offset="0"/><p>0 1</p></{tag}>'
    path.write_text(path.read_text().replace("</mesh>", f"{lines}</mesh>"))
    mesh = read_mesh(path)
    assert len(mesh.triangles) == 1
    assert mesh.notes == ("plate.dae: 1 sets of lines: left out",)


def test_images_of_collada_are_not_opened(tmp_path):
    read_mesh(dae(tmp_path, image="/dev/full"))
    read_mesh(dae(tmp_path, image="../../../etc/passwd"))


LAUGHS = '<!DOCTYPE a [<!ENTITY b "ha"><!ENTITY c "&b;&b;&b;&b;&b;&b;&b;&b;">]>'
OUTSIDE = '<!DOCTYPE a [<!ENTITY b SYSTEM "file:///etc/passwd">]>'


@pytest.mark.parametrize("doctype", [LAUGHS, OUTSIDE])
def test_entities_are_refused(tmp_path, doctype):
    entity = "&c;" if doctype == LAUGHS else "&b;"
    with pytest.raises(UsageFault, match="never expanded"):
        read_mesh(dae(tmp_path, doctype=doctype, image=entity))


def bad(tmp_path, name, content):
    path = tmp_path / name
    path.write_bytes(content if isinstance(content, bytes) else content.encode())
    return path


BINARY = ANNULUS.export(file_type="stl")
TEXT = ANNULUS.export(file_type="stl_ascii")
NAN = BINARY[:96] + struct.pack("<f", float("nan")) + BINARY[100:]
FAR = BINARY[:96] + struct.pack("<f", 1e30) + BINARY[100:]


@pytest.mark.parametrize(
    ("name", "content", "said"),
    [
        ("a.stl", b"", "empty"),
        ("a.stl", BINARY[:-7], "cut off"),
        ("a.stl", BINARY + b"more", "its size is wrong"),
        ("a.stl", NAN, "not a finite number"),
        ("a.stl", FAR, "m away"),
        ("a.stl", BINARY[:80] + struct.pack("<I", 2**31) + BINARY[84:], "its size"),
        ("a.stl", b"\0" * 80 + struct.pack("<I", 0), "empty"),
        ("a.stl", TEXT[: len(TEXT) // 2], "cut off"),
        ("a.stl", TEXT.replace("vertex", "vrtex", 1), "corners of"),
        ("a.stl", "hello", "not an STL file"),
        ("a.stl", gzip.compress(BINARY), "packed with gzip"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n", "no triangle"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 1 2 x\n", "a.obj:5:1: "),
        ("a.obj", "v 0 0 0\nf 1 1 -7\n", "a.obj:2:1: "),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1\nf 1 2 3\n", "a.obj:3:1: "),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9\n", "a.obj"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 9999999999999999999999999\n", "not there"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 nan 0\nf 1 2 3\n", "finite"),
        ("a.obj", "v 0 0 0\nv 1 0 0\nv 0 inf 0\nf 1 2 3\n", "finite"),
        ("a.obj", b"v 0 0 0\0\nf 1 1 1", "not text"),
        ("a.dae", "<COLLADA>", "not XML"),
        ("a.dae", "<other/>", "not a COLLADA"),
        ("a.dae", "<COLLADA xmlns='http://www.collada.org/2005/11/COLLADASchema'/>", "scene"),
        ("a.ply", "ply", "known: STL"),
        ("a.3mf", "PK", "known: STL"),
        ("a.zae", "PK", "known: STL"),
    ],
)  # fmt: skip
def test_a_message_each(tmp_path, name, content, said):
    with pytest.raises(UsageFault, match=said) as caught:
        read_mesh(bad(tmp_path, name, content))
    assert len(str(caught.value).splitlines()) <= 4


@pytest.mark.parametrize("suffix", [".stl", ".obj", ".dae"])
def test_archives_are_not_unpacked(tmp_path, suffix):
    path = tmp_path / f"bomb{suffix}"
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr("a.stl", b"\0" * 10_000_000)
    with pytest.raises(UsageFault, match="a zip archive"):
        read_mesh(path)


@pytest.mark.parametrize("unit", ["0", "-1", "nan", "one", "1e9"])
def test_a_unit_that_is_none(tmp_path, unit):
    with pytest.raises(UsageFault, match="unit"):
        read_mesh(dae(tmp_path, unit=unit))


def test_an_axis_that_is_none(tmp_path):
    with pytest.raises(UsageFault, match="not a valid up axis"):
        read_mesh(dae(tmp_path, up="UP"))


def test_large_files_are_refused_before_they_are_read(tmp_path, monkeypatch):
    path = tmp_path / "large.stl"
    with path.open("wb") as file:
        file.truncate(mesh_limits.MOST_TRIANGLES * 500)
    with pytest.raises(UsageFault, match="it has 500,000,000 bytes, more than 200,000,000"):
        read_mesh(path)
    monkeypatch.setattr(mesh_limits, "MOST_TRIANGLES", 10)
    for suffix in (".stl", ".obj", ".dae"):
        with pytest.raises(UsageFault, match="may have 10"):
            read_mesh(written(tmp_path, suffix))


def test_a_folder_and_nothing(tmp_path):
    (tmp_path / "a.stl").mkdir()
    for name in ("a.stl", "b.stl"):
        with pytest.raises(UsageFault, match=r"it is a folder|no such file"):
            read_mesh(tmp_path / name)


def test_deep_xml_is_refused(tmp_path):
    deep = "<COLLADA>" + "<a>" * 200_000
    with pytest.raises(UsageFault):
        read_mesh(bad(tmp_path, "deep.dae", deep + "</a>" * 200_000 + "</COLLADA>"))
