"""Coverings written letter by letter, errands to prove impossible with them, and judged poses."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np

from compiler.arrays import Array
from compiler.robots.robot import RobotModel, RodBody, SolidBody
from compiler.workspaces.polytope import polytope_of
from grammar_lang import ir
from tests.oracles.arms import frames_of, scalar_values
from tests.oracles.planes import box

WIDE = ((-9, 9), (-9, 9))


def grid(letters: str, leaf: str = ".") -> str:
    """Every side halved once for each of its letters, all over: ``aab`` makes four times two."""
    code = leaf
    for letter in reversed(letters):
        code = letter + code + code
    return code


def covering(parameters: str, coordinates: str, reason: str = "|") -> str:
    """The text of a covering by a grid."""
    return "boxes 1\n" + grid(parameters, reason + grid(coordinates)) + "\n"


def world(*regions: ir.Region, bounds: Sequence[tuple[object, object]] = WIDE) -> ir.Workspace:
    """A workspace in the plane, or in space."""
    limits = box("bounds", "bounds", *bounds)
    return ir.Workspace("W", 2 if len(bounds) == 2 else 3, limits, regions)


def spot(name: str, x: object, y: object, half: object = "1/10") -> ir.Region:
    """A square about a point."""
    width = Fraction(str(half))
    sides = [(Fraction(str(c)) - width, Fraction(str(c)) + width) for c in (x, y)]
    return box(name, "region", *sides)


def errand(**changes: object) -> ir.Task:
    """Start in S, reach T."""
    given: dict[str, object] = {
        "name": "Errand",
        "grammar": "G",
        "workspace": "W",
        "start": ir.StartIn("S", None, Fraction(0)),
        "reach": ir.Reach("T", None),
        "avoid": (),
        "effort": (),
        "steps": 4,
        "step": Fraction(1),
        "slack": Fraction(0),
        "gravity": (),
        "modules": None,
        "bounds_body": False,
    }
    return ir.Task(**{**given, **changes})  # type: ignore[arg-type]


def avoiding(*names: str, subject: str = "body", margin: int = 0) -> tuple[ir.Avoid, ...]:
    """An ``avoid`` of regions."""
    return (ir.Avoid(names, subject, Fraction(margin)),)  # type: ignore[arg-type]


def allowed(
    model: RobotModel, workspace: ir.Workspace, task: ir.Task, q: Array, theta: Array
) -> bool:
    """Whether a pose breaks no demand on poses by more than rounding; rods by 257 of their points.

    From the definition of the task, by products of frames: nothing of the compiler but the sets.
    """
    values, frames = scalar_values(model, theta), frames_of(model, q, theta)
    d = model.dimension
    tips = [frames[frame][1][:d] for frame in model.effectors]
    bodies = []
    for body in model.bodies:
        turn, origin = frames[body.frame]
        ends = [origin[:d]]
        if isinstance(body, RodBody):
            far = origin + turn[:, body.axis] * body.sign * values[body.length]
            ends = [(1 - f) * origin[:d] + f * far[:d] for f in np.linspace(0, 1, 257)]
        if isinstance(body, SolidBody):
            ends = [(origin + turn @ np.array([values[i] for i in body.com]))[:d]]
        bodies += ends
    bounded = [*tips, *bodies] if task.bounds_body else tips
    if heights(workspace.bounds, bounded).max() > 1e-9:
        return False
    return not any(
        len(points) and heights(workspace.region(name), points).min() < -1e-9
        for item in task.avoid
        for name in item.regions
        for points in [tips if item.subject == "effector" else bodies]
    )


def height(region: ir.Region, point: Array) -> float:
    """The largest of the heights over the half-spaces of a region; negative in its interior."""
    return float(heights(region, [point])[0])


def heights(region: ir.Region, points: Sequence[Array]) -> Array:
    """The heights of several points."""
    rows = polytope_of(region.shape, len(points[0])).rows
    normals = np.array([[float(a) for a in row.normal] for row in rows])
    offsets = np.array([float(row.offset) for row in rows])
    return np.asarray((np.array(points) @ normals.T - offsets).max(axis=1))
