"""Whether a robot in space is one in the plane of x and y."""

from __future__ import annotations

from fractions import Fraction

from compiler.expressions.scalars import Constant
from compiler.robots.robot import (
    Body,
    Joint,
    Offset,
    PointBody,
    RobotModel,
    RodBody,
    SolidBody,
    Step,
    Turn,
)

Z = 2


def is_planar(model: RobotModel) -> bool:
    """Whether all turns are about z and all that moves stays at z = 0.

    By the form of the model: steps along z that cancel are not seen to.
    """
    steps = (node.step for node in model.frames)
    return all(_planar_step(model, step) for step in steps) and all(
        _planar_body(model, body) for body in model.bodies
    )


def _planar_step(model: RobotModel, step: Step | None) -> bool:
    match step:
        case Turn(axis, _):
            return axis == Z
        case Offset((_, _, z)):
            return _is_zero(model, z)
        case Joint(dof, axis, _):
            return (model.dofs[dof].kind == "revolute") == (axis == Z)
        case None:
            return True


def _planar_body(model: RobotModel, body: Body) -> bool:
    match body:
        case RodBody():
            return body.axis != Z
        case PointBody():
            return True
        case SolidBody():
            return len(body.inertia) == 1 and _is_zero(model, body.com[Z])


def _is_zero(model: RobotModel, scalar: int) -> bool:
    return model.scalars[scalar] == Constant(Fraction(0))
