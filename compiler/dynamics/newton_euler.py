r"""Inverse dynamics by the recursive Newton-Euler algorithm, in the axes of the joints' frames.

The first pass, from the base to the tips, computes each frame's angular velocity, angular
acceleration and the acceleration of its origin. The second pass, back to the base, computes the
forces and moments that the joints transmit to what they carry. The tensor A maps a place in the
frame to its acceleration relative to the origin's. For a rigid link of mass m, first moment h and
inertia I about the origin,

.. math:: f = m a + A h, \qquad
    n = h \times a + I \dot\omega + \omega \times I \omega, \qquad
    A = [\dot\omega]_\times + [\omega]_\times^2

Gravity is an acceleration of the base. Everything fixed to a joint is one link, so there are as
many steps as joints. The number of operations is linear in the number of joints, and that of
derivatives is quadratic.

Source: Luh, Walker & Paul, *On-line computational scheme for mechanical manipulators* (1980);
Featherstone, *Rigid Body Dynamics Algorithms* (2008), ch. 5.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import casadi as ca

from compiler.dynamics.kinematics import Kinematics
from compiler.dynamics.rigid_bodies import rotor_inertias
from compiler.dynamics.spatial_inertia import (
    SpatialInertia,
    joint_axis,
    spatial_inertia,
    step_transform,
)
from compiler.dynamics.symbolic_evaluator import SymbolicEvaluator
from compiler.robots.robot import WORLD, Joint, RobotModel


@dataclass(frozen=True, slots=True)
class _Link:
    """A joint and everything fixed to it; ``turn`` and ``shift`` place it in ``parent``."""

    parent: int
    joint: Joint
    revolute: bool
    turn: ca.SX
    shift: ca.SX


@dataclass(frozen=True, slots=True)
class _LinkMotion:
    """The motion of the axes of a link, in these axes; ``spread`` is the tensor A, (3, 3)."""

    rate: ca.SX
    angular: ca.SX
    linear: ca.SX
    spread: ca.SX


def inverse_dynamics(
    model: RobotModel,
    at: Kinematics,
    motion: tuple[ca.SX, ca.SX, ca.SX],
    gravity: tuple[Fraction, ...],
    constants: SymbolicEvaluator,
) -> ca.SX:
    """The generalised forces M a + c + g, shape (n,), for given accelerations.

    Args:
        model: the robot.
        at: its scalars.
        motion: q, v and a of the joints themselves, (n,) each.
        gravity: the acceleration in m/s^2, none if empty.
        constants: collects the exact constants.
    """
    q, v, a = motion
    links, inertias = _links(model, at, q, constants)
    base = ca.SX(3, 1)
    for axis, value in enumerate(gravity):
        if value:
            base[axis] = -constants.constant(value)
    motions = {WORLD: _LinkMotion(ca.SX(3, 1), ca.SX(3, 1), base, ca.SX(3, 3))}
    wrenches = {WORLD: (ca.SX(3, 1), ca.SX(3, 1))}
    for number, link in links.items():
        dof = link.joint.dof
        motions[number] = _moved(motions[link.parent], link, v[dof], a[dof])
        wrenches[number] = _wrench(inertias[number], motions[number])
    rotors = rotor_inertias(model, constants)
    efforts = ca.SX.zeros(len(model.dofs)) if rotors is None else rotors @ a
    for number, link in reversed(links.items()):
        force, moment = wrenches[number]
        efforts[link.joint.dof] += ca.dot(
            joint_axis(link.joint), moment if link.revolute else force
        )
        force, moment = link.turn @ force, link.turn @ moment
        before = wrenches[link.parent]
        wrenches[link.parent] = before[0] + force, before[1] + moment + ca.cross(link.shift, force)
    return efforts


def _links(
    model: RobotModel, at: Kinematics, q: ca.SX, constants: SymbolicEvaluator
) -> tuple[dict[int, _Link], list[SpatialInertia]]:
    """The links by the frames of their joints, parents first, and the inertia fixed to each."""
    links: dict[int, _Link] = {}
    # For every frame, the frame of its link, and its rotation and position in that link's axes.
    fixed = [(WORLD, ca.SX.eye(3), ca.SX(3, 1))]
    for number, node in enumerate(model.frames):
        if number == WORLD:
            continue
        link, turn, shift = fixed[node.parent]
        turned, shifted = step_transform(node.step, model, at, q, constants)
        turn, shift = turn @ turned, shift + turn @ shifted
        if isinstance(node.step, Joint):
            revolute = model.dofs[node.step.dof].kind == "revolute"
            links[number] = _Link(link, node.step, revolute, turn, shift)
            link, turn, shift = number, ca.SX.eye(3), ca.SX(3, 1)
        fixed.append((link, turn, shift))
    inertias = [SpatialInertia.none() for _ in model.frames]
    for body in model.bodies:
        link, turn, shift = fixed[body.frame]
        own = spatial_inertia(body, at, constants)
        inertias[link] = inertias[link].plus(own.moved(turn, shift))
    return links, inertias


def _moved(base: _LinkMotion, link: _Link, rate: ca.SX, acceleration: ca.SX) -> _LinkMotion:
    """The motion of a link, from that of the link before it and of its own joint."""
    back, axis = link.turn.T, joint_axis(link.joint)
    turning, angular = back @ base.rate, back @ base.angular
    linear = back @ (base.linear + base.spread @ link.shift)
    if link.revolute:
        angular = angular + axis * acceleration + ca.cross(turning, axis * rate)
        turning = turning + axis * rate
    else:
        linear = linear + axis * acceleration + 2 * ca.cross(turning, axis * rate)
    return _LinkMotion(turning, angular, linear, _spread(turning, angular))


def _spread(rate: ca.SX, angular: ca.SX) -> ca.SX:
    """The tensor that maps a place to its acceleration relative to the origin's, (3, 3)."""
    tensor = ca.SX(3, 3)
    for i in range(3):
        j, k = (i + 1) % 3, (i + 2) % 3
        tensor[i, i] = -(rate[j] ** 2 + rate[k] ** 2)
        both = rate[i] * rate[j]
        tensor[i, j] = both - angular[k]
        tensor[j, i] = both + angular[k]
    return tensor


def _wrench(inertia: SpatialInertia, motion: _LinkMotion) -> tuple[ca.SX, ca.SX]:
    """The force on a link, and the moment about its origin, that move it."""
    force = inertia.mass * motion.linear + motion.spread @ inertia.moment
    spin = inertia.inertia @ motion.rate
    moment = inertia.inertia @ motion.angular + ca.cross(motion.rate, spin)
    return force, moment + ca.cross(inertia.moment, motion.linear)
