r"""The mass matrix from composite bodies in the frames of the joints.

Everything that a joint carries is one body with mass m, first moment h and inertia I about the
joint's origin. Moving the joint gives this body the momenta (p, L); with the axis s of an earlier
joint,

.. math:: M_{ij} = s_i \cdot L \quad\text{(revolute)}, \qquad M_{ij} = s_i \cdot p
    \quad\text{(prismatic)}

Only the coordinates between the two joints and after them occur, each in few places, so the
expressions are short, and interval arithmetic loses far less than on the product of Jacobians.

Source: Featherstone, *Rigid Body Dynamics Algorithms* (2008), section 6.2.
"""

from __future__ import annotations

import casadi as ca

from compiler.dynamics.kinematics import Kinematics
from compiler.dynamics.spatial_inertia import (
    SpatialInertia,
    joint_axis,
    spatial_inertia,
    step_transform,
)
from compiler.dynamics.symbolic_evaluator import SymbolicEvaluator
from compiler.robots.robot import WORLD, Joint, RobotModel


def composite_mass_matrix(
    model: RobotModel, at: Kinematics, q: ca.SX, constants: SymbolicEvaluator
) -> ca.SX:
    """M in the joints' own coordinates q, shape (n, n)."""
    steps = [step_transform(node.step, model, at, q, constants) for node in model.frames]
    carried = [SpatialInertia.none() for _ in model.frames]
    for body in model.bodies:
        carried[body.frame] = carried[body.frame].plus(spatial_inertia(body, at, constants))
    for frame in range(len(model.frames) - 1, WORLD, -1):
        parent = model.frames[frame].parent
        carried[parent] = carried[parent].plus(carried[frame].moved(*steps[frame]))
    mass = ca.SX.zeros(len(model.dofs), len(model.dofs))
    for frame, node in enumerate(model.frames):
        if isinstance(node.step, Joint):
            _enter(mass, model, frame, carried[frame], steps)
    return mass


def _enter(
    mass: ca.SX,
    model: RobotModel,
    last: int,
    body: SpatialInertia,
    steps: list[tuple[ca.SX, ca.SX]],
) -> None:
    """Add the entries of a joint's frame with itself and with all joints before it."""
    step = model.frames[last].step
    if not isinstance(step, Joint):
        raise TypeError("only joints have entries")
    axis = joint_axis(step)
    if model.dofs[step.dof].kind == "revolute":
        linear, angular = ca.cross(axis, body.moment), body.inertia @ axis
    else:
        linear, angular = body.mass * axis, ca.cross(body.moment, axis)
    frame = last
    while frame != WORLD:
        first = model.frames[frame].step
        if isinstance(first, Joint):
            revolute = model.dofs[first.dof].kind == "revolute"
            entry = ca.dot(joint_axis(first), angular if revolute else linear)
            mass[first.dof, step.dof] += entry
            if frame != last:
                mass[step.dof, first.dof] += entry
        turn, shift = steps[frame]
        linear = turn @ linear
        angular = turn @ angular + ca.cross(shift, linear)
        frame = model.frames[frame].parent
