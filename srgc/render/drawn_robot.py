"""What of a robot is drawn in motion, and where it is: evaluated by the robot's own graph.

Every frame of the robot is made an effector of it, so that the graph gives the origins of all.  In
space every joint has one frame more, a metre along its axis, which shows where that points.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

import numpy as np
from numpy.typing import NDArray

from compiler.arithmetic.scalars import Constant
from compiler.discretisation.float_reading import FloatReading, scalar_floats
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.robot import (
    WORLD,
    FrameNode,
    Joint,
    Offset,
    PointBody,
    RobotModel,
    RodBody,
    Step,
)
from grammar_lang import ir

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class DrawnRod:
    """A rod between two points; ``radius`` in metres, None of one that has none."""

    ends: tuple[int, int]
    radius: float | None


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
    """The parts of a robot, as numbers of points.

    ``bones`` lead from frame to frame, where these are apart; ``effectors`` are in their order.
    """

    reading: FloatReading
    theta: Array
    rods: tuple[DrawnRod, ...]
    masses: tuple[DrawnMass, ...]
    bones: tuple[tuple[int, int], ...]
    joints: tuple[DrawnJoint, ...]
    effectors: tuple[int, ...]

    def points(self, q: Array) -> Array:
        """All points at coordinates q (K, n), shape (K, points, d), in metres."""
        return self.reading.points(q, self.theta).value


def drawn_robot(model: RobotModel, theta: Sequence[Fraction]) -> DrawnRobot:
    """The parts of a robot whose parameters have these values (SI)."""
    values = np.array([float(value) for value in theta])
    marked, tips = _marked(model)
    reading = FloatReading(robot_graph(marked))
    scalars = scalar_floats(marked.scalars, values)
    rods, masses = [], []
    for body, hull in zip(model.bodies, reading.graph.hulls, strict=True):
        first = len(marked.effectors) + hull[0]
        if isinstance(body, RodBody):
            radius = None if body.radius is None else scalars[body.radius]
            rods.append(DrawnRod((first, len(marked.effectors) + hull[-1]), radius))
        else:
            masses.append(DrawnMass(first, not isinstance(body, PointBody)))
    return DrawnRobot(
        reading,
        values,
        tuple(rods),
        tuple(masses),
        _bones(model),
        tuple(_joints(model, tips)),
        model.effectors,
    )


def _marked(model: RobotModel) -> tuple[RobotModel, dict[int, int]]:
    """The robot with all frames as effectors; in space also the tips of the joints' axes."""
    scalars = (*model.scalars, Constant(Fraction(0)), Constant(Fraction(1)), Constant(Fraction(-1)))
    zero, one, minus = range(len(model.scalars), len(scalars))
    frames, tips = list(model.frames), dict[int, int]()
    for number, node in enumerate(model.frames):
        if isinstance(node.step, Joint) and model.dimension == 3:
            vector = [zero, zero, zero]
            vector[node.step.axis] = one if node.step.sign > 0 else minus
            tips[number] = len(frames)
            frames.append(FrameNode(number, Offset((vector[0], vector[1], vector[2]))))
    marked = replace(
        model, scalars=scalars, frames=tuple(frames), effectors=tuple(range(len(frames)))
    )
    return marked, tips


def _joints(model: RobotModel, tips: dict[int, int]) -> list[DrawnJoint]:
    return [
        DrawnJoint(node.step.dof, model.dofs[node.step.dof].kind, number, tips.get(number))
        for number, node in enumerate(model.frames)
        if isinstance(node.step, Joint)
    ]


def _bones(model: RobotModel) -> tuple[tuple[int, int], ...]:
    """From the parent of a frame to it, of those on the way to an effector or a body.

    Frames that are only turned are where their parents are.
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
    """Whether the origin of a frame may be elsewhere than that of its parent."""
    if isinstance(step, Joint):
        return model.dofs[step.dof].kind == "prismatic"
    return isinstance(step, Offset)
