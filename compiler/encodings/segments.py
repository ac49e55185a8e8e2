"""The rigid segments between the revolute joints of a chain, as far as positions depend on them."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from compiler.expressions.scalars import Constant
from compiler.robots.robot import Joint, Offset, RobotModel, Step, Turn


@dataclass(frozen=True, slots=True)
class Segment:
    """What lies between two revolute joints; ``axis`` of the first one, None at the base."""

    axis: int | None
    steps: tuple[Step, ...]


Chain: TypeAlias = tuple[Segment, ...]


def segments(model: RobotModel, frame: int) -> tuple[Segment, ...]:
    """The segments from the world to a frame, the base segment first.

    A rigid turn right behind a revolute joint about its axis is left out: the joint absorbs it.
    A displacement along its axis there commutes with the joint, so it belongs to the segment
    before.  Joints behind the last displacement move no effector.
    """
    found: list[tuple[int | None, list[Step]]] = [(None, [])]
    for step in model.steps(frame):
        if isinstance(step, Joint) and model.dofs[step.dof].kind == "revolute":
            found.append((step.axis, []))
            continue
        if isinstance(step, Turn) and found[-1] == (step.axis, []):
            continue
        place = len(found) - 1
        axis = _direction(model, step)
        while axis is not None and found[place] == (axis, []):
            place -= 1
        found[place][1].append(step)
    while len(found) > 1 and not found[-1][1]:
        found.pop()
    return tuple(Segment(axis, tuple(steps)) for axis, steps in found)


def _direction(model: RobotModel, step: Step) -> int | None:
    """The axis that a step displaces along; None if it turns or is not seen to have one."""
    match step:
        case Joint(axis=axis):
            return axis
        case Offset(vector):
            along = [i for i in range(3) if model.scalars[vector[i]] != Constant(Fraction(0))]
            return along[0] if len(along) == 1 else None
        case Turn():
            return None
