"""The drawing of a robot: its parts, their positions in a pose, and their marks.

The robot's own expression graph gives the positions: every frame becomes an effector of the robot,
so the graph gives all their origins.  In space, every joint has an extra frame a metre along its
axis, which shows the direction of the axis.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.expressions.evaluators.floats import scalar_floats
from compiler.expressions.scalars import Constant
from compiler.robots.robot import (
    WORLD,
    FrameNode,
    Joint,
    Offset,
    PointBody,
    RobotModel,
    RodBody,
    Shape,
    Step,
)
from grammar_lang import ir
from srgc.render.effector_numbers import HALF, number_mark, number_places
from srgc.render.svg import View, closed_path, place
from srgc.render.workspace_drawing import outline

SHARPEST = 0.12
"""The largest angle, in radians, that a joint turns between drawn instants.

A rod drawn by interpolating its ends is then at most 0.2 % too short.
"""
AXIS_LENGTH = 34.0
"""The length in the picture of the line that shows a joint's axis, if that is not seen end on."""
THINNEST_CAPSULE = 6.0
"""The least width in the picture at which a rod is drawn with its thickness."""


@dataclass(frozen=True, slots=True)
class DrawnRod:
    """A rod between two points; ``radius`` in metres, None for a rod without one."""

    ends: tuple[int, int]
    radius: float | None


@dataclass(frozen=True, slots=True)
class DrawnShape:
    """A shape: all points within ``radius`` metres of the convex hull of its corners."""

    corners: tuple[int, ...]
    radius: float


@dataclass(frozen=True, slots=True)
class DrawnMass:
    """A point mass, or the centre of mass of a solid."""

    point: int
    solid: bool


@dataclass(frozen=True, slots=True)
class DrawnJoint:
    """A degree of freedom at a point; ``tip`` is a metre along its axis, None in the plane."""

    dof: int
    kind: ir.DofKind
    point: int
    tip: int | None


@dataclass(frozen=True)
class DrawnRobot:
    """The parts of a robot, which refer to its points by index.

    ``bones`` connect frames with different origins; ``effectors`` are in their order.  A robot that
    is not ``grounded`` flies or drives: it has no foot, and ``joints`` omit its translations.
    """

    numeric: NumericRobot
    theta: Array
    rods: tuple[DrawnRod, ...]
    masses: tuple[DrawnMass, ...]
    shapes: tuple[DrawnShape, ...]
    bones: tuple[tuple[int, int], ...]
    joints: tuple[DrawnJoint, ...]
    effectors: tuple[int, ...]
    grounded: bool

    def points(self, q: Array) -> Array:
        """All points at coordinates q (K, n), shape (K, points, d), in metres."""
        return self.numeric.positions(q, self.theta)

    def own(self, points: Array) -> Array:
        """The points (..., points, d) that are parts of the robot, without the tips of axes."""
        tips = {joint.tip for joint in self.joints}
        kept = [point for point in range(points.shape[-2]) if point not in tips]
        found: Array = points[..., kept, :]
        return found


def drawn_robot(model: RobotModel, theta: Array) -> DrawnRobot:
    """The parts of a robot with parameter values theta (p,), in SI units."""
    marked, tips = _marked(model)
    numeric = NumericRobot(robot_graph(marked))
    scalars = scalar_floats(marked.scalars, theta)
    rods, masses, shapes = [], [], []
    for each, hull in zip(marked.colliders, numeric.spanning.hulls, strict=True):
        corners = tuple(len(marked.effectors) + i for i in hull)
        if isinstance(each, RodBody):
            radius = None if each.radius is None else scalars[each.radius]
            rods.append(DrawnRod((corners[0], corners[-1]), radius))
        elif isinstance(each, Shape):
            radius = 0.0 if each.radius is None else scalars[each.radius]
            shapes.append(DrawnShape(corners, radius))
        else:
            masses.append(DrawnMass(corners[0], not isinstance(each, PointBody)))
    return DrawnRobot(
        numeric,
        theta,
        tuple(rods),
        tuple(masses),
        tuple(shapes),
        _bones(model),
        tuple(_joints(model, tips)),
        model.effectors,
        not any(_floats(model, node.step) for node in model.frames),
    )


def _marked(model: RobotModel) -> tuple[RobotModel, dict[int, int]]:
    """The robot with all frames as effectors; in space also the tips of the joints' axes."""
    scalars = (*model.scalars, Constant(Fraction(0)), Constant(Fraction(1)), Constant(Fraction(-1)))
    zero, one, minus = range(len(model.scalars), len(scalars))
    frames, tips = list(model.frames), dict[int, int]()
    for number, node in enumerate(model.frames):
        if model.dimension == 2 or not isinstance(node.step, Joint):
            continue
        if not _floats(model, node.step):
            vector = [zero, zero, zero]
            vector[node.step.axis] = one if node.step.sign > 0 else minus
            tips[number] = len(frames)
            frames.append(FrameNode(number, Offset((vector[0], vector[1], vector[2]))))
    marked = replace(
        model,
        scalars=scalars,
        frames=tuple(frames),
        effectors=tuple(range(len(frames))),
        apart=(),
        covered=(),
    )
    return marked, tips


def _joints(model: RobotModel, tips: dict[int, int]) -> list[DrawnJoint]:
    return [
        DrawnJoint(node.step.dof, model.dofs[node.step.dof].kind, number, tips.get(number))
        for number, node in enumerate(model.frames)
        if isinstance(node.step, Joint) and not _floats(model, node.step)
    ]


def _bones(model: RobotModel) -> tuple[tuple[int, int], ...]:
    """Pairs of parent and frame, for the frames on the way to an effector or a body.

    Frames that are only rotated have the origin of their parents and are omitted.
    """
    used = {
        frame
        for end in (*model.effectors, *(body.frame for body in model.bodies))
        for frame in model.chain(end)
    }
    return tuple(
        (model.frames[frame].parent, frame)
        for frame in sorted(used - {WORLD})
        if _moves(model, model.frames[frame].step)
    )


def _moves(model: RobotModel, step: Step | None) -> bool:
    """Whether the origin of a frame may differ from that of its parent."""
    if isinstance(step, Joint):
        return model.dofs[step.dof].kind == "prismatic" and not _floats(model, step)
    return isinstance(step, Offset)


def _floats(model: RobotModel, step: Step | None) -> bool:
    """Whether a step is a translation of a module with other degrees of freedom: no line is drawn.

    Drones, platforms on wheels and the planar joints of URDF are described in this way.
    """
    if not isinstance(step, Joint) or model.dofs[step.dof].kind == "revolute":
        return False
    symbols = model.dofs[step.dof].symbols
    return sum(dof.symbols == symbols for dof in model.dofs) > 1


# --- Marks ----------------------------------------------------------------------------------------


def pose_marks(
    robot: DrawnRobot,
    points: Array,
    view: View,
    taken: Array | None = None,
    half: float = HALF,
) -> str:
    """The robot at points (P, d): rods, lines between its frames, joints and effectors.

    Several effectors have numbers on discs of radius ``half``, which keep off the rectangles
    ``taken`` (m, 4) of the picture.
    """
    seen = view.project(points)
    marks = [_foot(seen[WORLD])] if robot.grounded else []
    marks += [_shape(shape, seen, view) for shape in robot.shapes]
    marks += [_segment("bone", seen[[a, b]]) for a, b in robot.bones]
    for rod in robot.rods:
        ends = seen[list(rod.ends)]
        if is_thick(rod, view):
            width = place(_width(rod, view))
            marks.append(_segment("capsule", ends, f' stroke-width="{width}"'))
        marks.append(_segment("rod", ends))
    marks += [_axis(joint, seen) for joint in robot.joints if joint.tip is not None]
    marks += [_joint(joint, seen) for joint in robot.joints]
    marks += [_mass(seen[mass.point], solid=mass.solid) for mass in robot.masses]
    return "".join(marks) + _effectors(robot, seen, view, taken, half)


def is_thick(rod: DrawnRod, view: View) -> bool:
    """Whether a rod is drawn with its thickness, as a band around it."""
    return _width(rod, view) > THINNEST_CAPSULE


def _width(rod: DrawnRod, view: View) -> float:
    """The width of a rod in the picture; 0 if it has no radius."""
    return 0.0 if rod.radius is None else 2 * rod.radius * view.scale


def _effectors(robot: DrawnRobot, seen: Array, view: View, taken: Array | None, half: float) -> str:
    """The rings of the effectors, with numbers if there are several."""
    tips = seen[list(robot.effectors)]
    if len(tips) < 2:
        return "".join(_effector(at) for at in tips)
    places = number_places(tips, (view.width, view.height), taken, half)
    return "".join(
        _effector(at, number_mark(number, middle - at))
        for number, (at, middle) in enumerate(zip(tips, places, strict=True), 1)
    )


def ghost_marks(robot: DrawnRobot, points: Array, view: View) -> str:
    """The rods of a robot and the lines between its frames, at points (P, d)."""
    seen = view.project(points)
    marks = [_segment("bone", seen[[a, b]]) for a, b in robot.bones]
    marks += [_segment("rod", seen[list(rod.ends)]) for rod in robot.rods]
    return "".join(marks)


def _foot(at: Array) -> str:
    """The mark of the ground, where the frames of the robot begin."""
    shift = f"translate({place(at[0])} {place(at[1])})"
    return f'<path class="foot" transform="{shift}" d="M0 0L-8 13H8ZM-13 13H13"/>'


def _segment(kind: str, ends: Array, more: str = "") -> str:
    (a, b), (c, d) = ends
    return (
        f'<line class="{kind}" x1="{place(a)}" y1="{place(b)}" x2="{place(c)}" y2="{place(d)}"'
        f"{more}/>"
    )


def _shape(shape: DrawnShape, seen: Array, view: View) -> str:
    """The outline of a shape: the hull of its corners, with a stroke for its radius."""
    width = max(1.0, 2 * shape.radius * view.scale)
    path = closed_path(outline(seen[list(shape.corners)]))
    return f'<path class="solid" stroke-width="{place(width)}" d="{path}"/>'


def _axis(joint: DrawnJoint, seen: Array) -> str:
    """The axis of a joint in space, shortened from a metre to a length in the picture."""
    return _segment("axis", axis_ends(seen[joint.point], seen[joint.tip or 0]))


def axis_ends(foot: Array, tip: Array) -> Array:
    """The ends (2, 2) of the line for an axis through points (2,), no longer than the axis seen."""
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


def _effector(at: Array, number: str = "") -> str:
    return (
        f'<g class="effector" transform="translate({place(at[0])} {place(at[1])})">'
        f'<circle r="6.5"/><circle class="dot" r="1.8"/>{number}</g>'
    )


# --- Instants -------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class MotionSamples:
    """Instants (K,) in seconds, and the coordinates (K, n) at these times."""

    times: Array
    coordinates: Array


def motion_samples(
    times: Array, q: Array, qd: Array, *, turning: NDArray[np.bool_], most: int, least: int = 0
) -> MotionSamples:
    """The instants at which a motion is drawn, including the first and the last.

    Args:
        times: the times of the samples, (k + 1,).
        q: coordinates, (k + 1, n).
        qd: rates, (k + 1, n).
        turning: which coordinates are angles, (n,).
        most: the largest number of instants, two or more; surplus samples are omitted.
        least: about the least number of instants, even if no joint turns far.
    """
    kept = np.arange(len(times))
    if len(times) > most:
        kept = np.unique(np.linspace(0, len(times) - 1, most).round().astype(int))
    turned = np.abs(np.diff(q[kept][:, turning], axis=0)).max(axis=1, initial=0.0)
    parts = np.maximum(-(-least // len(turned)), np.ceil(turned / SHARPEST)).astype(int)
    parts = np.maximum(1, parts)
    if parts.sum() + 1 > most:
        parts = np.maximum(1, parts * (most - len(kept)) // max(int(parts.sum()), 1))
    instants, values = [times[:1]], [q[:1]]
    for (i, j), count in zip(pairwise(kept), parts, strict=True):
        s = np.arange(1, count + 1) / count
        instants.append(times[i] + s * (times[j] - times[i]))
        values.append(_hermite(q[[i, j]], qd[[i, j]] * (times[j] - times[i]), s))
    return MotionSamples(np.concatenate(instants), np.concatenate(values))


def _hermite(q: Array, slopes: Array, s: Array) -> Array:
    """The cubic with end values (2, n) and end slopes (2, n), at s (K,) in [0, 1]."""
    s = s[:, None]
    rise: Array = s * s * (3 - 2 * s)
    start, end = s * (1 - s) ** 2, s * s * (s - 1)
    found: Array = q[0] * (1 - rise) + q[1] * rise + slopes[0] * start + slopes[1] * end
    return found
