"""A robot in one pose: rods, joints, masses and effectors."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from math import radians

import numpy as np
from numpy.typing import NDArray

from compiler.robots.robot import RobotDof, RobotModel
from grammar_lang.constants import to_float
from srgc.render.drawn_robot import DrawnJoint, DrawnRobot, drawn_robot
from srgc.render.view import fitted

Array = NDArray[np.float64]

WIDTH = 320.0
MARGIN = 0.15
"""Metres around the robot at least."""
BENT = radians(35)
"""How far joints are turned in a pose that nobody has chosen, where their range allows it."""
SLID = 0.5
INK, ARM, JOINT, TOOL = "#1f2a44", "#6b7280", "#2e6fba", "#d1495b"


def drawing(model: RobotModel, theta: Sequence[Fraction], pose: Array | None = None) -> str:
    """The robot as SVG; ``pose`` are its coordinates (n,) in rad or m."""
    robot = drawn_robot(model, theta)
    q = np.array([_usual(dof) for dof in model.dofs]) if pose is None else pose
    points = robot.points(q[None, :])[0]
    corners = _corners(points, robot)
    view = fitted([corners]).scaled(WIDTH)
    flat = view.project(points)
    marks = "".join(_marks(robot, flat))
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{view.width:.0f}" '
        f'height="{view.height:.0f}" viewBox="0 0 {view.width:.0f} {view.height:.0f}">'
        f'<rect width="100%" height="100%" fill="#fff"/>{marks}</svg>'
    )


def _corners(points: Array, robot: DrawnRobot) -> Array:
    """What has to be seen: the points that are drawn, with a margin."""
    used = {0, *robot.effectors, *(joint.point for joint in robot.joints)}
    used |= {end for rod in robot.rods for end in rod.ends}
    used |= {mass.point for mass in robot.masses}
    seen = points[sorted(used)]
    return np.concatenate([seen - MARGIN, seen + MARGIN])


def _usual(dof: RobotDof) -> float:
    value = BENT if dof.kind == "revolute" else SLID
    if dof.range is None:
        return value
    return min(max(value, to_float(dof.range.lower)), to_float(dof.range.upper))


def _marks(robot: DrawnRobot, flat: Array) -> Iterator[str]:
    for tail, tip in robot.bones:
        yield _line(flat[tail], flat[tip], f'stroke="{ARM}" stroke-width="1.5"')
    for rod in robot.rods:
        first, last = rod.ends
        yield _line(flat[first], flat[last], f'stroke="{ARM}" stroke-width="6" stroke-opacity=".8"')
    for mass in robot.masses:
        yield _circle(flat[mass.point], 6, f'fill="{ARM}"')
    x, y = flat[0]
    yield f'<path d="M{x - 12:.1f} {y + 9:.1f}h24l-7 -9h-10z" fill="{INK}"/>'
    for joint in robot.joints:
        yield _joint(joint, flat[joint.point])
    for number, frame in enumerate(robot.effectors, 1):
        x, y = flat[frame]
        yield _circle(flat[frame], 4, f'fill="{TOOL}"')
        if len(robot.effectors) > 1:
            yield _label(f"e{number}", x + 7, y + 12, TOOL)


def _joint(joint: DrawnJoint, at: Array) -> str:
    x, y = at
    name = _label(f"q{joint.dof + 1}", x + 8, y - 7, JOINT)
    if joint.kind == "revolute":
        return _circle(at, 5, f'fill="#fff" stroke="{JOINT}" stroke-width="2"') + name
    box = f'<rect x="{x - 5:.1f}" y="{y - 5:.1f}" width="10" height="10" fill="#fff"'
    return f'{box} stroke="{JOINT}" stroke-width="2"/>{name}'


def _line(tail: Array, tip: Array, look: str) -> str:
    (a, b), (c, d) = tail, tip
    ends = f'x1="{a:.1f}" y1="{b:.1f}" x2="{c:.1f}" y2="{d:.1f}"'
    return f'<line {ends} stroke-linecap="round" {look}/>'


def _circle(at: Array, radius: float, look: str) -> str:
    return f'<circle cx="{at[0]:.1f}" cy="{at[1]:.1f}" r="{radius:g}" {look}/>'


def _label(content: str, x: float, y: float, colour: str) -> str:
    look = f'font-family="sans-serif" font-size="12" fill="{colour}"'
    return f'<text x="{x:.1f}" y="{y:.1f}" {look}>{content}</text>'
