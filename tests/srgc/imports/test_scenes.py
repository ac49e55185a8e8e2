"""`srgc import scene`: workspaces of MoveIt scenes, SDF worlds and meshes."""

from __future__ import annotations

import re
from fractions import Fraction

import numpy as np
import pytest
import trimesh
from manifold3d import Manifold, Mesh64, OpType

from srgc.faults import UsageFault
from srgc.imports.scenes.moveit_scene import moveit_scene
from srgc.imports.scenes.scene import Pose, angle_pose, quaternion_pose
from srgc.imports.scenes.scene_import import read_scene, scene_import
from srgc.session import check_file
from tests.conftest import ROOT

POSE = "0 0 0\n0 0 0 1\n"
COLOUR = "0 0 0 0\n"


def obj(name, shape, pose=POSE, own=POSE, new=True):
    """An object as saveGeometryToStream writes it."""
    head = f"* {name}\n{own if new else ''}1\n"
    return f"{head}{shape}\n{pose}{COLOUR}{'0' + chr(10) if new else ''}"


def scene_file(tmp_path, *objects, end=".\n", name="cell"):
    path = tmp_path / f"{name}.scene"
    path.write_text(f"{name}\n{''.join(objects)}{end}")
    return path


def regions(tmp_path, imported):
    """The regions and maps of the workspace of an import, read back by the language."""
    spec = tmp_path / "read" / "scene.srg"
    for name, content in imported.files.items():
        (spec.parent / name).parent.mkdir(parents=True, exist_ok=True)
        (spec.parent / name).write_bytes(content)
    spec.parent.mkdir(exist_ok=True)
    spec.write_text(imported.text)
    found = check_file(spec)
    assert [d for d in found.diagnostics if d.severity.value == "error"] == []
    (workspace,) = found.program.workspaces.values()
    return workspace


def hull(points):
    return Manifold.hull_points(np.array([[float(x) for x in point] for point in points]))


def solid(mesh):
    faces = np.asarray(mesh.faces, dtype=np.uint64)
    return Manifold(Mesh64(np.asarray(mesh.vertices, dtype=float), faces))


def named(workspace):
    return {region.name: region for region in workspace.regions}


def sides(region):
    """The box of a region as pairs of fractions."""
    rows = {row.normal: row.offset for row in region.shape.rows}
    axes = np.eye(3, dtype=int).tolist()
    return [
        (-rows[tuple(Fraction(-x) for x in axis)], rows[tuple(Fraction(x) for x in axis)])
        for axis in axes
    ]


# --- MoveIt ---------------------------------------------------------------------------------------


def test_boxes_balls_and_cylinders_of_moveit(tmp_path):
    path = scene_file(
        tmp_path,
        obj("table 1", "box\n0.8 1.2 0.05", own="0.6 0 0.2\n0 0 0 1\n"),
        obj("ball", "sphere\n0.1", pose="0 0 1\n0 0 0 1\n", own="0.1 0.2 0.3\n0 0 0.6 0.8\n"),
        obj("post", "cylinder\n0.03 0.5", own="0 0 0.25\n0.70710678 0 0 0.70710678\n"),
    )
    found = named(regions(tmp_path, scene_import(path)))
    tenth = Fraction(1, 10)
    assert sides(found["table_1"]) == [
        (2 * tenth, 1), (-6 * tenth, 6 * tenth), (Fraction(7, 40), Fraction(9, 40)),
    ]  # fmt: skip
    assert found["ball"].shape.points == ((tenth, 2 * tenth, Fraction(13, 10)),)
    assert found["ball"].shape.radius == tenth
    # A quarter turn about x: the cylinder lies along y.
    assert sorted(found["post"].shape.points) == [
        (0, Fraction(-1, 4), Fraction(1, 4)), (0, Fraction(1, 4), Fraction(1, 4)),
    ]  # fmt: skip


def test_the_older_format_has_no_poses_of_objects(tmp_path):
    path = scene_file(tmp_path, obj("a", "box\n1 1 1", "2 0 0\n0 0 0 1\n", new=False))
    (found,) = moveit_scene(path).objects
    assert found.pose.shift.tolist() == [2, 0, 0]


def test_a_turned_box_is_held_by_its_hull(tmp_path):
    turn = "0.1 0.2 0.3 0.9273618"
    path = scene_file(tmp_path, obj("b", "box\n0.3 0.2 0.1", own=f"1 2 3\n{turn}\n"))
    shape = named(regions(tmp_path, scene_import(path)))["b"].shape
    points = np.array([[float(x) for x in p] for p in shape.points])
    quaternion = np.roll([float(x) for x in turn.split()], 1)
    matrix = trimesh.transformations.quaternion_matrix(quaternion)
    matrix[:3, 3] = (1, 2, 3)
    true = trimesh.creation.box((0.3, 0.2, 0.1), transform=matrix)
    assert points.shape == (8, 3)
    distance = np.linalg.norm(points[:, None] - true.vertices[None], axis=2)
    assert distance.min(axis=1).max() < 1e-4
    assert (solid(true) - hull(points)).volume() < 1e-12


def test_a_mesh_of_moveit_is_pieces_that_hold_it(tmp_path):
    ring = trimesh.creation.annulus(r_min=0.1, r_max=0.15, height=0.1, sections=16)
    lines = [f"mesh\n{len(ring.vertices)} {len(ring.faces)}"]
    lines += [" ".join(map(repr, row)) for row in ring.vertices.tolist()]
    lines += [" ".join(map(str, row)) for row in ring.faces.tolist()]
    path = scene_file(tmp_path, obj("ring", "\n".join(lines), own="1 0 0\n0 0 0 1\n"))
    imported = scene_import(path)
    assert list(imported.files) == ["cell_meshes/ring.obj"]
    (found,) = regions(tmp_path, imported).maps
    assert found.name == "ring"
    _, *blocks = imported.files["cell_meshes/ring.obj"].decode().split("\no ")
    parts = [
        hull([line.split()[1:] for line in block.split("\n") if line[:2] == "v "])
        for block in blocks
    ]
    ring.apply_translation((1, 0, 0))
    union = Manifold.batch_boolean(parts, OpType.Add)
    assert (solid(ring) - union).volume() < 1e-12
    assert union.volume() < 1.1 * ring.volume
    assert "convex pieces" in " ".join(imported.remarks)


def test_planes_are_listed_and_a_floor_is_a_bound(tmp_path):
    path = scene_file(
        tmp_path,
        obj("floor", "plane\n0 0 2 0.5"),
        obj("wall", "plane\n1 0 0 0"),
        obj("cube", "box\n1 1 1", own="0 0 1\n0 0 0 1\n"),
    )
    imported = scene_import(path)
    assert sum("not carried over" in line for line in imported.remarks) == 2
    assert "// - wall: a plane without bounds" in imported.text
    bounds = regions(tmp_path, imported).bounds.shape
    assert -Fraction(-1, 4) in {row.offset for row in bounds.rows if row.normal[2] < 0}


def test_what_stands_behind_the_end_is_listed(tmp_path):
    first, second = obj("a", "box\n1 1 1"), obj("b", "box\n1 1 1")
    whole = scene_import(scene_file(tmp_path, first, end=".\n\n"))
    assert whole.remarks == ()
    path = scene_file(tmp_path, first, end=f".\nother\n{second}.\n")
    assert scene_import(path).remarks == (
        "not carried over: what stands behind the `.`, where the scene ends",
    )


@pytest.mark.parametrize(
    ("content", "said"),
    [
        ("", "empty"),
        ("cell\n", "the file ends"),
        ("cell\n* a\n0 0 0\n0 0 0 1\n1\nbox\n1 1", "the file ends|3 finite"),
        ("cell\n* a\n0 0 0\n0 0 0 1\n1\ntorus\n1 1\n", "`torus` is not a known shape"),
        ("cell\n* a\n0 0 0\n0 0 0 0\n1\nsphere\n1\n" + POSE + COLOUR + "0\n.", "zero quaternion"),
        ("cell\n* a\n0 0 0\n0 0 0 1\n1\nsphere\n-1\n" + POSE + COLOUR + "0\n.", "not positive"),
        ("cell\n* a\n0 0 0\n0 0 0 1\n1\nsphere\nnan\n", "finite"),
        ("cell\n* a\n0 0 0\n0 0 0 1\n1\nmesh\n99999999999 9999999999\n", "may have"),
        ("cell\n* a\n0 0 0\n0 0 0 1\n1\nmesh\n3 1\n0 0 0\n1 0 0\n0 1 0\n0 1 7\n", "not there"),
        ("cell\nbox\n", "is expected"),
        ("cell\n.\n", "nothing in it collides"),
    ],
)
def test_scenes_with_faults(tmp_path, content, said):
    path = tmp_path / "bad.scene"
    path.write_text(content)
    with pytest.raises(UsageFault, match=said):
        scene_import(path)


# --- SDF ------------------------------------------------------------------------------------------


def world(tmp_path, *models, name="lab"):
    path = tmp_path / "lab.world"
    path.write_text(f"<sdf version='1.7'><world name='{name}'>{''.join(models)}</world></sdf>")
    return path


def model(name, geometry, pose="", link="", collision="", more=""):
    def of(text):
        return f"<pose>{text}</pose>" if text else ""

    return (
        f"<model name='{name}'><static>true</static>{of(pose)}{more}<link name='l'>{of(link)}"
        f"<collision name='c'>{of(collision)}<geometry>{geometry}</geometry></collision></link>"
        "</model>"
    )


BOX = "<box><size>1 2 3</size></box>"


def test_poses_of_sdf_are_nested(tmp_path):
    rng = np.random.default_rng(1)
    texts, due = [], np.eye(4)
    for _ in range(3):
        place, angles = rng.uniform(-1, 1, 3), rng.uniform(-3, 3, 3)
        texts.append(" ".join(map(repr, [*place.tolist(), *angles.tolist()])))
        step = trimesh.transformations.euler_matrix(*angles, axes="sxyz")
        step[:3, 3] = place
        due = due @ step
    (found,) = read_scene(world(tmp_path, model("m", BOX, *texts))).objects
    assert np.allclose(found.pose.turn, due[:3, :3], atol=1e-12)
    assert np.allclose(found.pose.shift, due[:3, 3], atol=1e-12)


def test_quaternions_and_angles_agree_with_trimesh():
    rng = np.random.default_rng(2)
    for _ in range(20):
        quaternion = rng.normal(size=4)
        matrix = trimesh.transformations.quaternion_matrix(np.roll(quaternion, 1))
        assert np.allclose(quaternion_pose((0, 0, 0), quaternion, "").turn, matrix[:3, :3])
        pose = angle_pose((1, 2, 3), rng.uniform(-3, 3, 3), "")
        both = pose.then(pose.inverse())
        assert np.allclose(both.turn, np.eye(3))
        assert np.allclose(both.shift, 0)
    assert Pose().along_axes()


def test_frames_that_poses_are_relative_to(tmp_path):
    text = (
        "<model name='m'><pose>1 0 0 0 0 0</pose><frame name='f'><pose>0 0 1 0 0 0</pose></frame>"
        "<link name='a'><pose relative_to='b'>0 5 0 0 0 0</pose><collision name='c'><geometry>"
        f"{BOX}</geometry></collision></link><link name='b'><pose relative_to='f' degrees='true'>"
        f"0 0 0 0 0 90</pose><collision name='c'><geometry>{BOX}</geometry></collision></link>"
        "</model>"
    )
    scene = read_scene(world(tmp_path, text))
    places = {each.name: each.pose.shift for each in scene.objects}
    assert np.allclose(places["m_b"], (1, 0, 1))
    assert np.allclose(places["m_a"], (-4, 0, 1))  # five along the turned y of b


def test_a_second_shape_of_a_geometry_is_listed(tmp_path):
    ball = "<sphere><radius>3</radius></sphere>"
    scene = read_scene(world(tmp_path, model("m", BOX + ball)))
    assert len(scene.objects) == 1
    assert scene.dropped[-1:] == ["m: a second shape in one geometry, sphere"]


def test_what_sdf_has_and_a_workspace_has_not_is_listed(tmp_path):
    text = world(
        tmp_path,
        "<physics type='ode'/><light name='sun'/><plugin name='clock' filename='c.so'/>",
        model("ground", "<plane><normal>0 0 1</normal><size>9 9</size></plane>"),
        model("hills", "<heightmap><uri>x.png</uri></heightmap>"),
        model("arm", BOX, more="<joint name='hinge' type='revolute'/><plugin name='p'/>"),
        "<include><uri>model://nowhere</uri></include>",
        "<include><uri>https://fuel.example/box</uri></include>",
        "<model name='seen'><link name='l'><visual name='v'/><sensor name='eye'/></link></model>",
    )
    imported = scene_import(text)
    said = "\n".join(imported.remarks)
    for each in (
        "physics, light", "plugin clock", "ground: a floor", "hills: a heightmap", "joint hinge",
        "arm: plugin p", "model://nowhere", "https://fuel.example/box", "seen: it is seen",
        "sensor eye", "seen may move",
    ):  # fmt: skip
        assert each in said
        assert each in re.sub(r"\n//\s*", " ", imported.text)
    assert list(named(regions(tmp_path, imported))) == ["arm"]


def test_includes_below_the_folder_and_in_packages(tmp_path):
    inside, outside = tmp_path / "scene" / "chair", tmp_path / "elsewhere"
    for folder in (inside, outside):
        folder.mkdir(parents=True)
        (folder / "model.sdf").write_text(f"<sdf version='1.7'>{model('chair', BOX)}</sdf>")
    trimesh.creation.box((1, 1, 1)).export(inside / "cube.stl")
    mesh = "<mesh><uri>model://chair/cube.stl</uri><scale>2 1 1</scale></mesh>"
    path = world(
        inside.parent,
        "<include><uri>model://chair</uri><name>one</name><pose>3 0 0 0 0 0</pose></include>",
        "<include><uri>model://desk</uri></include>",
        model("cube", mesh),
    )
    scene = read_scene(path)
    assert [each.name for each in scene.objects] == ["cube", "one"]
    assert scene.objects[1].pose.shift.tolist() == [3, 0, 0]
    assert np.ptp(scene.objects[0].shape.mesh.vertices, axis=0).tolist() == [2, 1, 1]
    assert any("desk" in line for line in scene.dropped)
    both = read_scene(path, packages=[f"desk={outside}"])
    assert len(both.objects) == 3


@pytest.mark.parametrize("uri", ["../secret.stl", "file:///etc/hosts.stl", "model://../secret.stl"])
def test_meshes_outside_are_not_read(tmp_path, uri):
    trimesh.creation.box((1, 1, 1)).export(tmp_path / "secret.stl")
    (tmp_path / "in").mkdir()
    path = world(tmp_path / "in", model("m", f"<mesh><uri>{uri}</uri></mesh>"))
    with pytest.raises(UsageFault, match=r"leads out|resolves nowhere"):
        read_scene(path)


def test_links_that_lead_out_are_not_followed(tmp_path):
    trimesh.creation.box((1, 1, 1)).export(tmp_path / "secret.stl")
    (tmp_path / "in").mkdir()
    (tmp_path / "in" / "a.stl").symlink_to(tmp_path / "secret.stl")
    path = world(tmp_path / "in", model("m", "<mesh><uri>a.stl</uri></mesh>"))
    with pytest.raises(UsageFault, match="leads out"):
        read_scene(path)


def test_a_model_that_includes_itself(tmp_path):
    (tmp_path / "loop").mkdir()
    loop = "<include><uri>model://loop</uri></include>"
    (tmp_path / "loop" / "model.sdf").write_text(
        f"<sdf version='1.7'><model name='loop'>{loop}</model></sdf>"
    )
    with pytest.raises(UsageFault, match="nested more than"):
        read_scene(world(tmp_path, loop))


@pytest.mark.parametrize(
    ("text", "said"),
    [
        ("<sdf/>", "nothing in it collides"),
        ("<urdf/>", "not an SDF file"),
        ("<sdf><world", "not XML"),
        ("<!DOCTYPE a [<!ENTITY b 'c'>]><sdf>&b;</sdf>", "document type"),
        (f"<sdf>{model('m', BOX, '1 2 3')}</sdf>", "3 numbers, and 6"),
        (f"<sdf>{model('m', BOX, '1 2 3 x 0 0')}</sdf>", "not a list of numbers"),
        (f"<sdf>{model('m', BOX, 'nan 2 3 0 0 0')}</sdf>", "not finite"),
        (f"<sdf>{model('m', '<box><size>1 2</size></box>')}</sdf>", "3 finite numbers"),
        (f"<sdf>{model('m', '<sphere><radius>0</radius></sphere>')}</sdf>", "not positive"),
        (f"<sdf>{model('m', '<polyline><height>1</height></polyline>')}</sdf>", "encloses nothing"),
    ],
)
def test_worlds_with_faults(tmp_path, text, said):
    path = tmp_path / "bad.sdf"
    path.write_text(text)
    with pytest.raises(UsageFault, match=said):
        scene_import(path)


CORNERS = "".join(f"<point>{place}</point>" for place in ("0 0", "0.4 0", "0 0.3"))
ROUND = (
    "<ellipsoid><radii>0.1 0.2 0.3</radii></ellipsoid>",
    "<cone><radius>0.1</radius><length>0.3</length></cone>",
    "<capsule><radius>0.1</radius><length>0.3</length></capsule>",
    f"<polyline>{CORNERS}<height>0.2</height></polyline>",
)


def test_rarer_shapes_of_sdf(tmp_path):
    models = [model(f"m{i}", shape) for i, shape in enumerate(ROUND)]
    found = named(regions(tmp_path, scene_import(world(tmp_path, *models))))
    assert found["m2"].shape.kind == "capsule"
    points = {name: np.array(found[name].shape.points, dtype=float) for name in ("m0", "m1", "m3")}
    volumes = {name: hull(each).volume() for name, each in points.items()}
    directions = np.random.default_rng(0).normal(size=(500, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    reach = (points["m0"] @ directions.T).max(axis=0)
    assert (reach >= np.linalg.norm(directions * (0.1, 0.2, 0.3), axis=1)).all()
    assert volumes["m0"] < 1.3 * 4 / 3 * np.pi * 0.1 * 0.2 * 0.3
    assert np.pi * 0.01 * 0.1 < volumes["m1"] < 1.1 * np.pi * 0.01 * 0.1
    assert volumes["m3"] == pytest.approx(0.4 * 0.3 / 2 * 0.2, rel=0.01)


# --- Meshes, and the command ----------------------------------------------------------------------


def test_an_stl_in_millimetres_at_a_place(tmp_path):
    path = tmp_path / "2nd part.stl"
    trimesh.creation.box(bounds=[(0, 0, 0), (100, 50, 25)]).export(path)
    imported = scene_import(path, unit="mm", at="(50, 0, 10) cm", name="big cell")
    assert "workspace BigCell {" in imported.text
    ((name, found),) = named(regions(tmp_path, imported)).items()
    assert name == "_2nd_part"
    due = [(50, 60), (0, 5), (10, Fraction(25, 2))]
    assert sides(found) == [(Fraction(low, 100), Fraction(high) / 100) for low, high in due]


@pytest.mark.parametrize(
    ("unit", "place", "told"),
    [
        ("mm", "(400, 600, 300)", True),
        ("in", "1, 0, 2", True),
        ("mm", "(400, 600, 300) mm", False),
        ("m", "(0.4, 0.6, 0.3)", False),
        (None, "(0.4, 0.6, 0.3)", False),
    ],
)
def test_a_place_without_a_unit_is_in_metres_whatever_the_mesh(tmp_path, unit, place, told):
    path = tmp_path / "part.stl"
    trimesh.creation.box((100, 50, 25) if unit in {"mm", "in"} else (1, 1, 1)).export(path)
    imported = scene_import(path, unit=unit, at=place)
    said = f"--at {place} is in m; write `{place} {unit}` if it is in {unit}"
    assert (said in imported.remarks) is told


def test_the_command_writes_a_clean_spec(srgc, tmp_path):
    out = tmp_path / "bench.srg"
    ran = srgc("import", "scene", ROOT / "specs/imports/bench.scene", "-o", out)
    assert ran.status == 0
    assert "floor" in ran.err
    assert srgc("fmt", "--check", out).status == 0
    found = (
        srgc("check", "--strict", out)
        if "--strict" in srgc("check", "--help").out
        else srgc("check", out)
    )
    assert found.status == 0
    assert "warning" not in found.out


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["a.txt"], "is not that of a scene"),
        (["none.scene"], "none.scene"),
        (["b.stl", "--unit", "ft"], "--unit"),
        (["c.scene", "--unit", "mm"], "in metres"),
        (["b.stl", "--at", "here"], "not a position"),
        (["b.stl", "--at", "(1, 2, nan)"], "not a position"),
        (["w.sdf", "--package", "x"], "NAME=DIR"),
        (["b.stl", "--exact"], "does not go with"),
        (["b.stl", "--pieces", "0"], "--pieces"),
    ],
)
def test_wrong_arguments(srgc, tmp_path, monkeypatch, arguments, said):
    monkeypatch.chdir(tmp_path)
    trimesh.creation.box((1, 1, 1)).export(tmp_path / "b.stl")
    scene_file(tmp_path, obj("a", "sphere\n1"), name="c")
    (tmp_path / "w.sdf").write_text("<sdf/>")
    ran = srgc("import", "scene", *arguments, "-o", "out.srg")
    assert ran.status == 2
    assert said in ran.err
    assert not (tmp_path / "out.srg").exists()
