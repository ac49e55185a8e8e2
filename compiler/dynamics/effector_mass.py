r"""Mass that moves with an effector: a bound on the speed of a hand by energy alone.

A rigid body with a point at an effector's velocity v has at least the kinetic energy
:math:`\mu \lVert v \rVert^2 / 2`: with its mass m for a point mass there, or a body with its centre
there; with m / 4 for a uniform rod that ends there, since

.. math:: \frac1\mu = \frac1m + \frac{(L/2)^2}{m L^2 / 12} = \frac4m

across the rod, and 1 / m along it. Energies of bodies add up if none is negative.

Source: Goldstein, *Classical Mechanics*, section 5.3 (the energy of a rigid body).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import casadi as ca

from compiler.dynamics.kinematics import Kinematics
from compiler.dynamics.rigid_bodies import rotor_inertias
from compiler.dynamics.spatial_inertia import inertia_tensor
from compiler.dynamics.symbolic_evaluator import SymbolicEvaluator
from compiler.robots.robot import Body, Offset, PointBody, RobotModel, RodBody, SolidBody


@dataclass(frozen=True, slots=True)
class EffectorMass:
    """``masses`` (e,) move with the effectors, at least, where the condition holds.

    It is that no entry of ``amounts`` (a,) is negative and all of ``minors`` (p,) are positive.
    """

    masses: ca.SX
    amounts: ca.SX
    minors: ca.SX


def effector_mass(model: RobotModel, at: Kinematics, constants: SymbolicEvaluator) -> EffectorMass:
    """The masses that move with the effectors of a robot; bodies that come and go do not count."""
    masses = [
        sum((_share(model, body, effector, at, constants) for body in model.bodies), ca.SX(1, 1))
        for effector in model.effectors
    ]
    amounts, minors = [ca.SX(0, 1)], [ca.SX(0, 1)]
    for body in model.bodies:
        match body:
            case RodBody():
                amounts += [at.scalars[body.density], at.scalars[body.length]]
            case PointBody():
                amounts.append(at.scalars[body.mass])
            case SolidBody():
                amounts.append(at.scalars[body.mass])
                tensor = inertia_tensor([at.scalars[i] for i in body.inertia])
                if len(body.inertia) == 1:
                    amounts.append(at.scalars[body.inertia[0]])
                else:
                    minors += [ca.det(tensor[:size, :size]) for size in (1, 2, 3)]
    rotors = rotor_inertias(model, constants)
    if rotors is not None:
        amounts.append(ca.diag(rotors))
    return EffectorMass(ca.vertcat(ca.SX(0, 1), *masses), ca.vertcat(*amounts), ca.vertcat(*minors))


def _share(
    model: RobotModel, body: Body, effector: int, at: Kinematics, constants: SymbolicEvaluator
) -> ca.SX:
    """The mass of a body that moves with an effector's frame for sure; 0 if none is known to."""
    match body:
        case PointBody(frame, mass, None) if frame == effector:
            return at.scalars[mass]
        case SolidBody(frame, mass, com, _) if frame == effector:
            centred = all(at.scalars[i].is_zero() for i in com)
            return at.scalars[mass] if centred else ca.SX(1, 1)
        case RodBody(frame, length=length, density=density):
            if effector == frame or _is_end(model, body, effector, at):
                quarter = constants.constant(Fraction(1, 4))
                return quarter * at.scalars[density] * at.scalars[length]
        case _:
            pass
    return ca.SX(1, 1)


def _is_end(model: RobotModel, rod: RodBody, frame: int, at: Kinematics) -> bool:
    """Whether a frame is at the far end of a rod, by the same scalar along the same axis."""
    node = model.frames[frame]
    if node.parent != rod.frame or rod.sign != 1 or not isinstance(node.step, Offset):
        return False
    vector = node.step.vector
    return all(
        vector[axis] == rod.length if axis == rod.axis else at.scalars[vector[axis]].is_zero()
        for axis in range(3)
    )
