"""SDF with parts beside or twice, sizes out of bounds, and numbers in another spelling."""

from __future__ import annotations

import pytest

from srgc.faults import UsageFault
from srgc.imports.scenes.scene_import import read_scene
from tests.srgc.imports.test_scenes import BOX, model

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
