"""SDF with parts beside or twice, sizes out of bounds, and numbers in another spelling."""

from __future__ import annotations

import pytest
import trimesh

from srgc.faults import UsageFault
from srgc.imports.scenes.scene_import import read_scene, scene_import
from srgc.imports.urdf.urdf_import import urdf_import
from tests.srgc.imports.test_scenes import BOX, model, obj, regions, scene_file

INCLUDE = "<include><uri>model://pair</uri></include>"


def sdf(tmp_path, text, name="lab.sdf"):
    path = tmp_path / name
    path.parent.mkdir(exist_ok=True)
    path.write_text(f"<sdf version='1.7'>{text}</sdf>")
    return path


# --- Beside ---------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("text", "read", "said"),
    [
        (f"<world name='w'>{INCLUDE}</world>", ["a"],
         "include model://pair: model.sdf has model b; an include is its first model"),
        (f"<world name='w'>{INCLUDE}</world>", ["a"],
         "include model://pair: model.sdf has light sun; an include is its first model"),
        (f"<world name='w'>{model('m', BOX)}</world>{model('n', BOX)}", ["m"],
         "beside the world: model n; a file is one scene, of its first"),
        (f"<world name='w'>{model('m', BOX)}</world>{INCLUDE}", ["m"],
         "beside the world: include model://pair; a file is one scene, of its first"),
        (f"<world name='w'>{model('m', BOX)}</world><world name='v'/>", ["m"],
         "beside the world: world v; a file is one scene, of its first"),
        (f"{model('m', BOX)}<actor name='who'/>", ["m"], "of the file: actor who"),
        (f"<light name='sun'/>{model('m', BOX)}", ["m"], "of the file: light sun"),
        (f"{model('m', BOX)}{model('n', BOX)}", ["m", "n"], None),
    ],
)  # fmt: skip
def test_what_is_beside_is_listed(tmp_path, text, read, said):
    pair = model("a", BOX) + model("b", BOX) + "<light name='sun'/>"
    sdf(tmp_path, pair, "pair/model.sdf")
    scene = read_scene(sdf(tmp_path, text))
    assert [each.name for each in scene.objects] == read
    assert said in scene.dropped if said else scene.dropped == []


POSES = "<pose>0 0 1 0 0 0</pose><pose>0 0 2 0 0 0</pose>"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (model("m", f"{BOX}</geometry><geometry>{BOX}"), "<geometry> in one <collision>"),
        (model("m", BOX, more=POSES), "<pose> in one <model>"),
        (model("m", BOX).replace("<collision name='c'>", f"<collision>{POSES}"),
         "<pose> in one <collision>"),
        (model("m", BOX).replace("<link name='l'>", f"<link>{POSES}"), "<pose> in one <link>"),
        (f"<include><uri>a</uri>{POSES}</include>", "<pose> in one <include>"),
        (model("m", BOX, more=f"<frame name='f'>{POSES}</frame>"), "<pose> in one <frame>"),
        (model("m", "<box><size>1 1 1</size><size>2 2 2</size></box>"), "<size> in one <box>"),
        (INCLUDE, "<pose> in one <model>"),
    ],
)  # fmt: skip
def test_a_second_part_is_refused(tmp_path, text, said):
    sdf(tmp_path, model("a", BOX, more=POSES), "pair/model.sdf")
    with pytest.raises(UsageFault, match=f"a second {said}"):
        read_scene(sdf(tmp_path, text))


# --- Too large ------------------------------------------------------------------------------------


HUGE = [
    "<sphere><radius>1e308</radius></sphere>",
    "<box><size>1 1e308 1</size></box>",
    "<box><size>1 1e6 1</size></box>",
    "<cylinder><radius>1e308</radius><length>1</length></cylinder>",
    "<capsule><radius>1</radius><length>1e308</length></capsule>",
    "<cone><radius>1e308</radius><length>1</length></cone>",
    "<ellipsoid><radii>1 1 1e308</radii></ellipsoid>",
    "<polyline><height>1e308</height></polyline>",
]


@pytest.mark.parametrize("shape", HUGE)
def test_sizes_of_sdf_have_a_limit(tmp_path, shape):
    with pytest.raises(UsageFault, match=r"m: a size is 1e\+06 m or more"):
        scene_import(sdf(tmp_path, model("m", shape)))


@pytest.mark.parametrize(
    "shape", ["sphere\n1e308", "box\n1 1 1e308", "cylinder\n1e308 1", "cone\n1 1e308"]
)
def test_sizes_of_moveit_have_a_limit(tmp_path, shape):
    with pytest.raises(UsageFault, match=r"a: a size is 1e\+06 m or more"):
        scene_import(scene_file(tmp_path, obj("a", shape)))


def test_a_floor_out_of_sight_is_none(tmp_path):
    path = scene_file(tmp_path, obj("floor", "plane\n0 0 1 1e308"), obj("a", "sphere\n1"))
    assert "floor: a plane without bounds" in scene_import(path).text


FAR_POINT = "<polyline><point>0 0</point><point>1 0</point><point>0 1e308</point>"


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (model("m", BOX, "1e300 0 0 0 0 0"), "its place is"),
        (model("m", BOX, link="0 -1e6 0 0 0 0"), "its place is"),
        (model("m", f"{FAR_POINT}<height>1</height></polyline>"), "m: a point is"),
        (model("m", "<mesh><uri>a.stl</uri><scale>1e308 1 1</scale></mesh>"), "m: with its scale"),
        (model("m", "<mesh><uri>a.stl</uri><scale>1 1 -2e6</scale></mesh>"), "m: with its scale"),
        (model("m", "<mesh><uri>a.stl</uri><scale>1 1 1e390</scale></mesh>"), "finite"),
    ],
)
def test_nothing_is_too_far(tmp_path, text, said):
    trimesh.creation.box((1, 1, 1)).export(tmp_path / "a.stl")
    due = said if said == "finite" else rf"{said}.* 1e\+06 m away or farther"
    with pytest.raises(UsageFault, match=due):
        scene_import(sdf(tmp_path, text))


def test_a_scaled_mesh_of_urdf_is_not_too_far(tmp_path):
    trimesh.creation.box((1, 1, 1)).export(tmp_path / "a.stl")
    geometry = "<geometry><mesh filename='a.stl' scale='1e9 1 1'/></geometry>"
    path = tmp_path / "robot.urdf"
    path.write_text(
        f"<robot name='r'><link name='l'><collision>{geometry}</collision></link></robot>"
    )
    with pytest.raises(UsageFault, match=r"a.stl.*1e\+06 m away or farther"):
        urdf_import(path)


# --- Too thin -------------------------------------------------------------------------------------


TURNED = "1 2 0 0.3 0.4 0.5"


@pytest.mark.parametrize("place", ["", TURNED])
@pytest.mark.parametrize(
    "shape",
    [
        "<box><size>1 1e-9 1</size></box>",
        "<box><size>1 1 1e-320</size></box>",
        "<box><size>1e-10 1e-10 1e-10</size></box>",
        "<sphere><radius>1e-13</radius></sphere>",
        "<cylinder><radius>1e-12</radius><length>1</length></cylinder>",
        "<cylinder><radius>1</radius><length>1e-13</length></cylinder>",
        "<capsule><radius>0.1</radius><length>1e-13</length></capsule>",
        "<cone><radius>1e-13</radius><length>1e-13</length></cone>",
        "<ellipsoid><radii>1 1e-13 1</radii></ellipsoid>",
    ],
)
def test_thin_shapes_are_made_thicker(tmp_path, shape, place):
    imported = scene_import(sdf(tmp_path, model("m", shape, place)))
    (found,) = regions(tmp_path, imported).regions
    assert found.name == "m"
    (said,) = [note for note in imported.remarks if "made thicker" in note]
    assert said.startswith("m is made thicker")
    assert "// m is made thicker" in imported.text


@pytest.mark.parametrize(
    ("shape", "due"),
    [
        ("<box><size>1 1e-9 1</size></box>", "box [-50, 50] x [-0.0005, 0.0005] x [-50, 50] cm;"),
        ("<sphere><radius>1e-13</radius></sphere>", "ball (0, 0, 0) mm radius 0.005 mm;"),
        ("<capsule><radius>0.1</radius><length>1e-13</length></capsule>",
         "capsule (0, 0, -0.005), (0, 0, 0.005) mm radius 10 cm;"),
    ],
)  # fmt: skip
def test_thin_shapes_become_a_hundredth_of_a_millimetre(tmp_path, shape, due):
    assert due in scene_import(sdf(tmp_path, model("m", shape))).text


# --- Other spellings ------------------------------------------------------------------------------


@pytest.mark.parametrize("number", ["1_0", "\u0661", "\uff11"])
def test_numbers_are_ascii_without_underscores(tmp_path, number):
    for text in (
        model("m", f"<box><size>1 1 {number}</size></box>"),
        model("m", BOX, f"0 0 {number} 0 0 0"),
    ):
        with pytest.raises(UsageFault, match="is not a list of"):
            read_scene(sdf(tmp_path, text))
    with pytest.raises(UsageFault, match="no numbers stand here"):
        read_scene(scene_file(tmp_path, obj("a", f"sphere\n{number}")))
    corners = "v 0 0 0\nv 1 0 0\nv 0 1 0\n"
    for rest, said in ((f"v 0 0 {number}\n", "coordinates"), (f"f {number} 2 3\n", "a number")):
        (tmp_path / "a.obj").write_text(corners + rest)
        with pytest.raises(UsageFault, match=said):
            read_scene(tmp_path / "a.obj")
