"""What URDF does not have is told where it stands, or refused where it says another robot."""

from __future__ import annotations

import re
from pathlib import Path

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import srgc
from srgc.cli import run
from srgc.faults import UsageFault
from srgc.imports.urdf.urdf_import import urdf_import
from srgc.imports.written_import import Imported
from tests.oracles.urdf_files import LIMIT, joint, link, robot

A, B, C = link("a"), link("b"), link("c")
J = joint("revolute", LIMIT)
INERTIAL = '<inertial><mass value="1"/><inertia ixx="1" iyy="1" izz="1"/></inertial>'


def imported(folder: Path, *parts: str, name: str = "r.urdf", **options: object) -> Imported:
    text = robot(*parts) if len(parts) != 1 else parts[0]
    (folder / name).write_text(text, encoding="utf-8")
    return urdf_import(folder / name, **options)  # type: ignore[arg-type]


TOLD = {
    "in a link": ([link("a", more="<contact/>\n<contact/>"), B, J],
                  r":2:\d+: warning\[SRG0804\]: <contact> in <link> is left out, also in line 3\n"),
    "misspelt": ([link("a", more="\n<colision/>"), B, J],
                 r":3:1: warning\[SRG0804\]: <colision> (?s:.*)did you mean `collision`\?"),
    "in a joint": ([A, B, joint("revolute", LIMIT + "\n<sensor/>")],
                   r":5:1: warning\[SRG0804\]: <sensor> in <joint>"),
    "in a robot": ([A, B, J, "<group/>"], r":5:1: warning\[SRG0804\]: <group> in <robot>"),
    "in a collision": (
        [link("a", more='<collision>\n<mu/><geometry><sphere radius="1"/></geometry></collision>'),
         B, J], r":3:1: warning\[SRG0804\]: <mu> in <collision>",
    ),
    "an attribute": (
        [A, B, joint("revolute", LIMIT.replace("/>", '\n acceleration="3"/>'))],
        r":5:2: warning\[SRG0804\]: `acceleration` of <limit> is left out\n.*\n.*\^{16}$",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", TOLD)
def test_it_is_told_where_it_stands(name: str, tmp_path: Path) -> None:
    parts, says = TOLD[name]
    found = imported(tmp_path, *parts)
    (warning,) = found.warnings
    assert re.search(says, warning.finding() + "\n", re.MULTILINE)
    assert f"// - r.urdf:{re.match(r':(.):', says.replace(chr(92), ''))[1]}: " in found.text  # type: ignore[index]


def test_it_is_printed_and_the_spec_is_written(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("r.urdf").write_text(robot(A, B, J, "<group/>"), encoding="utf-8")
    assert run(["import", "urdf", "r.urdf"]) == 0
    out, err = capsys.readouterr()
    assert out == "r.srg\n"
    assert err == (
        "r.urdf:5:1: warning[SRG0804]: <group> in <robot> is left out\n"
        "    5 | <group/>\n      | ^^^^^^\n"
    )


ORIGIN = '<origin xyz="1 2 3" {}/>'
WRONG = {
    "two inertials": (robot(A, f'<link name="b">\n{INERTIAL}\n{INERTIAL}</link>', J),
                      r":5:1: .*a second <inertial> in one <link>"),
    "two axes": (robot(A, B, joint("revolute", LIMIT + '\n<axis xyz="1 0 0"/>')),
                 r":5:1: .*a second <axis> in one <joint>"),
    "an element in capitals": (robot(A, B, joint("revolute", "\n<Limit/>")),
                               r":5:1: .*<Limit> is not <limit>"),
    "a link in capitals": (robot(A, B, J, '<LINK name="c"/>'), r":5:1: .*<LINK> is not <link>"),
    "an attribute in capitals": (
        robot(A, B, joint("revolute", LIMIT.replace("lower", "\nLower"))),
        r":5:1: .*`Lower` of <limit> is not `lower`",
    ),
    "an origin that says more": (
        robot(A, B, joint("revolute", LIMIT + ORIGIN.format('\nwxyz="1 0 0 0"'))),
        r":5:1: .*`wxyz` of <origin> is not read",
    ),
    "two rotations": (
        robot(A, B, joint("fixed", ORIGIN.format('rpy="0 0 0" quat_xyzw="0 0 0 1"'))),
        r":4:\d+: .*both `rpy` and `quat_xyzw`",
    ),
    "no rotation": (
        robot(A, B, joint("fixed", ORIGIN.format('\nquat_xyzw="0 0 0 0"'))),
        r":5:1: .*`quat_xyzw` has the length 0",
    ),
    "xacro": (
        robot(A, B, J, '<xacro:m xmlns:xacro="http://www.ros.org/wiki/xacro"/>'),
        r":5:1: .*<xacro:m> is no URDF(?s:.*)end in \.xacro",
    ),
    "parts of numbers": (
        robot(A, B, joint("fixed", '<origin xyz="1_0 0 0"/>')), r":4:\d+: .*`xyz` is `1_0 0 0`",
    ),
    "a joint that mimics itself": (
        robot(A, B, joint("revolute", LIMIT + '<mimic joint="j"/>')),
        r":4:1: .*joint `j` mimics `j`, and so itself",
    ),
    "joints that mimic each other": (
        robot(A, B, C, joint("revolute", LIMIT + '<mimic joint="k"/>'),
              joint("revolute", LIMIT + '<mimic joint="j"/>', name="k", parent="b", child="c")),
        r":6:1: .*joint `k` mimics `j`, and so itself",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", WRONG)
def test_what_would_be_another_robot_is_refused(name: str, tmp_path: Path) -> None:
    text, says = WRONG[name]
    with pytest.raises(UsageFault) as caught:
        imported(tmp_path, text)
    assert re.search(rf"r\.urdf{says}", str(caught.value))
    assert "error[SRG0803]" in str(caught.value)


def test_what_is_known_is_not_told(tmp_path: Path) -> None:
    look = '<visual name="v"><geometry><box size="1 1 1"/></geometry><material name="m"/></visual>'
    soft = '<calibration rising="0.1"/><safety_controller k_velocity="1"/>'
    found = imported(
        tmp_path, '<material name="m"><color rgba="1 0 0 1"/></material>', link("a", more=look), B,
        joint("revolute", LIMIT + soft), '<gazebo><plugin name="p" filename="f"/></gazebo>',
    )  # fmt: skip
    assert found.warnings == ()
    assert any("calibrations of 1 joint" in remark for remark in found.remarks)
    assert any("1 <gazebo>, which does not describe the body" in remark for remark in found.remarks)


@pytest.mark.parametrize("four", [(0.1, 0.2, 0.3, 0.9273618), (0, 0, 1, 0), (0.5, 0.5, -0.5, 0.5)])
def test_quaternions_are_those_of_scipy(four: tuple[float, ...], tmp_path: Path) -> None:
    said = f'<origin xyz="1 2 3" quat_xyzw="{" ".join(map(str, four))}"/>'
    end = joint("fixed", '<origin xyz="0.5 0.25 -0.125"/>', name="e", parent="b", child="t")
    parts = (A, B, '<link name="t"/>', joint("prismatic", said + LIMIT, axis="0 0 1"), end)
    program = srgc.load(text=imported(tmp_path, *parts, exact=True).text)
    (word,) = srgc.words(program, limit=2)
    (tip,) = srgc.robot(program, word).effectors([0.5])
    due = np.array([1, 2, 3]) + Rotation.from_quat(four).apply([0.5, 0.25, -0.125 + 0.5])
    np.testing.assert_allclose(tip, due, atol=1e-12)


def test_a_default_namespace_is_none(tmp_path: Path) -> None:
    """Files for Drake have one, with the place of a schema."""
    spaces = (
        '<robot xmlns="http://drake.mit.edu" xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"'
        ' xsi:schemaLocation="http://drake.mit.edu ../x.xsd"'
    )
    plain = robot(A, B, J)
    found = imported(tmp_path, plain.replace("<robot", spaces))
    assert (found.warnings, found.text) == ((), imported(tmp_path, plain).text)


def test_a_chain_of_mimic_joints(tmp_path: Path) -> None:
    """With the first at 0.25: k = -0.25 + 0.5, l = 2 k + 0.1."""
    k, m = ('<mimic joint="j" multiplier="-1" offset="0.5"/>',
            '<mimic joint="k" multiplier="2" offset="0.1"/>')  # fmt: skip
    parts = (
        A, B, C, link("d"), J, joint("revolute", LIMIT + m, name="l", parent="c", child="d"),
        joint("revolute", LIMIT + k, name="k", parent="b", child="c"),
    )  # fmt: skip
    for fixed, due in (([], (0.5, 1.1)), (["j=0.25"], (0.25, 0.6))):
        told = " ".join(imported(tmp_path, *parts, fixed=fixed).remarks)
        for name, leader, value in zip("kl", "jk", due, strict=True):
            assert f"joint `{name}` mimics `{leader}` and is held at {value:g} rad:" in told


def test_what_planar_and_continuous_joints_lose_is_told(tmp_path: Path) -> None:
    found = imported(tmp_path, A, B, joint("planar", LIMIT + '<dynamics damping="1"/>'))
    assert any("; <limit> and <dynamics> are left out" in each for each in found.remarks)
    found = imported(tmp_path, A, B, joint("continuous", LIMIT))
    assert found.remarks == ("joint `j` is continuous: its range from -1 to 1.5 is left out",)


@pytest.mark.parametrize("kind", ["fixed", "floating", "planar"])
def test_one_number_does_not_hold_such_a_joint(kind: str, tmp_path: Path) -> None:
    with pytest.raises(UsageFault, match=rf"--fix j=1: joint `j` is {kind}"):
        imported(tmp_path, A, B, joint(kind), fixed=["j=1"])
    imported(tmp_path, A, B, joint(kind), fixed=["j"])


TIP = ('<link name="t"/>', joint("fixed", name="f", parent="b", child="t"))


def test_ports_without_an_input(tmp_path: Path) -> None:
    with pytest.raises(UsageFault, match=r"none is called `in`.*; add --port in=a:Flange$"):
        imported(tmp_path, A, B, J, *TIP, module=True, ports=["out=t:F"])
    with pytest.raises(UsageFault, match=r"`base` is at the root link: call it `in`$"):
        imported(tmp_path, A, B, J, *TIP, module=True, ports=["base=a:F", "out=t:F"])
    found = imported(tmp_path, A, B, joint("fixed"), *TIP, module=True, ports=["out=t:F"])
    assert "role base;" in found.text
    assert any("this is a base, which no module carries" in each for each in found.remarks)


def test_arguments_of_what_is_no_xacro(tmp_path: Path) -> None:
    with pytest.raises(UsageFault, match=r"--arg goes with xacro"):
        imported(tmp_path, A, B, J, arguments=["a:=1"])


XACRO = (
    '<robot name="r" xmlns:xacro="http://www.ros.org/wiki/xacro"><xacro:arg name="side" '
    f'default="l"/><xacro:arg name="mass" default="2"/>{A}<link name="$(arg child)"/></robot>'
)


@pytest.mark.slow
def test_arguments_that_a_xacro_does_not_have(tmp_path: Path) -> None:
    """One that is read and never declared is one of its arguments."""
    given = ["child:=b"]
    with pytest.raises(UsageFault, match=r"--arg mas:=3: .*; it has `mass`, `side`, `child`$"):
        imported(tmp_path, XACRO, name="r.xacro", arguments=[*given, "mas:=3"])
    with pytest.raises(UsageFault, match=r"`mass` is given twice"):
        imported(tmp_path, XACRO, name="r.xacro", arguments=["mass:=1", "mass:=3"])
