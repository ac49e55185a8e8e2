"""The normal form of a robot model: rigid steps merged, idle joints removed, coaxial joints merged.

Two robots whose normal forms have equal keys are equal up to the names of their parameters, so
only one of them has to be tried.  The converse need not hold; a missed equality costs time only.
Every pass is linear in the number of frames.
"""

from __future__ import annotations

from dataclasses import replace

from compiler.robots.coaxial_joints import with_coaxial_joints_merged
from compiler.robots.idle_joints import without_idle_joints
from compiler.robots.rigid_steps import with_rigid_steps_merged
from compiler.robots.robot import RobotModel


def normalise(model: RobotModel) -> RobotModel:
    """The normal form of a robot.

    A degree of freedom that moves neither mass nor an effector nor a body point is removed;
    consecutive joints about one axis with nothing between them but rigid steps that commute with
    them become one, whose range is the interval sum of theirs.  What acts on no degree of freedom
    any more is left out.
    """
    model = replace(model, joints=model.word_dofs)
    model = with_rigid_steps_merged(without_idle_joints(model))
    model = with_coaxial_joints_merged(model)
    acting = (own.acting() for own in model.own)
    return with_rigid_steps_merged(replace(model, own=tuple(own for own in acting if own.torques)))
