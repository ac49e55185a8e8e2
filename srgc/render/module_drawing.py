"""A robot drawn module by module, in a pose that shows all of it.

The pose does not come from a task.  Of a few simple poses within the joint ranges, it is the one in
which the modules are farthest apart in the picture.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import product
from math import radians

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.robot import RobotDof, RodBody
from grammar_lang import ir
from grammar_lang.ir.constants import to_float
from srgc.render.module_marks import MarkedRobot
from srgc.render.svg import NAMED, sight

BENDS = tuple(radians(angle) for angle in (20, 35, 50, 70, -35, -50))
SLIDES = (0.35, 0.7, 1.0)
"""Positions of prismatic joints, as shares of their range; in metres if they have no range."""
APART = 1e-6
"""Points farther apart than this, in metres, count as distinct."""


@dataclass(slots=True)
class DrawnModule:
    """A module of the word: its lines, and the point where it is.

    Shapes: ``lines`` are (2, d) each; so are ``bodies``, with a centre of mass given twice; ``at``
    is (d,).  ``joint`` is the kind of joint, if any, and ``axis`` (d,) its direction in the world.
    ``pointing`` (d,) is the direction of the line at whose end an effector is.
    """

    place: int
    name: str
    role: ir.Role
    at: Array | None = None
    joint: ir.DofKind | None = None
    axis: Array | None = None
    pointing: Array | None = None
    lines: list[Array] = field(default_factory=list[Array])
    bodies: list[Array] = field(default_factory=list[Array])

    def anchor(self) -> Array | None:
        """The point (d,) that a name belongs to: the middle of the longest line, or ``at``."""
        lines = [*self.lines, *self.bodies]
        longest = max(
            lines, key=lambda line: float(np.linalg.norm(line[1] - line[0])), default=None
        )
        if longest is None or (self.joint is not None and self.at is not None):
            return self.at
        middle: Array = longest.mean(axis=0)
        return middle


@dataclass(frozen=True)
class ModuleDrawing:
    """The modules that have a place, and lines that belong to no module."""

    modules: tuple[DrawnModule, ...]
    others: tuple[Array, ...]

    def corners(self) -> Array:
        """All points that must be visible, shape (m, d)."""
        lines = [line for module in self.modules for line in (*module.lines, *module.bodies)]
        at = [module.at[None] for module in self.modules if module.at is not None]
        return np.concatenate([*lines, *self.others, *at])


def module_drawing(
    robot: MarkedRobot,
    word: Sequence[str],
    modules: dict[str, ir.Module],
    theta: Array,
) -> ModuleDrawing:
    """Draw a robot with parameter values theta (p,), in SI units."""
    # Without shapes, every body is given by points.
    model = replace(robot.model, shapes=(), shape_owners=(), covered=(), apart=())
    numeric = NumericRobot(robot_graph(model))
    poses = _poses(robot.model.dofs)
    points = numeric.positions(poses, theta)
    best = points[_clearest(points, robot)]
    hulls = [[len(model.effectors) + i for i in hull] for hull in numeric.spanning.hulls]
    return _drawing(robot, word, modules, best, hulls)


def _poses(dofs: Sequence[RobotDof]) -> Array:
    """Poses (K, n) to choose from: all joints bent the same way, or alternately."""
    found = []
    for bend, slide, sign in product(BENDS, SLIDES, (1.0, -1.0)):
        pose, side = [], 1.0
        for dof in dofs:
            if dof.kind == "revolute":
                pose.append(_within(dof.range, bend * side))
                side *= sign
            else:
                pose.append(_part(dof.range, slide))
        found.append(pose)
    return np.unique(np.array(found, dtype=float).reshape(len(found), len(dofs)), axis=0)


def _within(interval: ir.Interval | None, value: float) -> float:
    if interval is None:
        return value
    return min(max(value, to_float(interval.lower)), to_float(interval.upper))


def _part(interval: ir.Interval | None, part: float) -> float:
    if interval is None:
        return part
    low, high = to_float(interval.lower), to_float(interval.upper)
    return low + part * (high - low)


def _clearest(points: Array, robot: MarkedRobot) -> int:
    """The pose with the largest distances in the picture between marks that are ever apart."""
    ends = sorted({end for each in robot.stretches for end in each.ends} | {*robot.effector_marks})
    if len(ends) < 2:
        return 0
    places = points[:, ends]
    apart = np.linalg.norm(places[:, :, None] - places[:, None, :], axis=-1).max(axis=0) > APART
    seen = places @ sight(*NAMED[0][1:]).T if places.shape[2] == 3 else places
    distances = np.linalg.norm(seen[:, :, None] - seen[:, None, :], axis=-1)
    pairs = distances[:, apart]
    if pairs.shape[1] == 0:
        return 0
    size = max(float(pairs.max()), APART)
    # The least distance counts most; among similar ones, a wide pose is preferred.
    score = np.round(pairs.min(axis=1) / size, 3) + 0.1 * pairs.mean(axis=1) / size
    return int(np.argmax(np.round(score, 6)))


def _drawing(
    robot: MarkedRobot,
    word: Sequence[str],
    modules: dict[str, ir.Module],
    points: Array,
    hulls: Sequence[Sequence[int]],
) -> ModuleDrawing:
    found = {
        place: DrawnModule(place, name, modules[name].role)
        for place, name in enumerate(word)
        if name in modules
    }
    others: list[Array] = []
    for each in robot.stretches:
        line = points[list(each.ends)]
        owner = None if each.place is None else found[each.place]
        if owner is None:
            others.append(line)
            continue
        if each.joint is not None and each.tip is not None:
            owner.joint, owner.at = each.joint, line[0]
            owner.axis = points[each.tip] - line[0]
        if float(np.linalg.norm(line[1] - line[0])) > APART:
            owner.lines.append(line)
    for body, place, hull in zip(robot.model.bodies, robot.bodies, hulls, strict=True):
        line = points[[hull[0], hull[-1]]]
        if place is not None:
            found[place].bodies.append(line)
        elif isinstance(body, RodBody):
            others.append(line)
    _stand(robot, found, points)
    return ModuleDrawing(
        tuple(each for each in found.values() if each.anchor() is not None), tuple(others)
    )


def _stand(robot: MarkedRobot, found: dict[int, DrawnModule], points: Array) -> None:
    """Set the places of the modules that are not joints."""
    for place, mark in robot.stands.items():
        module = found[place]
        if module.at is None:
            module.at = module.lines[0][0] if module.lines else points[mark]
    for place_, mark in zip(robot.effectors, robot.effector_marks, strict=True):
        if place_ is not None:
            found[place_].at = points[mark]
    lines = [line for module in found.values() for line in (*module.lines, *module.bodies)]
    for module in found.values():
        if module.role == "base" and module.at is None:
            module.at = np.zeros(points.shape[1])
        if module.role == "effector" and module.at is not None:
            module.pointing = _pointing(module.at, lines)


def _pointing(at: Array, lines: Sequence[Array]) -> Array | None:
    """The direction of the last line that ends at this point."""
    found = None
    for line in lines:
        for end, other in (line, line[::-1]):
            apart = np.linalg.norm(end - other) > APART
            if apart and float(np.linalg.norm(end - at)) < APART:
                found = end - other
    return found
