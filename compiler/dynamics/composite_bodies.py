r"""The mass matrix from composite bodies in the frames of the joints.

All that a joint carries is one body with mass m, first moment h and inertia I about the joint's
origin.  Moving the joint gives it the momenta (p, L); with the axis s of an earlier joint,

.. math:: M_{ij} = s_i \cdot L \quad\text{(revolute)}, \qquad M_{ij} = s_i \cdot p
    \quad\text{(prismatic)}

Only coordinates between the two joints and behind them occur, each in few places, so that the
expressions are short, and interval arithmetic loses far less than on the product of Jacobians.

Source: Featherstone, *Rigid Body Dynamics Algorithms* (2008), section 6.2.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import casadi as ca

from compiler.dynamics.kinematics import Kinematics, rotation
from compiler.dynamics.symbolic_evaluator import SymbolicEvaluator
from compiler.robots.robot import (
    WORLD,
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


@dataclass(frozen=True, slots=True)
class CompositeBody:
    """Mass, first moment (3,) and inertia about the origin (3, 3), in the axes of a frame."""

    mass: ca.SX
    moment: ca.SX
    inertia: ca.SX

    def plus(self, other: CompositeBody) -> CompositeBody:
        """Both together."""
        return CompositeBody(
            self.mass + other.mass, self.moment + other.moment, self.inertia + other.inertia
        )

    def moved(self, turn: ca.SX, shift: ca.SX) -> CompositeBody:
        """The same body in a frame in which its own is turned and shifted."""
        moment = turn @ self.moment
        inertia = turn @ self.inertia @ turn.T
        inertia += _about(shift @ moment.T + moment @ shift.T)
        inertia += self.mass * _about(shift @ shift.T)
        return CompositeBody(self.mass, moment + self.mass * shift, inertia)


def composite_mass_matrix(
    model: RobotModel, at: Kinematics, q: ca.SX, constants: SymbolicEvaluator
) -> ca.SX:
    """M in the joints' own coordinates q, shape (n, n)."""
    steps = [_step(node.step, model, at, q, constants) for node in model.frames]
    carried = [CompositeBody(ca.SX(1, 1), ca.SX(3, 1), ca.SX(3, 3)) for _ in model.frames]
    for body in model.bodies:
        carried[body.frame] = carried[body.frame].plus(_of(body, at, constants))
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
    body: CompositeBody,
    steps: list[tuple[ca.SX, ca.SX]],
) -> None:
    """Add the entries of a joint's frame with itself and all joints before it."""
    step = model.frames[last].step
    if not isinstance(step, Joint):
        raise TypeError("only joints have entries")
    axis = _axis(step)
    if model.dofs[step.dof].kind == "revolute":
        linear, angular = ca.cross(axis, body.moment), body.inertia @ axis
    else:
        linear, angular = body.mass * axis, ca.cross(body.moment, axis)
    frame = last
    while frame != WORLD:
        first = model.frames[frame].step
        if isinstance(first, Joint):
            revolute = model.dofs[first.dof].kind == "revolute"
            entry = ca.dot(_axis(first), angular if revolute else linear)
            mass[first.dof, step.dof] += entry
            if frame != last:
                mass[step.dof, first.dof] += entry
        turn, shift = steps[frame]
        linear = turn @ linear
        angular = turn @ angular + ca.cross(shift, linear)
        frame = model.frames[frame].parent


def _axis(joint: Joint) -> ca.SX:
    axis = ca.SX(3, 1)
    axis[joint.axis] = joint.sign
    return axis


def _step(
    step: Step | None, model: RobotModel, at: Kinematics, q: ca.SX, constants: SymbolicEvaluator
) -> tuple[ca.SX, ca.SX]:
    """The rotation and the translation of a step."""
    turn, shift = ca.SX.eye(3), ca.SX(3, 1)
    match step:
        case Turn(axis, angle):
            turn = rotation(axis, constants.unfolded(at.scalars[angle]))
        case Offset(vector):
            shift = ca.vertcat(*(constants.unfolded(at.scalars[i]) for i in vector))
        case Joint(dof, axis, sign) if model.dofs[dof].kind == "revolute":
            turn = rotation(axis, sign * q[dof])
        case Joint(dof, _, _):
            shift = _axis(step) * q[dof]
        case None:
            pass
    return turn, shift


def _of(body: Body, at: Kinematics, constants: SymbolicEvaluator) -> CompositeBody:
    """A body in the axes of its frame."""
    match body:
        case RodBody(_, axis, sign, length, density, _):
            half, third = (constants.constant(Fraction(1, i)) for i in (2, 3))
            extent = constants.unfolded(at.scalars[length])
            mass = constants.unfolded(at.scalars[density]) * extent
            along, across = ca.SX(3, 1), ca.SX.eye(3)
            along[axis] = sign
            across[axis, axis] = 0
            return CompositeBody(
                mass, mass * extent * half * along, mass * extent**2 * third * across
            )
        case PointBody(_, mass_scalar):
            return CompositeBody(at.scalars[mass_scalar], ca.SX(3, 1), ca.SX(3, 3))
        case SolidBody(_, mass_scalar, com, inertia):
            mass = at.scalars[mass_scalar]
            centre = ca.vertcat(*(constants.unfolded(at.scalars[i]) for i in com))
            own = _inertia([at.scalars[i] for i in inertia])
            about = mass * _about(centre @ centre.T)
            return CompositeBody(mass, mass * centre, own + about)


def _inertia(items: list[ca.SX]) -> ca.SX:
    """The tensor of one number in the plane, or of six in space."""
    tensor = ca.SX(3, 3)
    if len(items) == 1:
        tensor[2, 2] = items[0]
        return tensor
    places = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]
    for (row, column), item in zip(places, items, strict=True):
        tensor[row, column] = item
        tensor[column, row] = item
    return tensor


def _about(dyad: ca.SX) -> ca.SX:
    """``tr(dyad) 1 - dyad``, without the terms that cancel on the diagonal."""
    result = -dyad
    for i in range(3):
        result[i, i] = sum((dyad[j, j] for j in range(3) if j != i), ca.SX(0))
    return result
