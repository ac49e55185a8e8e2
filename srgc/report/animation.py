"""The motion of a result: a picture with a time slider, and poses for print."""

from __future__ import annotations

from collections.abc import Sequence
from math import degrees, floor, log10

import numpy as np

from compiler.arrays import Array
from compiler.robots.robot import RobotDof
from srgc.render.effector_numbers import NARROW_HALF
from srgc.render.html_text import json_script, number, text, with_unit
from srgc.render.label_placement import along
from srgc.render.region_names import page_name_boxes, page_names
from srgc.render.robot_drawing import DrawnRobot, pose_marks
from srgc.render.svg import NAMED, View, line_path
from srgc.render.workspace_drawing import boxes_path, scale_bar, shape_marks, shape_path, triad
from srgc.report.evidence import Evidence
from srgc.report.legend import beyond_words, legend, robot_caption
from srgc.report.motion_data import scene_data
from srgc.report.motion_scene import MotionScene, RobotMotion, TubeBoxes, motion_scene

POSES = 6
WIDEST_BOX = 15.0
"""The largest half width in the picture to which the box of an instant is magnified."""
MOST_MAGNIFIED = 1e15
"""Boxes that need a greater factor are not magnified."""
MOST_SPELT = 1e7
"""Larger factors are told as powers of ten, which they are."""
RAISED = str.maketrans("0123456789", "⁰¹²³⁴⁵⁶⁷⁸⁹")
SPEEDS = (0.1, 0.25, 0.5, 1.0, 2.0, 4.0, 10.0)
LONGEST_SHOW, SHORTEST_SHOW = 8.0, 1.0
"""The longest and the shortest time in seconds that showing a motion takes at the initial speed."""
LINE_POINTS = 160
NEAREST = (
    "Of all motions that were tried this one came nearest to the task. It does not do it, and "
    "nothing of it is proved."
)


def motion_section(evidence: Evidence) -> str:
    """The section about the motion; without a robot or a motion, it shows only the workspace.

    Raises:
        ValueError: there is a motion, but neither a design nor a nearest motion.
    """
    scene = motion_scene(evidence)
    motion, found, nearest = scene.motion, evidence.found, evidence.nearest
    if motion is None:
        return _workspace_alone(evidence, scene)
    factor = magnified(motion.tube, scene.view)
    data = {**scene_data(scene), "factor": factor}
    if found is not None:
        title, word, model = "Motion", found.derivation.word, found.model
        tube = tube_caption(motion.tube, factor, repeats=evidence.task.repeat)
        caption = f"{robot_caption([scene])} {tube}"
    elif nearest is not None:
        title, word, model = "The nearest motion, which fails", nearest.word, nearest.model
        caption = f"{NEAREST} {robot_caption([scene])}"
    else:
        raise ValueError("a motion of no robot")
    picture = motion_picture(scene, motion, factor, word, evidence.workspace.name)
    return (
        f'<section id="motion"><h2>{title}</h2>'
        f"<figure>{picture}{controls([scene])}"
        f"{readings(word, model.dofs, motion)}{legend([scene])}"
        f"<figcaption>{caption}</figcaption></figure>"
        f"{poses(scene, motion)}{json_script('motion-data', data)}</section>"
    )


def _workspace_alone(evidence: Evidence, scene: MotionScene) -> str:
    shapes = shape_marks(scene.shapes, scene.view)
    shapes += page_names(scene.shapes, scene.view) + measure(scene)
    return (
        '<section id="motion"><h2>Workspace</h2><figure>'
        f"{scene_picture(scene.view, f'Workspace {evidence.workspace.name}', shapes)}"
        f"{_views(scene)}{legend([scene])}"
        "<figcaption>There is no robot, and so no motion: the workspace "
        f"<i>{text(evidence.workspace.name)}</i> with its regions and cells.{beyond_words([scene])}"
        "</figcaption></figure>"
        f"{json_script('motion-data', scene_data(scene))}</section>"
    )


def scene_picture(view: View, title: str, content: str, *, turned: bool = True) -> str:
    """A picture of a workspace; if it is spatial, a script can turn it."""
    size = f"{view.width:.0f} {view.height:.0f}"
    space = view.axes.shape[1] == 3
    kind = "scene space" if space else "scene"
    stop = ' tabindex="0"' if space and turned else ""
    return (
        f'<svg class="{kind}" viewBox="0 0 {size}" role="img" aria-label="{text(title)}"{stop}>'
        f"{content}</svg>"
    )


def motion_picture(
    scene: MotionScene, motion: RobotMotion, factor: float, word: Sequence[str], workspace: str
) -> str:
    """The robot in its workspace at the start of the motion; a script moves it.

    The picture is called after the word of the robot and its workspace.
    """
    view = scene.view
    parts = [shape_marks(scene.shapes, view)]
    if motion.tube is not None:
        boxes = motion.tube.boxes.reshape(-1, *motion.tube.boxes.shape[2:])
        parts.append(f'<path class="tube" d="{boxes_path(boxes, view)}"/>')
        parts.append('<path class="ribbon" d=""/><path class="tube-now" d=""/>')
    for tips in np.swapaxes(motion.tips, 0, 1):
        parts.append(f'<path class="trail" d="{line_path(view.project(tips))}"/>')
        parts.append('<path class="trace" d=""/>')
    paths = seen_paths([motion], view)
    names = page_name_boxes(scene.shapes, view, paths)
    robot = pose_marks(motion.robot, motion.points[0], view, names, NARROW_HALF)
    parts.append(f'<g class="robot">{robot}</g>')
    if motion.tube is not None:
        boxes = _instant_boxes(motion.tips[0], motion.tube.half_widths[0], factor)
        parts.append(f'<path class="instant" d="{boxes_path(list(boxes), view)}"/>')
    parts.append(page_names(scene.shapes, view, paths))
    parts.append(measure(scene))
    return scene_picture(
        view,
        f"The robot {' '.join(word)} in {workspace} at the time that the slider gives",
        "".join(parts),
    )


def seen_paths(motions: Sequence[RobotMotion], view: View) -> Array | None:
    """Points (m, 2) of a planar picture on the paths of all effectors, off which names keep.

    None for a view of space, in which the script places names anew.
    """
    if view.axes.shape[1] == 3:
        return None
    tips = [np.swapaxes(motion.tips, 0, 1) for motion in motions]
    return np.concatenate([along(view.project(line)) for lines in tips for line in lines])


def _instant_boxes(tips: Array, half_widths: Array, factor: float) -> Array:
    """The boxes (e, d, 2) at an instant, magnified about the effectors."""
    return np.stack([tips - factor * half_widths, tips + factor * half_widths], axis=-1)


def magnified(tube: TubeBoxes | None, view: View) -> float:
    """The power of ten by which boxes of instants are magnified to make them visible."""
    if tube is None:
        return 1.0
    widest = float(tube.half_widths.max()) * view.scale
    if widest <= WIDEST_BOX / MOST_MAGNIFIED:
        return 1.0  # a robot that stands still: there is nothing to see
    return float(10.0 ** max(0, floor(log10(WIDEST_BOX / widest))))


def measure(scene: MotionScene) -> str:
    """The scale bar of a planar scene, or the axes of a spatial one."""
    return scale_bar(scene.view) if scene.dimension == 2 else triad(scene.view)


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


def controls(scenes: Sequence[MotionScene]) -> str:
    """The controls that play the motions of the scenes in sequence and select what is visible."""
    motions = [scene.motion for scene in scenes if scene.motion is not None]
    total = sum(motion.steps * motion.step for motion in motions)
    choice = show_speeds(total)
    wanted = next(speed for speed in choice if speed * LONGEST_SHOW * len(motions) >= total)
    selected, checked = ' selected=""', ' checked=""'
    speeds = "".join(
        f'<option value="{speed:g}"{selected if speed == wanted else ""}>{number(speed)}×</option>'
        for speed in choice
    )
    switches = [("cells", "cells", scenes[0].dimension == 2), ("trail", "trace", True)]
    if any(motion.tube is not None for motion in motions):
        switches += [("tube", "tube", True), ("ribbon", "its width, magnified", False)]
    boxes = "".join(
        f'<label><input type="checkbox" data-show="{name}"{checked if on else ""}/> {label}</label>'
        for name, label, on in switches
    )
    samples = sum(motion.steps + 1 for motion in motions) - 1
    return (
        '<div class="controls screen-only" hidden=""><div class="player">'
        '<button type="button" class="play" aria-label="Play">▶</button>'
        f'<input type="range" min="0" max="{samples}" step="1" value="0" '
        'aria-label="Time, by samples"/>'
        f'<label class="speed">speed <select>{speeds}</select></label></div>'
        f'<div class="switches">{boxes}</div></div>{_views(scenes[0])}'
    )


def show_speeds(total: float) -> list[float]:
    """The usual speeds, extended for motions of microseconds or hours."""
    found = list(SPEEDS)
    while found[0] * SHORTEST_SHOW > total:
        found.insert(0, found[0] / 10)
    while found[-1] * LONGEST_SHOW < total:
        found.append(found[-1] * 10)
    return found


def readings(word: Sequence[str], dofs: Sequence[RobotDof], motion: RobotMotion) -> str:
    """Time, cells and coordinates; the script updates them."""
    last = with_unit(motion.steps * motion.step, "s")
    rows = [("t", '<dd class="time">0 s</dd>')]
    sample = f'<dd><span class="sample">0</span> of {motion.steps}, to {last}</dd>'
    rows.append(("sample", sample))
    several = len(motion.visits) > 1
    for index, visits in enumerate(motion.visits if any(motion.visits) else ()):
        which = f" of effector {index + 1}" if several else ""
        first = text(visits[0].cell) if visits else ""
        rows.append((f"cell{which}", f'<dd class="cell">{first}</dd>'))
    for index, dof in enumerate(dofs):
        names = ", ".join(f"{text(word[place])} {place}" for place in dof.symbols)
        value = _coordinate(float(motion.q[0, index]), turning=dof.kind == "revolute")
        rows.append((f"q{index + 1} <small>{names}</small>", f'<dd class="q">{value}</dd>'))
    items = "".join(f"<div><dt>{term}</dt>{value}</div>" for term, value in rows)
    return f'<dl class="readings">{items}</dl>'


def _coordinate(value: float, *, turning: bool) -> str:
    return f"{degrees(value):.1f}°" if turning else f"{number(value)} m"


def tube_caption(tube: TubeBoxes | None, factor: float, *, repeats: bool) -> str:
    """The meaning of the boxes of a tube."""
    if tube is None:
        return "No tube is drawn: the motion was not enclosed for this page."
    sides = 2 * tube.half_widths
    every = "every round of every motion" if repeats else "every disturbed motion"
    holds = every if tube.disturbed else "the motion"
    apart = (
        " Their corners may reach into an obstacle where the motion itself does not: no collision "
        "is drawn, and the proved distances are under Margins."
    )
    words = (
        f"Boxes: the certified tube; each box holds the effector throughout one of "
        f"{len(tube.boxes)} intervals of time, so its length is the way covered in it"
    )
    if len(tube.boxes) < tube.segments:
        words += f" (the proof has {tube.segments}, drawn together)"
    words += (
        f". At an instant the tube, which holds {holds}, is at most "
        f"{_length(float(sides.max()))} wide"
    )
    if factor > 1:
        shown = f"{factor:,.0f}".replace(",", "\u202f")
        if factor > MOST_SPELT:
            shown = power_text(factor)
        drawn = f"magnified, the box about the effector is {shown} times as wide"
        return f"{words}; {drawn}.{apart}"
    return f"{words}; that is the box about the effector.{apart}"


def power_text(number: float) -> str:
    """A power of ten, such as ``10⁸``."""
    return f"10{str(round(log10(number))).translate(RAISED)}"


def _length(metres: float) -> str:
    """A length to two digits, in the most readable unit."""
    for unit, size in (("m", 1.0), ("mm", 1e-3), ("µm", 1e-6), ("nm", 1e-9), ("pm", 1e-12)):
        if metres >= size:
            return f"{float(f'{metres / size:.2g}'):g} {unit}"
    return f"{metres:.1g} m"


def poses(scene: MotionScene, motion: RobotMotion, name: str = "pose") -> str:
    """The robot at equal intervals of time, for print and for browsers without scripts.

    ``name`` is the prefix of the ids of shared elements.
    """
    total = motion.steps * motion.step
    sets = "".join(f'<path id="{name}-{kind}" d="{data}"/>' for kind, data in _sets(scene) if data)
    uses = "".join(
        f'<use class="all {kind}" href="#{name}-{kind}"/>' for kind, data in _sets(scene) if data
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
    """All sets of a kind as the data of one path, which all poses reuse.

    Selectors on ancestors of the original do not apply to its copies; inherited styles do.
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
