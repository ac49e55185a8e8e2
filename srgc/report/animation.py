"""The motion of a result: a picture with a time slider, and poses for paper."""

from __future__ import annotations

from math import degrees, floor, log10
from typing import Any

import numpy as np

from compiler.arrays import Array
from srgc.render.html_text import json_script, number, text, with_unit
from srgc.render.robot_drawing import THINNEST_CAPSULE, DrawnRobot, pose_marks
from srgc.render.svg import NAMED, View, line_path, sight
from srgc.render.workspace_drawing import (
    boxes_path,
    scale_bar,
    shape_marks,
    shape_names,
    shape_path,
    triad,
)
from srgc.report.evidence import Evidence
from srgc.report.motion_scene import MotionScene, RobotMotion, TubeBoxes, motion_scene
from srgc.results.found_design import FoundDesign

POSES = 6
WIDEST_BOX = 15.0
"""Up to what half width on the picture the box of an instant is magnified."""
MOST_MAGNIFIED = 1e15
"""Narrower boxes are not drawn larger."""
SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 10.0)
LONGEST_SHOW, SHORTEST_SHOW = 8.0, 1.0
"""Seconds that a motion is shown at most and at least, at the speed that is chosen first."""
LINE_POINTS = 160


def motion_section(evidence: Evidence) -> str:
    """The section of the page; the workspace alone where the result has no robot."""
    scene = motion_scene(evidence)
    if scene.motion is None or evidence.found is None:
        return _workspace_alone(evidence, scene)
    motion = scene.motion
    factor = _factor(motion.tube, scene.view)
    data = {**scene_data(scene), "factor": factor}
    caption = _caption(scene, motion, factor, repeats=evidence.task.repeat)
    return (
        '<section id="motion"><h2>Motion</h2>'
        f"<figure>{_picture(scene, motion, factor)}{_controls(scene, motion)}"
        f"{_readings(evidence.found, motion)}"
        f"<figcaption>{caption}</figcaption></figure>"
        f"{_poses(scene, motion)}{json_script('motion-data', data)}</section>"
    )


def _workspace_alone(evidence: Evidence, scene: MotionScene) -> str:
    shapes = shape_marks(scene.shapes, scene.view)
    shapes += shape_names(scene.shapes, scene.view) + measure(scene)
    return (
        '<section id="motion"><h2>Workspace</h2><figure>'
        f"{scene_picture(scene.view, f'Workspace {evidence.workspace.name}', shapes)}"
        f"{_views(scene)}"
        "<figcaption>There is no robot, and so no motion: the workspace "
        f"<i>{text(evidence.workspace.name)}</i> with its regions and cells.{_beyond(scene)}"
        "</figcaption></figure>"
        f"{json_script('motion-data', scene_data(scene))}</section>"
    )


def scene_picture(view: View, title: str, content: str, *, turned: bool = True) -> str:
    """A picture of a workspace; of space, one that a script can turn."""
    size = f"{view.width:.0f} {view.height:.0f}"
    space = view.axes.shape[1] == 3
    kind = "scene space" if space else "scene"
    stop = ' tabindex="0"' if space and turned else ""
    return (
        f'<svg class="{kind}" viewBox="0 0 {size}" role="img" aria-label="{text(title)}"{stop}>'
        f"{content}</svg>"
    )


def _picture(scene: MotionScene, motion: RobotMotion, factor: float) -> str:
    view = scene.view
    parts = [shape_marks(scene.shapes, view)]
    if motion.tube is not None:
        boxes = motion.tube.boxes.reshape(-1, *motion.tube.boxes.shape[2:])
        parts.append(f'<path class="tube" d="{boxes_path(boxes, view)}"/>')
        parts.append('<path class="ribbon" d=""/><path class="tube-now" d=""/>')
    for tips in np.swapaxes(motion.tips, 0, 1):
        parts.append(f'<path class="trail" d="{line_path(view.project(tips))}"/>')
        parts.append('<path class="trace" d=""/>')
    parts.append(f'<g class="robot">{pose_marks(motion.robot, motion.points[0], view)}</g>')
    if motion.tube is not None:
        boxes = _instant_boxes(motion.tips[0], motion.tube.half_widths[0], factor)
        parts.append(f'<path class="instant" d="{boxes_path(list(boxes), view)}"/>')
    parts.append(shape_names(scene.shapes, view))
    parts.append(measure(scene))
    return scene_picture(
        view, "The robot in its workspace at the time that the slider gives", "".join(parts)
    )


def _instant_boxes(tips: Array, half_widths: Array, factor: float) -> Array:
    """The boxes (e, d, 2) of an instant, magnified about the effectors."""
    return np.stack([tips - factor * half_widths, tips + factor * half_widths], axis=-1)


def _factor(tube: TubeBoxes | None, view: View) -> float:
    """A power of ten by which boxes of instants are magnified so that they can be seen."""
    if tube is None:
        return 1.0
    widest = float(tube.half_widths.max()) * view.scale
    if widest <= WIDEST_BOX / MOST_MAGNIFIED:
        return 1.0  # a robot that stands still: there is nothing to see
    return float(10.0 ** max(0, floor(log10(WIDEST_BOX / widest))))


def measure(scene: MotionScene) -> str:
    """How long and which way: a bar in the plane, the directions of the axes in space."""
    return scale_bar(scene.view) if scene.dimension == 2 else triad(scene.view)


def _beyond(scene: MotionScene) -> str:
    return " The bounds reach beyond the picture." if scene.beyond else ""


def _views(scene: MotionScene) -> str:
    if scene.dimension == 2:
        return ""
    buttons = "".join(
        f'<button type="button" data-view="{index}" aria-pressed="{str(index == 0).lower()}">'
        f"{text(name)}</button>"
        for index, (name, _, _) in enumerate(NAMED)
    )
    return (
        f'<div class="views screen-only" hidden="">{buttons}'
        '<button type="button" data-zoom="0.8" aria-label="Smaller">−</button>'
        '<button type="button" data-zoom="1.25" aria-label="Larger">+</button>'
        "<span>or drag the picture</span></div>"
    )


def _controls(scene: MotionScene, motion: RobotMotion) -> str:
    total = motion.steps * motion.step
    choice = show_speeds(total)
    wanted = next(speed for speed in choice if speed * LONGEST_SHOW >= total)
    selected, checked = ' selected=""', ' checked=""'
    speeds = "".join(
        f'<option value="{speed:g}"{selected if speed == wanted else ""}>{number(speed)}×</option>'
        for speed in choice
    )
    switches = [("cells", "cells", scene.dimension == 2), ("trail", "trace", True)]
    if motion.tube is not None:
        switches += [("tube", "tube", True), ("ribbon", "its width, magnified", False)]
    boxes = "".join(
        f'<label><input type="checkbox" data-show="{name}"{checked if on else ""}/> {label}</label>'
        for name, label, on in switches
    )
    return (
        '<div class="controls screen-only" hidden=""><div class="player">'
        '<button type="button" class="play" aria-label="Play">▶</button>'
        f'<input type="range" min="0" max="{motion.steps}" step="1" value="0" '
        'aria-label="Time, by samples"/>'
        f'<label class="speed">speed <select>{speeds}</select></label></div>'
        f'<div class="switches">{boxes}</div></div>{_views(scene)}'
    )


def show_speeds(total: float) -> list[float]:
    """The usual speeds, and slower and faster ones for motions of microseconds or hours."""
    found = list(SPEEDS)
    while found[0] * SHORTEST_SHOW > total:
        found.insert(0, found[0] / 10)
    while found[-1] * LONGEST_SHOW < total:
        found.append(found[-1] * 10)
    return found


def _readings(found: FoundDesign, motion: RobotMotion) -> str:
    """Time, cells and coordinates, which the script keeps up to date."""
    last = with_unit(motion.steps * motion.step, "s")
    rows = [("t", '<dd class="time">0 s</dd>')]
    sample = f'<dd><span class="sample">0</span> of {motion.steps}, to {last}</dd>'
    rows.append(("sample", sample))
    several = len(motion.visits) > 1
    for index, visits in enumerate(motion.visits):
        which = f" of effector {index + 1}" if several else ""
        first = text(visits[0].cell) if visits else ""
        rows.append((f"cell{which}", f'<dd class="cell">{first}</dd>'))
    word = found.derivation.word
    for index, dof in enumerate(found.model.dofs):
        names = ", ".join(f"{text(word[place])} {place}" for place in dof.symbols)
        value = _coordinate(float(motion.q[0, index]), turning=dof.kind == "revolute")
        rows.append((f"q{index + 1} <small>{names}</small>", f'<dd class="q">{value}</dd>'))
    items = "".join(f"<div><dt>{term}</dt>{value}</div>" for term, value in rows)
    return f'<dl class="readings">{items}</dl>'


def _coordinate(value: float, *, turning: bool) -> str:
    return f"{degrees(value):.1f}°" if turning else f"{number(value)} m"


def _caption(scene: MotionScene, motion: RobotMotion, factor: float, *, repeats: bool) -> str:
    words = (
        "The robot at its real lengths: rods as thick lines, joints as circles (turning) and "
        "squares (sliding), effectors as rings, other bodies by their centres of mass as dots."
    )
    if scene.dimension == 3:
        words += " A short line through a joint is its axis."
    return f"{words}{_beyond(scene)} {_tube_words(motion.tube, factor, repeats=repeats)}"


def _tube_words(tube: TubeBoxes | None, factor: float, *, repeats: bool) -> str:
    if tube is None:
        return "No tube is drawn: the motion was not enclosed for this page."
    sides = 2 * tube.half_widths
    every = "every round of every motion" if repeats else "every disturbed motion"
    holds = every if tube.disturbed else "the motion"
    words = (
        f"Boxes: the certified tube; each box holds the effector throughout one of "
        f"{len(tube.boxes)} intervals of time, so it is as long as the way that is made in it"
    )
    if len(tube.boxes) < tube.segments:
        words += f" (the proof has {tube.segments}, drawn together)"
    words += (
        f". At an instant the tube, which holds {holds}, is at most "
        f"{_length(float(sides.max()))} wide"
    )
    if factor > 1:
        shown = f"{factor:,.0f}".replace(",", "\u202f")
        return f"{words}; the box about the effector is drawn {shown} times as wide as it is."
    return f"{words}; that is the box about the effector."


def _length(metres: float) -> str:
    """A length to two digits, in the unit in which it is easiest to read."""
    for unit, size in (("m", 1.0), ("mm", 1e-3), ("µm", 1e-6), ("nm", 1e-9), ("pm", 1e-12)):
        if metres >= size:
            return f"{float(f'{metres / size:.2g}'):g} {unit}"
    return f"{metres:.1g} m"


def _poses(scene: MotionScene, motion: RobotMotion) -> str:
    """The robot at equal distances of time, for paper and where no script runs."""
    total = motion.steps * motion.step
    sets = "".join(f'<path id="pose-{kind}" d="{data}"/>' for kind, data in _sets(scene) if data)
    uses = "".join(
        f'<use class="all {kind}" href="#pose-{kind}"/>' for kind, data in _sets(scene) if data
    )
    found: list[str] = []
    for time in np.linspace(0.0, total, POSES):
        index = int(np.abs(motion.times - time).argmin())
        marks = uses + _pose(motion.robot, motion, index, scene.view)
        if not found:
            marks = f"<defs>{sets}</defs>{marks}"
        label = f"t = {number(float(motion.times[index]))} s"
        picture = scene_picture(scene.view, f"The robot at {label}", marks)
        found.append(f"<figure>{picture}<figcaption>{label}</figcaption></figure>")
    return f'<div class="poses">{"".join(found)}</div>'


def _sets(scene: MotionScene) -> list[tuple[str, str]]:
    """All sets of a kind as the data of one path, which every pose uses again.

    A style that names elements around what is used does not reach it, one that it inherits does.
    """
    kinds = ("bounds", "region", "obstacle", "target")
    return [
        (kind, "".join(shape_path(s, scene.view) for s in scene.shapes if s.kind == kind))
        for kind in kinds
    ]


def _pose(robot: DrawnRobot, motion: RobotMotion, index: int, view: View) -> str:
    kept = np.unique(np.linspace(0, index, min(index + 1, LINE_POINTS)).astype(int))
    traces = "".join(
        f'<path class="trace" d="{line_path(view.project(tips[kept]))}"/>'
        for tips in np.swapaxes(motion.tips, 0, 1)
    )
    return f'{traces}<g class="robot">{pose_marks(robot, motion.points[index], view)}</g>'


# --- The data of the animation for the page's script, on a grid that is finer than the picture ----


GRID = 0.04
"""Width of the grid in units of the picture."""


def scene_data(scene: MotionScene) -> dict[str, Any]:
    """What the script needs.

    Coordinates are whole multiples of ``unit`` metres from ``centre``.  In space there are views,
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
        """The coordinates of points (..., d) in turn."""
        found: list[int] = np.rint((points - self.centre) / self.unit).astype(int).ravel().tolist()
        return found


def motion_data(motion: RobotMotion, grid: Grid, cells: list[str], view: View) -> dict[str, Any]:
    """A motion for a script; ``cells`` are the names of those that are drawn, in order."""
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
    """A number to seven digits, whatever its size."""
    return float(f"{value:.7g}")


def _tube(tube: TubeBoxes, grid: Grid) -> dict[str, Any]:
    """Boxes on the grid rounded outwards; half widths as they are, to three digits."""
    low = np.floor((tube.boxes[..., 0] - grid.centre) / grid.unit).astype(int)
    high = np.ceil((tube.boxes[..., 1] - grid.centre) / grid.unit).astype(int)
    return {
        "times": [_short(t) for t in tube.times],
        "low": low.reshape(len(low), -1).tolist(),
        "high": high.reshape(len(high), -1).tolist(),
        "instants": [_short(t) for t in tube.instants],
        "half": [[float(f"{v:.3g}") for v in row.ravel()] for row in tube.half_widths],
    }
