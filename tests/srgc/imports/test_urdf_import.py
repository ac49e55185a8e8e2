"""What `srgc import urdf` writes: text that checks, is canonical, and moves as the file says."""

from __future__ import annotations

import math
import re
from pathlib import Path

import numpy as np
import pytest

import srgc
from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.formatting.formatter import canonical
from srgc.faults import UsageFault
from srgc.imports.urdf.urdf_import import urdf_import
from tests.conftest import ROOT
from tests.oracles.urdf_files import LIMIT, joint, link, robot

SCARA = ROOT / "specs" / "robots" / "scara.urdf"


@pytest.fixture
def imported(tmp_path: Path):
    """The import of a text, and the spec that it gives, loaded."""

    def run(text: str, **options):
        (tmp_path / "r.urdf").write_text(text)
        found = urdf_import(tmp_path / "r.urdf", **options)
        for name, data in found.files.items():
            (tmp_path / name).parent.mkdir(exist_ok=True)
            (tmp_path / name).write_bytes(data)
        (tmp_path / "r.srg").write_text(found.text)
        return found

    run.folder = tmp_path
    return run


def only_robot(path: Path) -> srgc.Robot:
    program = srgc.load(path)
    (word,) = srgc.words(program, limit=2)
    return srgc.robot(program, word)


def quiet(text: str) -> None:
    """Nothing but notes, and canonical as it is."""
    found = srgc.check(text=text)
    assert [each for each in found if each.severity.value != "note"] == []
    sink = Sink()
    assert canonical(text, sink) == text


def test_a_scara_is_text_that_checks():
    found = urdf_import(SCARA)
    quiet(found.text)
    assert found.name == "scara"
    assert found.remarks == ()
    assert (
        "dof s: prismatic -z in [0, 200] mm rate in [-1.1, 1.1] m/s effort <= 150 N "
        'named "quill_joint";'
    ) in " ".join(found.text.split())
    assert re.findall(r"^module (\w+)", found.text, re.MULTILINE) == [
        "Scara_Base", "Scara_UpperArm", "Scara_Forearm", "Scara_Quill", "Scara_Tool", "Scara_Tip",
    ]  # fmt: skip


def test_the_tip_of_the_scara_by_hand(tmp_path):
    (tmp_path / "scara.srg").write_text(urdf_import(SCARA).text)
    one, two, shift, roll = 0.4, -1.1, 0.07, 2.0
    (tip,) = only_robot(tmp_path / "scara.srg").effectors([one, two, shift, roll])
    x = 0.325 * math.cos(one) + 0.275 * math.cos(one + two)
    y = 0.325 * math.sin(one) + 0.275 * math.sin(one + two)
    # Up the column, the arms, down the quill, and from there down: the tool looks down.
    z = 0.345 + 0.06 + 0.05 - shift - 0.12 - 0.05
    np.testing.assert_allclose(tip, (x, y, z), atol=1e-12)


def turn(axis: np.ndarray, angle: float) -> np.ndarray:
    """Rodrigues' formula."""
    x, y, z = axis / np.linalg.norm(axis)
    cross = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]])
    return np.eye(3) + math.sin(angle) * cross + (1 - math.cos(angle)) * cross @ cross


def rpy(roll: float, pitch: float, yaw: float) -> np.ndarray:
    x, y, z = np.eye(3)
    return turn(z, yaw) @ turn(y, pitch) @ turn(x, roll)


@pytest.mark.parametrize("axis", [(1, 2, 2), (0, 0, -1), (-3, 0, 0), (0.2, -0.7, 0.1), (0, -1, 0)])
@pytest.mark.parametrize("kind", ["revolute", "continuous", "prismatic"])
def test_axes_of_any_direction(kind, axis, imported):
    """The frame is moved by the origin, then about or along the axis there."""
    limit = "" if kind == "continuous" else LIMIT
    origin = '<origin xyz="0.1 -0.2 0.3" rpy="0.3 -0.4 0.5"/>'
    end = joint("fixed", '<origin xyz="0.5 0.25 -0.125"/>', name="e", parent="b", child="t")
    text = robot(
        link("a"), link("b"), '<link name="t"/>',
        joint(kind, origin + limit, axis=" ".join(map(str, axis))), end,
    )  # fmt: skip
    found = imported(text, exact=True)
    quiet(found.text)
    value = 0.7
    (tip,) = only_robot(imported.folder / "r.srg").effectors([value])
    direction = np.array(axis) / np.linalg.norm(axis)
    moved = np.array([0.5, 0.25, -0.125])
    slid, turned = moved + direction * value, turn(direction, value) @ moved
    moved = slid if kind == "prismatic" else turned
    expected = np.array([0.1, -0.2, 0.3]) + rpy(0.3, -0.4, 0.5) @ moved
    np.testing.assert_allclose(tip, expected, atol=1e-11)


def test_a_planar_joint_shifts_and_turns(imported):
    text = robot(link("a"), link("b"), joint("planar", axis="0 1 0"))
    found = imported(text)
    assert "planar" in found.remarks[0]
    kinds = only_robot(imported.folder / "r.srg").dofs
    assert kinds == ("prismatic", "prismatic", "revolute")


def test_a_mimic_joint_is_held_where_its_leader_is(imported):
    mimic = LIMIT + '<mimic joint="j" multiplier="2" offset="0.25"/>'
    text = robot(
        link("a"), link("b"), link("c"),
        joint("revolute", LIMIT),
        joint("prismatic", mimic, name="k", parent="b", child="c", axis="1 0 0"),
    )  # fmt: skip
    found = imported(text, fixed=["j=0.5"])
    # Both stand: the follower at 2 * 0.5 + 0.25.
    assert any("`k` mimics `j` and is held at 1.25 m" in remark for remark in found.remarks)
    found = imported(text)
    (tip,) = only_robot(imported.folder / "r.srg").effectors([0.0])
    np.testing.assert_allclose(tip, (0.25, 0, 0), atol=1e-12)


def test_noise_is_rounded_unless_it_is_to_be_kept(imported):
    origin = '<origin xyz="1e-17 0.1 4e-8" rpy="1.5708 0 0"/>'
    text = robot(link("a"), link("b"), joint("revolute", origin + LIMIT))
    found = imported(text)
    assert "frame out = in * move(y, 100 mm) * rot(x, 90 deg);" in found.text
    assert any("rounded" in remark for remark in found.remarks)
    assert any("1 length below 1 um" in remark for remark in found.remarks)
    kept = imported(text, exact=True)
    assert "rot(x, 1.5708 rad)" in kept.text
    assert "0.00004) mm" in kept.text
    assert kept.remarks == ()


def test_masses_of_shapes(imported):
    """A box and a sphere of one density: Steiner by hand."""
    box = '<collision><geometry><box size="0.3 0.2 0.1"/></geometry></collision>'
    ball = (
        '<collision><origin xyz="0 0 0.5"/><geometry><sphere radius="0.1"/></geometry></collision>'
    )
    text = robot(link("a"), f'<link name="b">{box}{ball}</link>', joint("revolute", LIMIT))
    with pytest.raises(
        UsageFault, match=r"r\.urdf:4:1: error\[SRG0803\]: joint `j` moves links without any"
    ):
        imported(text)
    found = imported(text, density=1000.0)
    mass, ball_mass = 6.0, 4 / 3 * math.pi * 1e-3 * 1000
    whole = mass + ball_mass
    centre = ball_mass * 0.5 / whole
    pattern = r"solid\(frame: turned, mass: ([\d.]+) kg, com: \(0, 0, ([\d.]+)\) mm"
    known = re.search(pattern, found.text)
    assert known is not None
    assert float(known[1]) == pytest.approx(whole, rel=1e-9)
    assert float(known[2]) == pytest.approx(1000 * centre, rel=1e-9)
    zz = mass * (0.09 + 0.04) / 12 + 0.4 * ball_mass * 0.01
    xx = (
        mass * (0.04 + 0.01) / 12 + mass * centre**2
        + 0.4 * ball_mass * 0.01 + ball_mass * (0.5 - centre) ** 2
    )  # fmt: skip
    numbers = re.findall(r"inertia: \(([^)]*)\)", found.text)[-1].split(", ")
    assert float(numbers[0]) == pytest.approx(xx, rel=1e-9)
    assert float(numbers[2]) == pytest.approx(zz, rel=1e-9)


def test_a_capsule(imported):
    """MuJoCo weighs the same one; its length is that between the centres of its half-balls."""
    import mujoco

    origin = '<origin xyz="0.1 0 0.2" rpy="0.5 0 0"/>'
    capsule = '<collision>{}<geometry><capsule radius="0.05" length="0.3"/></geometry></collision>'
    text = robot(
        link("a"), f'<link name="b">{capsule.format(origin)}</link>', joint("revolute", LIMIT)
    )
    found = imported(text, density=800.0)
    quiet(found.text)
    assert "capsule(" in found.text
    assert "length: 300 mm, radius: 50 mm" in found.text
    assert "cylinder" not in found.text
    model = mujoco.MjModel.from_xml_string(
        '<mujoco><worldbody><body><freejoint/><geom type="capsule" size="0.05 0.15" density="800"'
        "/></body></worldbody></mujoco>"
    )
    pattern = r"mass: (\S+) kg, com: \((.*?)\) mm,\s+inertia: \((.*?)\) kg\*m\^2"
    mass, centre, six = re.findall(pattern, found.text)[-1]
    assert float(mass) == pytest.approx(model.body_mass[1], rel=1e-9)
    assert [float(part) for part in centre.split(", ")] == [100, 0, 200]
    xx, yy, zz, xy, xz, yz = (float(part) for part in six.split(", "))
    moments = np.linalg.eigvalsh([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])
    known = np.sort(model.body_inertia[1])
    assert moments == pytest.approx(known, abs=1e-9 * known[-1])  # ten digits of each entry


def test_a_branch_has_a_tip_at_each_end(imported):
    text = robot(
        link("a"), link("b"), link("c"),
        joint("revolute", LIMIT + '<origin xyz="0 1 0"/>'),
        joint("revolute", LIMIT, name="k", child="c"),
    )  # fmt: skip
    found = imported(text)
    quiet(found.text)
    made = only_robot(imported.folder / "r.srg")
    assert len(made.dofs) == 2
    np.testing.assert_allclose(made.effectors([0.3, 0.2]), [(0, 1, 0), (0, 0, 0)], atol=1e-12)
    chosen = imported(text, effectors=["b"])
    assert chosen.text.count("effector(") == 1
    with pytest.raises(UsageFault, match=r"--effector bb: there is no link `bb`; did you mean `b`"):
        imported(text, effectors=["bb"])


def test_transmissions_are_gears(imported):
    gear = (
        '<transmission name="t"><joint name="j"/><actuator name="m">'
        "<mechanicalReduction>101</mechanicalReduction></actuator></transmission>"
    )
    dynamics = LIMIT + '<dynamics damping="0.5" friction="0.25"/>'
    found = imported(robot(link("a"), link("b"), joint("revolute", dynamics), gear))
    assert "drive q: gear 101 viscous 0.5 N*m*s coulomb 0.25 N*m;" in found.text
    quiet(found.text)


def test_a_module_with_ports(imported):
    text = robot(
        link("foot"), link("knee"), '<link name="left"/>', '<link name="right"/>',
        joint("revolute", LIMIT, parent="foot", child="knee"),
        joint("fixed", '<origin xyz="0.1 0 0"/>', name="l", parent="knee", child="left"),
        joint("fixed", '<origin xyz="0 0.2 0"/>', name="r", parent="knee", child="right"),
    )  # fmt: skip
    ports = ["in=foot:Flange50:male", "out=left:Flange50:female"]
    found = imported(text, module=True, ports=ports, name="elbow")
    quiet(found.text)
    assert "module Elbow {" in found.text
    assert "port in: Flange50 male;" in found.text
    assert "port out: Flange50 female;" in found.text
    assert "frame out = turned" not in found.text  # in a module, frames go by their links
    assert "frame out = knee * move(x, 100 mm);" in found.text
    usual = imported(text, module=True)
    assert "port left: Flange;" in usual.text
    assert "port right: Flange;" in usual.text


@pytest.mark.parametrize(
    ("ports", "says"),
    [
        (["in:foot"], r"--port in:foot: write NAME=LINK:TYPE"),
        (["in=knee:F"], r"--port in=knee: `in` is where a module stands"),
        (["out=nee:F"], r"there is no link `nee`; did you mean `knee`"),
        (["out=knee:F", "out=foot:F"], r"two ports of that name"),
    ],
)
def test_wrong_ports(ports, says, imported):
    text = robot(link("foot"), link("knee"), joint("revolute", LIMIT, parent="foot", child="knee"))
    with pytest.raises(UsageFault, match=says):
        imported(text, module=True, ports=ports)


def test_names_that_the_language_does_not_have(imported):
    text = robot(
        link("2nd link/über"), link("x"),
        joint("revolute", LIMIT, name="7", parent="2nd link/über", child="x"), name="// bad\n name",
    )  # fmt: skip
    quiet(imported(text).text)


def test_inertia_about_turned_axes_is_that_of_the_file(imported):
    turned = (
        '<inertial><origin xyz="0.1 0.2 0.3" rpy="0.4 0.5 0.6"/><mass value="2"/>'
        '<inertia ixx="0.1" iyy="0.2" izz="0.25" ixy="0.01" ixz="0" iyz="0"/></inertial>'
    )
    text = robot(link("a"), f'<link name="b">{turned}</link>', joint("continuous"))
    imported(text)
    made = only_robot(imported.folder / "r.srg")
    inertia = np.array([[0.1, 0.01, 0], [0.01, 0.2, 0], [0, 0, 0.25]])
    about_z = (rpy(0.4, 0.5, 0.6) @ inertia @ rpy(0.4, 0.5, 0.6).T)[2, 2] + 2 * (0.01 + 0.04)
    np.testing.assert_allclose(made.mass_matrix([0.3]), [[about_z]], rtol=1e-10)
