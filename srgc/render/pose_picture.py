"""The picture of a robot alone in one pose, with the names of its coordinates."""

from __future__ import annotations

from math import radians

import numpy as np

from compiler.arrays import Array
from compiler.robots.robot import RobotDof, RobotModel
from grammar_lang.ir.constants import to_float
from srgc.render.region_names import NAME_SIZE
from srgc.render.robot_drawing import DrawnJoint, drawn_robot, pose_marks
from srgc.render.svg import document, fitted, label
from srgc.render.text_size import block_size

PICTURE = 320.0
"""The width of the picture."""
AROUND = 0.15
"""The least margin around the robot, in metres."""
BENT, SLID = radians(35), 0.5
"""Angles and lengths of joints in a default pose."""


def pose_picture(model: RobotModel, theta: Array, pose: Array | None = None) -> str:
    """A robot alone in one pose, as a file; its joints are labelled with their coordinates.

    Args:
        model: the robot.
        theta: the values of its parameters, in SI units.
        pose: its coordinates (n,) in rad or m; by default a pose with bent joints.
    """
    robot = drawn_robot(model, theta)
    q = np.array([_usual(dof) for dof in model.dofs]) if pose is None else pose
    points = robot.points(q[None, :])[0]
    own = robot.own(points)
    view = fitted([own - AROUND, own + AROUND], turning=False).scaled(PICTURE)
    seen = view.project(points)
    names = "".join(label(*_beside(seen, joint), "start", _name(joint)) for joint in robot.joints)
    kind = "scene space" if model.dimension == 3 else "scene"
    boxes = [_name_box(seen, joint) for joint in robot.joints]
    taken = np.array(boxes).reshape(-1, 4)
    marks = f"{pose_marks(robot, points, view, taken)}<g>{names}</g>"
    return document(marks, (view.width, view.height), kind, "")


def _name(joint: DrawnJoint) -> str:
    return f"q{joint.dof + 1}"


def _beside(seen: Array, joint: DrawnJoint) -> tuple[float, float]:
    """Where the name of a joint begins."""
    x, y = seen[joint.point]
    return float(x) + 9, float(y) - 9


def _name_box(seen: Array, joint: DrawnJoint) -> tuple[float, float, float, float]:
    x, y = _beside(seen, joint)
    across, up = block_size([_name(joint)], NAME_SIZE, bold=True)
    return x, y - up, x + across, y


def _usual(dof: RobotDof) -> float:
    """The coordinate of a joint in the default pose, within its range."""
    value = BENT if dof.kind == "revolute" else SLID
    if dof.range is None:
        return value
    return min(max(value, to_float(dof.range.lower)), to_float(dof.range.upper))
