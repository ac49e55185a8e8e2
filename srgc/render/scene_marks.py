"""The marks of a scene as SVG: sets, the robot in one pose, traces and boxes of the tube.

The page's script moves these marks; without it they show the first pose.
"""

from __future__ import annotations

import re
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

from compiler.robots.robot import WORLD
from srgc.render.drawn_robot import DrawnJoint, DrawnRobot
from srgc.render.html_text import name_in_picture, text
from srgc.render.view import View
from srgc.render.workspace_shapes import WorkspaceShape

Array = NDArray[np.float64]

AXIS_LENGTH = 34.0
"""Length on the picture of the line that shows a joint's axis, where that is in the picture."""
THINNEST_CAPSULE = 6.0
"""Twice the radius on the picture from which on a rod is drawn as thick as it is."""
LETTER = 7.2
_LEADING_ZERO = re.compile(r"(^|[ -])0\.")


def place(value: float) -> str:
    """A coordinate of the picture."""
    shown = f"{value:.1f}"
    return shown.removesuffix(".0") if shown != "-0.0" else "0"


def line_path(points: Array) -> str:
    """A line through points (m, 2) as the data of a path."""
    return "M" + "L".join(f"{place(x)} {place(y)}" for x, y in points)


def outline(points: Array) -> Array:
    """The corners of the convex hull of points (m, 2), in order (Andrew's monotone chain)."""
    ordered = sorted({(float(x), float(y)) for x, y in points})
    if len(ordered) < 3:
        return np.array(ordered)
    return np.array(_half(ordered)[:-1] + _half(ordered[::-1])[:-1])


def _half(ordered: Sequence[tuple[float, float]]) -> list[tuple[float, float]]:
    chain: list[tuple[float, float]] = []
    for p in ordered:
        while len(chain) > 1 and _turn(chain[-2], chain[-1], p) <= 0:
            chain.pop()
        chain.append(p)
    return chain


def _turn(a: tuple[float, float], b: tuple[float, float], c: tuple[float, float]) -> float:
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


def shape_path(shape: WorkspaceShape, view: View) -> str:
    """A set as the data of one path: what it covers, or its edges in space."""
    corners = view.project(shape.corners)
    if view.axes.shape[1] == 3:
        return "".join(line_path(corners[[a, b]]) for a, b in shape.edges)
    return _closed(outline(corners))


def _closed(corners: Array) -> str:
    """A polygon as the data of a path, from corner to corner: short where there are thousands."""
    tenths = np.rint(10 * corners).astype(int)
    steps = "".join(
        f" {place(dx / 10)} {place(dy / 10)}" for dx, dy in np.diff(tenths, axis=0).tolist()
    )
    short = _LEADING_ZERO.sub(r"\1.", steps.lstrip()).replace(" -", "-")
    x, y = tenths[0].tolist()
    return f"M{place(x / 10)} {place(y / 10)}l{short}Z"


def shape_marks(shapes: Sequence[WorkspaceShape], view: View) -> str:
    """All sets; the pieces of a map, of which there may be thousands, are one mark."""
    groups: list[list[WorkspaceShape]] = []
    for shape in shapes:
        if groups and shape.kind not in ("bounds", "cell") and not shape.label:
            groups[-1].append(shape)
        else:
            groups.append([shape])
    return "".join(_shape_mark(group, view) for group in groups)


def _shape_mark(group: Sequence[WorkspaceShape], view: View) -> str:
    """A set: what it covers, and its edges in space."""
    shape = group[0]
    outlines = "".join(_closed(outline(view.project(each.corners))) for each in group)
    face = f'<path class="face" d="{outlines}"/>'
    edges = ""
    if view.axes.shape[1] == 3:
        edges = f'<path class="edges" d="{shape_path(shape, view)}"/>'
    name = shape.label if len(group) > 1 else shape.name
    title = f"<title>{text(name)}</title>" if shape.kind != "bounds" else ""
    return f'<g class="shape {shape.kind}">{title}{face}{edges}</g>'


def shape_names(shapes: Sequence[WorkspaceShape], view: View) -> str:
    """The names of regions, above all else: in the region where it has room, else above it."""
    found = []
    for index, shape in enumerate(shapes):
        if not shape.label:
            continue
        corners = view.project(shape.corners)
        low, high = corners.min(axis=0), corners.max(axis=0)
        name = name_in_picture(shape.label)
        fits = high[0] - low[0] > LETTER * len(name) + 8 and high[1] - low[1] > 22
        x, y = (low[0] + high[0]) / 2, (low[1] + high[1]) / 2 + 5 if fits else low[1] - 5
        found.append(
            f'<text data-shape="{index}" x="{place(x)}" y="{place(y)}">{text(name)}</text>'
        )
    return f'<g class="names">{"".join(found)}</g>'


def box_corners(box: Array) -> Array:
    """The corners (2^d, d) of a box (d, 2)."""
    grids = np.meshgrid(*box, indexing="ij")
    return np.stack([grid.ravel() for grid in grids], axis=-1)


def boxes_path(boxes: Iterable[Array], view: View) -> str:
    """Boxes (d, 2) as the data of one path."""
    return "".join(line_path(outline(view.project(box_corners(box)))) + "Z" for box in boxes)


def pose_marks(robot: DrawnRobot, points: Array, view: View) -> str:
    """The robot with its points (P, d): rods, the lines between its frames, joints, effectors."""
    seen = view.project(points)
    marks = [_foot(seen[WORLD])]
    marks += [_segment("bone", seen[[a, b]]) for a, b in robot.bones]
    for rod in robot.rods:
        ends = seen[list(rod.ends)]
        width = 0.0 if rod.radius is None else 2 * rod.radius * view.scale
        if width > THINNEST_CAPSULE:
            marks.append(_segment("capsule", ends, f' stroke-width="{place(width)}"'))
        marks.append(_segment("rod", ends))
    marks += [_axis(joint, seen) for joint in robot.joints if joint.tip is not None]
    marks += [_joint(joint, seen) for joint in robot.joints]
    marks += [_mass(seen[mass.point], solid=mass.solid) for mass in robot.masses]
    for number, point in enumerate(robot.effectors):
        marks.append(_effector(seen[point], number if len(robot.effectors) > 1 else None))
    return "".join(marks)


def _foot(at: Array) -> str:
    """The ground, where the frames of the robot begin."""
    shift = f"translate({place(at[0])} {place(at[1])})"
    return f'<path class="foot" transform="{shift}" d="M0 0L-8 13H8ZM-13 13H13"/>'


def _segment(kind: str, ends: Array, more: str = "") -> str:
    (a, b), (c, d) = ends
    return (
        f'<line class="{kind}" x1="{place(a)}" y1="{place(b)}" x2="{place(c)}" y2="{place(d)}"'
        f"{more}/>"
    )


def _axis(joint: DrawnJoint, seen: Array) -> str:
    """The axis of a joint of space, a metre of it shortened to a length of the picture."""
    return _segment("axis", axis_ends(seen[joint.point], seen[joint.tip or 0]))


def axis_ends(foot: Array, tip: Array) -> Array:
    """The ends of the line for an axis through a point; no longer than it is seen."""
    along = tip - foot
    length = float(np.hypot(*along))
    half = along * min(AXIS_LENGTH / 2 / max(length, 1e-9), 1.0)
    return np.stack([foot - half, foot + half])


def _joint(joint: DrawnJoint, seen: Array) -> str:
    x, y = seen[joint.point]
    shape = '<circle r="5"/>' if joint.kind == "revolute" else '<path d="M-5-5H5V5H-5Z"/>'
    return f'<g class="joint" transform="translate({place(x)} {place(y)})">{shape}</g>'


def _mass(at: Array, *, solid: bool) -> str:
    shape = '<path d="M-4 0L0-4L4 0L0 4Z"/>' if solid else '<circle r="2.6"/>'
    return f'<g class="mass" transform="translate({place(at[0])} {place(at[1])})">{shape}</g>'


def _effector(at: Array, number: int | None) -> str:
    name = "" if number is None else f'<text x="9" y="-7">{number + 1}</text>'
    return (
        f'<g class="effector" transform="translate({place(at[0])} {place(at[1])})">'
        f'<circle r="6.5"/><circle class="dot" r="1.8"/>{name}</g>'
    )
