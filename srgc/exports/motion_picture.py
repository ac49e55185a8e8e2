"""Draw a motion as an animated SVG that any browser plays, without scripts.

Each instant is a separate drawing, which SMIL shows while it lasts (W3C, SVG 1.1, chapter 19), so
the animation looks exactly like still pictures.
"""

from __future__ import annotations

from math import ceil

import numpy as np

from compiler.arrays import Array
from compiler.tasks.obstacle_pieces import expanded
from compiler.workspaces.map_header import MapFault
from srgc.exports.scenes.fine_instants import FineInstants, fine_instants
from srgc.faults import UsageFault
from srgc.render.html_text import number
from srgc.render.region_names import name_boxes, shape_names
from srgc.render.robot_drawing import DrawnRobot, drawn_robot, pose_marks
from srgc.render.svg import View, clipped, document, fitted, label, line_path, moved
from srgc.render.workspace_drawing import (
    AXES_ROOM,
    plane_axes,
    shape_marks,
    triad,
    workspace_shapes,
)
from srgc.results.found_design import FoundDesign

PER_SECOND, FEWEST, MOST = 20, 24, 90
"""Drawings per second of the motion, and their least and greatest number."""
LARGEST, LEAST = 120_000, 12
"""The most characters of all drawings; if each is long there are fewer, down to the second."""
ENTRY = 300
"""The characters of a drawing besides its marks."""
REST = 1.0
"""How long the last drawing stays before the motion begins again (s)."""
CLOCK = (90.0, 22.0)
"""The width and height of the time in the corner."""
FINE = 200
"""The number of points on the path of an effector."""


def motion_picture(design: FoundDesign) -> str:
    """The robot of a design moving among regions, as SVG; three-dimensional scenes are oblique.

    Raises:
        UsageFault: a map cannot be read, or numbers are too large.
    """
    try:
        program, task = expanded(design.program, design.task)
    except (MapFault, ValueError) as error:
        raise UsageFault(str(error)) from None
    workspace = program.workspaces[task.workspace]
    shapes = workspace_shapes(workspace, ())
    motion = fine_instants(design, PER_SECOND)
    end = float(motion.times[-1])
    count = int(np.clip(ceil(end * PER_SECOND), FEWEST, MOST))
    times = np.linspace(0, end, count + 1)
    robot = drawn_robot(design.model, design.theta)
    poses = _points(robot, motion, times)
    own = robot.own(poses)
    view = fitted([shapes[0].corners, own.reshape(-1, own.shape[-1])], turning=False)
    boxes = np.concatenate([name_boxes(shapes, view), _clock_box(view)])
    room = LARGEST // (len(pose_marks(robot, poses[0], view)) + ENTRY)
    if room < count:
        times = np.linspace(0, end, max(room, LEAST) + 1)
        poses = _points(robot, motion, times)
    plane = workspace.dimension == 2
    marks = (plane_axes(view) if plane else triad(view)) + clipped(
        view.width, view.height, shape_marks(shapes, view)
    )
    marks += "".join(
        f'<path class="trace" d="{line_path(view.project(line))}"/>'
        for line in _lines(robot, motion, end)
    )
    marks += _frames(robot, poses, times, view, boxes) + shape_names(shapes, view)
    left, below = AXES_ROOM if plane else (0.0, 0.0)
    return document(
        moved(left, 0, marks),
        (left + view.width, view.height + below),
        "scene" if plane else "scene space",
        f"{task.name}: robot {' '.join(design.derivation.word)}",
    )


def _points(robot: DrawnRobot, motion: FineInstants, times: Array) -> Array:
    """All points of the robot (K, points, d) at times (K,)."""
    return robot.points(np.concatenate([motion.at(float(time)) for time in times]))


def _lines(robot: DrawnRobot, motion: FineInstants, end: float) -> list[Array]:
    """The paths of the effectors, each (K, d)."""
    points = _points(robot, motion, np.linspace(0, end, FINE))
    return [points[:, effector] for effector in robot.effectors]


def _clock_box(view: View) -> Array:
    """The corner with the time, as a rectangle (1, 4)."""
    return np.array([[view.width - 8 - CLOCK[0], 0.0, view.width - 8, CLOCK[1]]])


def _frames(robot: DrawnRobot, poses: Array, times: Array, view: View, boxes: Array) -> str:
    """A drawing for each instant, shown one at a time; the last one stays for a while.

    The numbers of effectors keep off the rectangles ``boxes`` (m, 4).
    """
    step, whole = float(times[1]), float(times[-1]) + REST
    found = []
    for index, (points, time) in enumerate(zip(poses, times, strict=True)):
        last = index == len(times) - 1
        begin, stop = index * step / whole, (index + 1) * step / whole
        says = (
            "visible;hidden"
            if index == 0
            else "hidden;visible"
            if last
            else "hidden;visible;hidden"
        )
        keys = [0.0, *([begin] if index else []), *([] if last else [stop])]
        play = (
            f'<animate attributeName="visibility" values="{says}" calcMode="discrete" '
            f'keyTimes="{";".join(f"{key:.4f}".rstrip("0").rstrip(".") for key in keys)}" '
            f'dur="{number(whole)}s" repeatCount="indefinite"/>'
        )
        # A viewer without animations shows the end of the motion.
        shown = "visible" if last else "hidden"
        clock = label(view.width - 8, 16, "end", f"{time:.2f} s")
        found.append(
            f'<g class="robot" visibility="{shown}">{play}'
            f"{pose_marks(robot, points, view, boxes)}{clock}</g>"
        )
    return "".join(found)
