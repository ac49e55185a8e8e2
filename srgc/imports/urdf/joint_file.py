"""Rotor inertias and acceleration limits from the file that ``srgc export`` writes with a URDF."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path

from srgc.imports.json_place import Place, json_file
from srgc.imports.source_files import SourceFiles
from srgc.imports.urdf.robot_model import UrdfRobot
from srgc.joint_format import FORMAT, SUFFIX


@dataclass(frozen=True, slots=True)
class DriveBeside:
    """Parameters of a joint's drive that a URDF cannot express; None if not given.

    ``armature`` is the inertia of its rotor at the joint (kg m^2, kg), ``acceleration`` the limit
    of its acceleration (rad/s^2, m/s^2).
    """

    armature: float | None
    acceleration: float | None


@dataclass(frozen=True, slots=True)
class JointFile:
    """The name of the file, and its drives by the names of joints."""

    name: str
    drives: Mapping[str, DriveBeside]


def joint_file(files: SourceFiles, robot: UrdfRobot, remarks: list[str]) -> JointFile | None:
    """Read the file next to a URDF; None if there is no file of our format.

    Friction is in both files; if they differ, the URDF is used, and a remark says so.

    Raises:
        SourceFault: the file is a link that leads elsewhere, is not JSON, names a joint that the
            robot does not have, or has an invalid number.
    """
    name = Path(files.main.name.removesuffix(".xacro")).stem + SUFFIX
    if not (files.folder / name).exists():
        return None
    files.path_of(name)
    place = json_file(replace(files, main=Path(files.main.parent / name)))
    if not isinstance(place.value, dict) or place.value.get("format") != FORMAT:
        return None
    limits, drives = place["joint_limits"], place["drives"]
    for joint, entry in (*limits.items(), *drives.items()):
        if joint not in robot.joints:
            raise entry.fault(f"{files.main.name} has no such joint")
    for joint, entry in drives.items():
        _compare(robot, joint, entry, remarks)
    found = {
        joint: DriveBeside(
            _above_zero(drives, joint, "armature"), _above_zero(limits, joint, "max_acceleration")
        )
        for joint in robot.joints
    }
    return JointFile(name, found)


def _above_zero(places: Place, joint: str, key: str) -> float | None:
    if joint not in places or key not in places[joint]:
        return None
    return places[joint][key].number(least=0.0) or None


def _compare(robot: UrdfRobot, joint: str, entry: Place, remarks: list[str]) -> None:
    dynamics = robot.joints[joint].dynamics
    for key in ("damping", "friction"):
        said = entry.get(key, 0.0).number(least=0.0)
        here = float(getattr(dynamics, key) or 0.0) if dynamics is not None else 0.0
        if said != here:
            remarks.append(
                f"joint `{joint}` has the {key} {here:g} in the URDF and {said:g} in the file "
                "beside it: that of the URDF is taken"
            )
