"""The radii of `robust start` by coordinate and rate."""

from __future__ import annotations

from fractions import Fraction

from compiler.robots.robot import RobotModel
from grammar_lang import ir


def disturbance_radii(task: ir.Task, model: RobotModel) -> list[Fraction]:
    """Per joint's coordinate, then per rate, how far it may be from what is planned, in SI."""
    robust = task.robust or ir.Robust()
    turning = [dof.kind == "revolute" for dof in model.dofs]
    places = [robust.angle if turns else robust.length for turns in turning]
    return places + [robust.angular_rate if turns else robust.speed for turns in turning]
