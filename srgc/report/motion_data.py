"""The data of the animation for the page's script, on a grid finer than the picture can show."""

from __future__ import annotations

from typing import Any

import numpy as np

from compiler.arrays import Array
from srgc.render.robot_drawing import THINNEST_CAPSULE
from srgc.render.svg import NAMED, View, sight
from srgc.report.motion_scene import MotionScene, RobotMotion, TubeBoxes

GRID = 0.04
"""The width of the grid, in units of the picture."""


def scene_data(scene: MotionScene) -> dict[str, Any]:
    """The data that the script needs.

    Coordinates are whole multiples of ``unit`` metres from ``centre``.  Spatial scenes have views,
    each with its name, azimuth and elevation.
    """
    grid = Grid(scene.view)
    view = scene.view
    data: dict[str, Any] = {
        "dimension": scene.dimension,
        "unit": grid.unit,
        "scale": view.scale,
        "width": view.width,
        "height": view.height,
        "axes": sight(*NAMED[0][1:]).tolist() if scene.dimension == 3 else view.axes.tolist(),
        "views": [list(named) for named in NAMED] if scene.dimension == 3 else [],
    }
    if scene.dimension == 3:
        data["shapes"] = [
            {"corners": grid.whole(shape.corners), "edges": np.ravel(shape.edges).tolist()}
            for shape in scene.shapes
        ]
    cells = [shape.name for shape in scene.shapes if shape.kind == "cell"]
    if scene.motion is not None:
        data["motion"] = motion_data(scene.motion, grid, cells, view)
    return data


class Grid:
    """Rounds points to the grid."""

    def __init__(self, view: View) -> None:
        self.centre = view.centre
        self.unit = GRID / view.scale

    def whole(self, points: Array) -> list[int]:
        """The coordinates of points (..., d), as whole numbers in one list."""
        found: list[int] = np.rint((points - self.centre) / self.unit).astype(int).ravel().tolist()
        return found


def motion_data(motion: RobotMotion, grid: Grid, cells: list[str], view: View) -> dict[str, Any]:
    """A motion for a script; ``cells`` are the names of the drawn cells, in order."""
    robot = motion.robot
    visits = [
        [[visit.since, cells.index(visit.cell) if visit.cell in cells else -1] for visit in each]
        for each in motion.visits
    ]
    return {
        "steps": motion.steps,
        "step": motion.step,
        "times": [_short(t) for t in motion.times],
        "q": [[_short(v) for v in row] for row in motion.q],
        "points": [grid.whole(row) for row in motion.points],
        "bones": [list(bone) for bone in robot.bones],
        "rods": [
            [*rod.ends, int(2 * (rod.radius or 0.0) * view.scale > THINNEST_CAPSULE)]
            for rod in robot.rods
        ],
        "joints": [[joint.point, -1 if joint.tip is None else joint.tip] for joint in robot.joints],
        "solids": [list(shape.corners) for shape in robot.shapes],
        "masses": [mass.point for mass in robot.masses],
        "effectors": list(robot.effectors),
        "kinds": [dof.kind for dof in robot.numeric.graph.model.dofs],
        "cells": cells,
        "visits": visits,
        "tube": None if motion.tube is None else _tube(motion.tube, grid),
    }


def _short(value: float) -> float:
    """A number to seven significant digits."""
    return float(f"{value:.7g}")


def _tube(tube: TubeBoxes, grid: Grid) -> dict[str, Any]:
    """Boxes on the grid, rounded outwards, and exact half widths, to three digits."""
    low = np.floor((tube.boxes[..., 0] - grid.centre) / grid.unit).astype(int)
    high = np.ceil((tube.boxes[..., 1] - grid.centre) / grid.unit).astype(int)
    return {
        "times": [_short(t) for t in tube.times],
        "low": low.reshape(len(low), -1).tolist(),
        "high": high.reshape(len(high), -1).tolist(),
        "instants": [_short(t) for t in tube.instants],
        "half": [[float(f"{v:.3g}") for v in row.ravel()] for row in tube.half_widths],
    }
