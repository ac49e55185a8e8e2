"""Bodies and steps in the axes of a robot's frames, as expressions.

They are the input of recursive algorithms over frames: nothing here depends on the pose of the
robot except through a joint's own coordinate (Featherstone, *Rigid Body Dynamics Algorithms*, 2008,
ch. 2).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import casadi as ca

from compiler.dynamics.kinematics import Kinematics, rotation
from compiler.dynamics.symbolic_evaluator import SymbolicEvaluator
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


@dataclass(frozen=True, slots=True)
class SpatialInertia:
    """Mass, first moment (3,) and inertia about the origin (3, 3), in the axes of a frame."""

    mass: ca.SX
    moment: ca.SX
    inertia: ca.SX

    @staticmethod
    def none() -> SpatialInertia:
        """The inertia of no body."""
        return SpatialInertia(ca.SX(1, 1), ca.SX(3, 1), ca.SX(3, 3))

    def plus(self, other: SpatialInertia) -> SpatialInertia:
        """The inertia of both bodies together."""
        return SpatialInertia(
            self.mass + other.mass, self.moment + other.moment, self.inertia + other.inertia
        )

    def moved(self, turn: ca.SX, shift: ca.SX) -> SpatialInertia:
        """The inertia in axes in which this frame is rotated by ``turn`` and moved by ``shift``."""
        moment = turn @ self.moment
        inertia = turn @ self.inertia @ turn.T
        inertia += _about(shift @ moment.T + moment @ shift.T)
        inertia += self.mass * _about(shift @ shift.T)
        return SpatialInertia(self.mass, moment + self.mass * shift, inertia)


def joint_axis(joint: Joint) -> ca.SX:
    """The axis of a joint in its own axes, shape (3,)."""
    axis = ca.SX(3, 1)
    axis[joint.axis] = joint.sign
    return axis


def step_transform(
    step: Step | None, model: RobotModel, at: Kinematics, q: ca.SX, constants: SymbolicEvaluator
) -> tuple[ca.SX, ca.SX]:
    """The rotation (3, 3) and the translation (3,) of a step; q are the joints' own coordinates."""
    turn, shift = ca.SX.eye(3), ca.SX(3, 1)
    match step:
        case Turn(axis, angle):
            turn = rotation(axis, constants.unfolded(at.scalars[angle]))
        case Offset(vector):
            shift = ca.vertcat(*(constants.unfolded(at.scalars[i]) for i in vector))
        case Joint(dof, axis, sign) if model.dofs[dof].kind == "revolute":
            turn = rotation(axis, sign * q[dof])
        case Joint(dof, _, _):
            shift = joint_axis(step) * q[dof]
        case None:
            pass
    return turn, shift


def spatial_inertia(body: Body, at: Kinematics, constants: SymbolicEvaluator) -> SpatialInertia:
    """The inertia of a body in the axes of its frame."""
    match body:
        case RodBody(_, axis, sign, length, density, _):
            half, third = (constants.constant(Fraction(1, i)) for i in (2, 3))
            extent = constants.unfolded(at.scalars[length])
            mass = constants.unfolded(at.scalars[density]) * extent
            along, across = ca.SX(3, 1), ca.SX.eye(3)
            along[axis] = sign
            across[axis, axis] = 0
            return SpatialInertia(
                mass, mass * extent * half * along, mass * extent**2 * third * across
            )
        case PointBody():
            return SpatialInertia(at.mass(body), ca.SX(3, 1), ca.SX(3, 3))
        case SolidBody(_, mass_scalar, com, inertia):
            mass = at.scalars[mass_scalar]
            centre = ca.vertcat(*(constants.unfolded(at.scalars[i]) for i in com))
            own = inertia_tensor([at.scalars[i] for i in inertia])
            about = mass * _about(centre @ centre.T)
            return SpatialInertia(mass, mass * centre, own + about)


def inertia_tensor(items: list[ca.SX]) -> ca.SX:
    """The tensor (3, 3) given by one number in the plane, or by six in space."""
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
