"""Gears from transmissions, and rotors from the file beside a URDF; numbers by hand."""

from __future__ import annotations

import json
import math
import re
import xml.etree.ElementTree as ET
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

import srgc as public
from srgc.faults import UsageFault
from srgc.imports.urdf.urdf_import import urdf_import
from srgc.imports.written_import import Imported
from tests.oracles import geared_arm as arm
from tests.oracles.urdf_files import LIMIT, joint, link, robot
from tests.srgc.conftest import Ran

A, B = link("a"), link("b")
J = joint("revolute", LIMIT)


def simple(reduction: str, name: str = "t", of: str = "j") -> str:
    return (
        f'<transmission name="{name}"><type>transmission_interface/SimpleTransmission</type>'
        f'<joint name="{of}"/><actuator name="m">'
        f"<mechanicalReduction>{reduction}</mechanicalReduction></actuator></transmission>"
    )


def controlled(kind: str, *joints: tuple[str, str], actuator: str = "") -> str:
    """A transmission as control.ros.org has it: joints with their reductions."""
    parts = "".join(
        f'<joint name="{name}" role="joint{number}">'
        f"<mechanical_reduction>{reduction}</mechanical_reduction><offset>0.5</offset></joint>"
        for number, (name, reduction) in enumerate(joints, 1)
    )
    motor = f'<actuator name="m" role="actuator1">{actuator}</actuator>'
    return (
        '<ros2_control name="s" type="system"><hardware><plugin>a/B</plugin></hardware>'
        f'<joint name="j"><command_interface name="effort"/></joint><transmission name="t">'
        f"<plugin>transmission_interface/{kind}</plugin>{motor}{parts}</transmission>"
        "</ros2_control>"
    )


def imported(folder: Path, *parts: str) -> Imported:
    (folder / "r.urdf").write_text(robot(*parts))
    return urdf_import(folder / "r.urdf")


def told(found: Imported) -> list[str]:
    return [warning.finding() for warning in found.warnings]


GEARS = {
    "beside": (simple("325.949"), 325.949),
    "in ros2_control": (controlled("SimpleTransmission", ("j", "325.949")), 325.949),
    "the joint's counts there": (
        controlled("SimpleTransmission", ("j", "50"),
                   actuator="<mechanical_reduction>50</mechanical_reduction>"), 50,
    ),
    "twice the same": (simple("50") + simple("50", "u"), 50),
    "1 says nothing": (simple("1"), None),
}  # fmt: skip


def test_other_parts_of_an_actuator_are_told(tmp_path: Path) -> None:
    """Drake's rotor is read by Drake alone."""
    drake = '<drake:rotor_inertia xmlns:drake="http://drake.mit.edu" value="1e-4"/>'
    part = simple("50").replace(
        "</actuator>", f"{drake}<hardwareInterface>e</hardwareInterface></actuator>"
    )
    found = imported(tmp_path, A, B, J, part)
    (said,) = told(found)
    assert "<drake:rotor_inertia> in <actuator> is left out" in said
    assert re.search(r"drive q: gear 50;", found.text)


@pytest.mark.parametrize("name", GEARS)
def test_the_gear_of_a_transmission(name: str, tmp_path: Path) -> None:
    part, gear = GEARS[name]
    found = imported(tmp_path, A, B, J, part)
    assert told(found) == []
    said = re.search(r"drive q: gear (\S+);", found.text)
    assert (None if said is None else float(said[1])) == gear


TOLD = {
    "below 0": (simple("-100"), 100, r":5:\d+: warning\[SRG0804\]: the motor of joint `j` turns"),
    "two of a joint": (
        simple("50") + "\n" + simple("80", "u"), 50,
        r":6:\d+: warning\[SRG0804\]: joint `j` has a reduction already, 50 in line 5: 80 is left",
    ),
    "two in one": (
        controlled("SimpleTransmission", ("j", "50"),
                   actuator="<mechanical_reduction>80</mechanical_reduction>"), 50,
        r":5:\d+: warning\[SRG0804\]: another reduction of joint `j`, 80, is left out: 50 is taken",
    ),
    "0": (simple("0"), None, r":5:\d+: warning\[SRG0804\]: the reduction of joint `j` is 0"),
    "a joint that is none": (
        simple("9", of="J"), None, r":5:1: .* there is no joint `J`(?s:.*)did you mean `j`\?",
    ),
    "a differential": (
        controlled("DifferentialTransmission", ("j", "2"), ("k", "2")), None,
        r":5:\d+: .*`t` \(DifferentialTransmission\) is not the gear of one joint.*`j`, `k`",
    ),
    "a linkage": (
        controlled("FourBarLinkageTransmission", ("j", "2")), None,
        r":5:\d+: .*`t` \(FourBarLinkageTransmission\) is not the gear of one joint",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", TOLD)
def test_what_is_left_out_of_transmissions_is_told(name: str, tmp_path: Path) -> None:
    part, gear, says = TOLD[name]
    found = imported(tmp_path, A, B, J, part)
    (warning,) = told(found)
    assert re.search(says, warning)
    assert (f"gear {gear}" if gear else "gear") in found.text or not gear
    assert ("drive" in found.text) == (gear is not None)
    (message,) = (each.message for each in found.warnings)
    assert f"- r.urdf:{6 if name == 'two of a joint' else 5}: {message}"[:60] in found.text


def test_a_reduction_that_is_no_number(tmp_path: Path) -> None:
    with pytest.raises(UsageFault, match=r":5:\d+: error.*`mechanical_reduction` is `ten`"):
        imported(tmp_path, A, B, J, controlled("SimpleTransmission", ("j", "ten")))


# --- The file beside a URDF -----------------------------------------------------------------------


def beside(folder: Path, drive: dict[str, float], name: str = "j") -> None:
    document = {
        "format": "srgc joints 1",
        "joint_limits": {name: {"max_acceleration": 6.0}},
        "drives": {name: {"armature": 0.0, "damping": 0.0, "friction": 0.0, **drive}},
    }
    (folder / "r.joints.json").write_text(json.dumps(document, indent=1))


def test_a_spindle_has_its_rotor_back(tmp_path: Path) -> None:
    """A lead of 5 mm: 2 pi / 0.005 rad/m; the joint feels the square of that times the rotor."""
    gear = 2 * math.pi / 0.005
    beside(tmp_path, {"armature": gear**2 * 1e-5})
    found = imported(tmp_path, A, B, joint("prismatic", LIMIT), simple(repr(gear)))
    assert "accel <= 6 m/s^2 effort <= 5 N named" in " ".join(found.text.split())
    said = re.search(r"drive s: gear (\S+) m\^-1 rotor (\S+) kg\*m\^2;", found.text)
    assert said is not None
    assert float(said[1]) == pytest.approx(gear, rel=1e-9)  # ten digits are written
    assert float(said[2]) == 1e-5
    assert "// Rotors and limits of accelerations are those of r.joints.json." in found.text
    assert found.remarks == ()


def test_a_rotor_without_a_gear(tmp_path: Path) -> None:
    beside(tmp_path, {"armature": 0.25})
    assert "drive q: rotor 0.25 kg*m^2;" in imported(tmp_path, A, B, J).text
    found = imported(tmp_path, A, B, joint("prismatic", LIMIT))
    assert "drive s: gear 1 m^-1 rotor 0.25 kg*m^2;" in found.text


def test_friction_that_differs_is_that_of_the_urdf(tmp_path: Path) -> None:
    beside(tmp_path, {"friction": 0.5})
    found = imported(tmp_path, A, B, J)
    (remark,) = found.remarks
    assert remark.startswith("joint `j` has the friction 0 in the URDF and 0.5 in the file beside")


def test_a_file_of_another_robot(tmp_path: Path) -> None:
    beside(tmp_path, {"armature": 1}, "jj")
    with pytest.raises(UsageFault, match=r"r\.joints\.json:\d+:\d+: .*r\.urdf has no such joint"):
        imported(tmp_path, A, B, J)
    (tmp_path / "r.joints.json").write_text('{"joints": {"jj": 1}}')  # of another tool
    assert "rotor" not in imported(tmp_path, A, B, J).text


# --- Export and import ----------------------------------------------------------------------------


def test_what_was_exported_comes_back_with_its_drives(
    srgc: Callable[..., Ran], tmp_path: Path
) -> None:
    """Against the numbers of the spec, which were written by hand, and the armatures."""
    folder = arm.geared_arm(tmp_path / "out")
    urdf = tmp_path / "new" / "arm.urdf"
    assert srgc("export", folder, "--to", "urdf", "-o", urdf).status == 0
    ratios = [float(each.text or 0) for each in ET.parse(urdf).iter("mechanicalReduction")]
    assert ratios == [160, 160, 120, 1]
    assert "<!-- the rate is in [-1.25, 1.0], and URDF has one bound for both ways -->" in (
        urdf.read_text(encoding="utf-8")
    )
    back = urdf_import(urdf)
    assert back.warnings == ()
    drive = r"drive q: gear (\S+) rotor (\S+) kg\*m\^2 viscous (\S+) N\*m\*s coulomb (\S+) N\*m;"
    found = [tuple(map(float, each)) for each in re.findall(drive, back.text)]
    assert found == [(160, 5.23e-5, 14, 3.5)] * 2 + [(120, 0.375e-5, 6, 1.2)]
    assert " ".join(back.text.split()).count(
        "dof q: revolute z in [-170, 170] deg rate in [-1.25, 1.25] rad/s accel <= 2.5 rad/s^2 "
        "effort <= 75.5 N*m named"
    ) == 2  # fmt: skip
    program = public.load(text=back.text)
    (word,) = public.words(program, limit=2)
    mass = public.robot(program, word).mass_matrix([0.3, -0.2, 0.5, 0.1])
    plain = re.sub(r"gear \S+ rotor \S+ kg\*m\^2", "gear 7", back.text)
    program = public.load(text=plain)
    without = public.robot(program, word).mass_matrix([0.3, -0.2, 0.5, 0.1])
    np.testing.assert_allclose(np.array(mass) - without, np.diag(arm.ARMATURE), atol=1e-12)


def test_small_drives_and_masses_keep_their_digits(tmp_path: Path) -> None:
    """Ten digits, however small: 0.12 / 101**2 has more than twelve decimals, as the mass has."""
    dynamics = '<dynamics damping="0.000012345678912" friction="0.0000000345678912"/>'
    (tmp_path / "r.joints.json").write_text(
        json.dumps({
            "format": "srgc joints 1", "about": [], "joint_limits": {},
            "drives": {"j": {"armature": 0.12, "damping": 1.2345678912e-5,
                             "friction": 3.45678912e-8}},
        })
    )  # fmt: skip
    light = link("b", 0.000012345678912)
    found = imported(tmp_path, A, light, joint("revolute", LIMIT + dynamics), simple("101"))
    text = " ".join(found.text.split())
    said = dict(re.findall(r"(gear|rotor|viscous|coulomb|mass:) ([0-9.e-]+)", text))
    assert float(said["rotor"]) * 101**2 == pytest.approx(0.12, rel=1e-9)
    assert float(said["viscous"]) == pytest.approx(1.2345678912e-5, rel=1e-9)
    assert float(said["coulomb"]) == pytest.approx(3.45678912e-8, rel=1e-9)
    assert "mass: 0.00001234567891 kg" in text
