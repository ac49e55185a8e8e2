"""Write rotors and acceleration limits of joints, which URDF cannot express, to a separate file.

The file is JSON, and thus also YAML.  Its ``joint_limits`` have the form of MoveIt's file of that
name, which extends or replaces what a URDF says of joints.  Its ``drives`` have for each joint the
values that libraries of dynamics keep in arrays.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterator, Mapping

from srgc.exports.exported_robot import ExportedRobot, Motor
from srgc.exports.xml_lines import plain_line
from srgc.joint_format import FORMAT

UNSAID = (
    "URDF has no place for rotors and limits of accelerations; "
    "name a file with -o, and a file beside it has them"
)


def joints_json(robot: ExportedRobot) -> str:
    """The document in SI units, with a line for each joint; empty if the URDF says everything.

    Keys are the names of joints in the URDF.  The velocity limit is the larger of two bounds, as in
    the URDF.
    """
    if not any(each.armature or each.acceleration is not None for each in robot.drives):
        return ""
    about = [plain_line(remark) for remark in robot.remarks]
    parts = [f' "format": {_text(FORMAT)}', f' "about": {_text(about)}']
    for key, entries in (("joint_limits", moveit_limits), ("drives", _drive)):
        rows = [f"  {_text(motor.name)}: {_row(dict(entries(motor)))}" for motor in robot.motors()]
        parts.append(f' "{key}": {{\n' + ",\n".join(rows) + "\n }")
    return "{\n" + ",\n".join(parts) + "\n}\n"


def moveit_limits(motor: Motor) -> Iterator[tuple[str, float]]:
    """The limits of rates and accelerations in MoveIt's terms, all of them explicit.

    Without them MoveIt would take some velocity limit from the URDF.
    """
    rate, most = motor.joint.rate, motor.drive.acceleration
    yield "has_velocity_limits", rate is not None
    if rate is not None:
        yield "max_velocity", max(abs(end) for end in rate)
    yield "has_acceleration_limits", most is not None
    if most is not None:
        yield "max_acceleration", most


def _drive(motor: Motor) -> Iterator[tuple[str, float]]:
    drive = motor.drive
    yield "armature", drive.armature
    yield "damping", drive.damping
    yield "friction", drive.friction


def _row(entries: Mapping[str, float]) -> str:
    return "{" + ", ".join(f"{_text(key)}: {_number(entries[key])}" for key in entries) + "}"


def _number(value: float) -> str:
    """A double or truth value that JSON and YAML 1.1 read alike: in YAML 1e-05 would be a text."""
    return re.sub(r"^(-?\d+)e", r"\1.0e", _text(value))


def _text(value: object) -> str:
    return json.dumps(value, ensure_ascii=False, allow_nan=False)
