"""Where SDF places what collides: nested frames, joints, placement frames and parts of meshes."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

from srgc.faults import UsageFault
from srgc.imports.scenes.scene_import import read_scene
from tests.srgc.imports.test_scenes import POSE, world

CUBE = "<collision name='c'><geometry><box><size>0.2 0.2 0.2</size></box></geometry></collision>"


def link(name, place="", relative="", shape=CUBE):
    """A link with a cube at a place, and what that is relative to."""
    pose = f"<pose relative_to='{relative}'>{place}</pose>" if relative else f"<pose>{place}</pose>"
    return f"<link name='{name}'>{pose if place else ''}{shape}</link>"


def frame(name, place, attached=""):
    return f"<frame name='{name}' attached_to='{attached}'><pose>{place}</pose></frame>"


def model(name, *inside, place="0 0 0 0 0 0", relative="", placement=""):
    """A static model of elements."""
    return (
        f"<model name='{name}'{f' placement_frame={placement!r}' if placement else ''}>"
        f"<static>1</static><pose relative_to='{relative}'>{place}</pose>{''.join(inside)}</model>"
    )


def matrix(place):
    """Places as a matrix, by trimesh."""
    numbers = [float(word) for word in place.split()]
    found = trimesh.transformations.euler_matrix(*numbers[3:], axes="sxyz")
    found[:3, 3] = numbers[:3]
    return found


def places(path):
    """The places of objects as matrices."""
    found = {}
    for each in read_scene(path).objects:
        found[each.name] = np.eye(4)
        found[each.name][:3, :3], found[each.name][:3, 3] = each.pose.turn, each.pose.shift
    return found


P, Q, R, S = "1 2 3 0.1 -0.4 0.7", "0.3 0 -1 1.2 0 0.5", "0 0.2 0.1 0 0.9 0", "2 0 0 0.3 0.3 0.3"
MP, MQ, MR, MS = map(matrix, (P, Q, R, S))


# --- Placement frames -----------------------------------------------------------------------------


def test_a_pose_places_the_placement_frame_of_a_model(tmp_path):
    top = frame("top", "0 0 0.8 0 0 0")
    path = world(tmp_path, model("m", top, link("l"), place="0 0 1 0 0 0", placement="top"))
    (found,) = read_scene(path).objects
    # The top, at 0.8 above the origin, is to be at 1; so the cube reaches from 0.1 to 0.3.
    assert found.pose.shift == pytest.approx((0, 0, 0.2))


@pytest.mark.parametrize(
    ("inside", "named", "due"),
    [
        (link("a") + link("b", Q), "b", MP @ np.linalg.inv(MQ)),
        (link("a") + frame("f", Q, "b") + link("b", R), "f", MP @ np.linalg.inv(MR @ MQ)),
        (link("a") + model("B", link("b", R), place=Q), "B::b", MP @ np.linalg.inv(MQ @ MR)),
    ],
)
def test_placement_frames_that_are_turned(tmp_path, inside, named, due):
    path = world(tmp_path, model("m", inside, place=P, placement=named))
    found = places(path)
    assert np.allclose(found.get("m_a", found.get("m")), due, atol=1e-12)


def included(tmp_path, *inside, **about):
    (tmp_path / "part").mkdir()
    text = f"<sdf version='1.9'>{model('part', *inside, **about)}</sdf>"
    (tmp_path / "part" / "model.sdf").write_text(text)


@pytest.mark.parametrize(
    ("more", "due"),
    [
        ("", MS @ np.linalg.inv(MR)),
        (f"<pose>{P}</pose>", MP @ np.linalg.inv(MR)),
        (f"<pose>{P}</pose><placement_frame>f</placement_frame>", MP @ np.linalg.inv(MQ)),
        (f"<pose>{P}</pose><placement_frame>__model__</placement_frame>", MP),
    ],
)
def test_placement_frames_of_includes(tmp_path, more, due):
    frames = frame("f", Q) + frame("g", R)
    included(tmp_path, frames, link("a"), place=S, placement="g")
    found = places(world(tmp_path, f"<include><uri>model://part</uri>{more}</include>"))
    assert np.allclose(found["part"], due, atol=1e-12)


# --- Names of frames ------------------------------------------------------------------------------

NESTED = model("A", model("B", link("l", Q), frame("f", R, "l"), place=S), place=P)


@pytest.mark.parametrize(
    ("named", "due"),
    [
        ("A::B::l", MP @ MS @ MQ),
        ("A::B::f", MP @ MS @ MQ @ MR),
        ("A::B", MP @ MS),
        ("A::B::__model__", MP @ MS),
        ("A", MP),
    ],
)
@pytest.mark.parametrize("nested", [False, True])
def test_poses_relative_to_frames_of_nested_models(tmp_path, named, due, nested):
    own = model("m", link("a"), place=R, relative=named)
    attached = frame("k", "0 0 0 0 0 0", named) + model("n", link("a"), place=R, relative="k")
    # What a pose is relative to may be behind it.
    inside = own + attached + NESTED
    path = world(tmp_path, model("whole", inside, place=Q) if nested else inside)
    found = places(path)
    before, start = ("whole_", MQ) if nested else ("", np.eye(4))
    assert np.allclose(found[f"{before}m"], start @ due @ MR, atol=1e-12)
    assert np.allclose(found[f"{before}n"], start @ due @ MR, atol=1e-12)


@pytest.mark.parametrize(
    ("pose", "due"),
    [
        ("", MP),
        (f"<pose>{S}</pose>", MP @ MS),
        (f"<pose relative_to='__model__'>{S}</pose>", MS),
        (f"<pose relative_to='p'>{S}</pose>", MQ @ MS),
    ],
)
@pytest.mark.parametrize("child", ["c", "B::l"])
def test_a_joint_is_at_its_child(tmp_path, pose, due, child):
    ends = f"<parent>p</parent><child>{child}</child>"
    joint = f"<joint name='j' type='fixed'>{pose}{ends}</joint>"
    nested = model("B", link("l"), place=P)
    inside = (link("a", R, "j"), joint, link("p", Q), link("c", P), nested)
    found = places(world(tmp_path, model("m", *inside)))
    assert np.allclose(found["m_a"], due @ MR, atol=1e-12)


def test_frames_of_merged_includes(tmp_path):
    included(tmp_path, frame("f", Q), link("b"), place=P)
    merged = "<include merge='true'><uri>model://part</uri></include>"
    found = places(world(tmp_path, model("m", merged, link("a", R, "f"))))
    assert np.allclose(found["m"], MP @ MQ @ MR, atol=1e-12)


CIRCLE = link("a", P, "b") + link("b", P, "a")


@pytest.mark.parametrize(
    ("text", "said"),
    [
        (
            model("m", "\n", link("a", P, "nowhere")),
            r":2:16: error\[SRG0803\]: `nowhere` is not",
        ),
        (model("m", "\n", link("a", P, "B::nowhere"), NESTED), r":2:16: .*`B::nowhere` is no"),
        (model("m", link("a", P, "f"), "\n", frame("f", P, "g")), r":2:1: .*`g` is not a"),
        (model("m", link("a"), relative="n"), r":1:\d+: .*`n` is not a"),
        (
            model("m", link("a"), placement="top"),
            "placement frame `top` is not a frame of the model",
        ),
        (model("m", CIRCLE), r"SRG0803.*in a circle: `a`, `b`, `a`"),
        (model("m", link("a"), relative="m::a"), "in a circle: `m`, `m`"),
        (model("m", link("a", P, "j"), "<joint name='j'/>"), "has no child link"),
        (
            model("m", link("a", P, "j"), "<joint name='j'><child>a</child></joint>"),
            "in a circle: `a`, `j`, `a`",
        ),
        (
            "<include><uri>model://away</uri></include>" + model("m", link("a"), relative="away"),
            "(?s)`away` is not a.*include model://away",
        ),
        (
            model("m", *(link(f"a{i}", P, f"a{i + 1}") for i in range(900)), link("a900")),
            "relative one to the next",
        ),
    ],
)
def test_frames_that_are_not_there_and_circles(tmp_path, text, said):
    with pytest.raises(UsageFault, match=said):
        read_scene(world(tmp_path, text))


def test_a_placement_frame_without_a_pose(tmp_path):
    included(tmp_path, frame("f", Q), link("a"))
    include = "<include><uri>model://part</uri><placement_frame>f</placement_frame></include>"
    with pytest.raises(UsageFault, match="a placement frame is expected with a pose"):
        read_scene(world(tmp_path, include))


def test_long_chains_in_the_order_of_the_file(tmp_path):
    links = [link(f"a{i + 1}", "0 0 1 0 0 0", f"a{i}") for i in range(300)]
    found = places(world(tmp_path, model("m", link("a0"), *links)))
    assert found["m_a300"][2, 3] == 300


# --- Parts of meshes ------------------------------------------------------------------------------


def two_parts(tmp_path):
    """A file with a small cube A, and a wedge B far from the origin."""
    wedge = trimesh.creation.box(bounds=[(5, 1, 2), (7, 2, 2.5)])
    wedge.vertices[(wedge.vertices[:, 0] > 6) & (wedge.vertices[:, 2] > 2.2), 2] = 2
    parts = {"A": trimesh.creation.box((1, 1, 1)), "B": wedge}
    lines, before = [], 1
    for name, each in parts.items():
        lines += [f"o {name}", *("v " + " ".join(map(str, v)) for v in each.vertices.tolist())]
        lines += ["f " + " ".join(map(str, row)) for row in (each.faces + before).tolist()]
        before += len(each.vertices)
    (tmp_path / "two.obj").write_text("\n".join(lines) + "\n")


@pytest.mark.parametrize(
    ("center", "lower", "upper"),
    [
        ("<center>true</center>", (-2, -0.5, -0.25), (2, 0.5, 0.25)),
        ("<center>1</center>", (-2, -0.5, -0.25), (2, 0.5, 0.25)),
        ("<center>false</center>", (10, 1, 2), (14, 2, 2.5)),
        ("", (10, 1, 2), (14, 2, 2.5)),
    ],
)
def test_a_submesh_is_centred_by_the_box_about_it(tmp_path, center, lower, upper):
    two_parts(tmp_path)
    shape = (
        "<collision name='c'><geometry><mesh><uri>two.obj</uri><scale>2 1 1</scale>"
        f"<submesh><name>B</name>{center}</submesh></mesh></geometry></collision>"
    )
    path = world(tmp_path, model("m", link("l", shape=shape), place="0 0 9 0 0 0"))
    (found,) = read_scene(path).objects
    points = found.pose.of(found.shape.mesh.vertices)
    assert points.min(axis=0) == pytest.approx(np.add(lower, (0, 0, 9)))
    assert points.max(axis=0) == pytest.approx(np.add(upper, (0, 0, 9)))


TRIANGLES = "v 0 0 0\nv 1 0 0\nv 0 1 0\n{}g left part\nf 1 2 3\ng right part\nf 3 2 1\n"


@pytest.mark.parametrize(
    ("text", "names", "noted"),
    [
        (TRIANGLES.format(""), ["left part", "right part"], False),
        (TRIANGLES.format("o groups\n"), ["groups"], True),
        (TRIANGLES.format("o a\n").replace("g right", "o b\ng right"), ["a", "b"], False),
    ],
)
def test_groups_of_obj_are_objects_where_there_are_no_others(tmp_path, text, names, noted):
    (tmp_path / "cell.obj").write_text(text)
    scene = read_scene(tmp_path / "cell.obj")
    assert [each.name for each in scene.objects] == names
    assert any("groups (`g`) in an object" in each for each in scene.dropped) == noted


@pytest.mark.parametrize(("count", "said"), [(1, "a subframe, which"), (2, "2 subframes, which")])
def test_subframes_are_counted(tmp_path, count, said):
    frames = "".join(f"grip {i}\n{POSE}" for i in range(count))
    text = f"cell\n* a\n{POSE}1\nsphere\n1\n{POSE}0 0 0 0\n{count}\n{frames}.\n"
    (tmp_path / "cell.scene").write_text(text)
    (dropped,) = read_scene(tmp_path / "cell.scene").dropped
    assert said in dropped
