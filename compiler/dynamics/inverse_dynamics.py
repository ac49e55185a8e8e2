r"""Inverse dynamics of rigid bodies by Newton's and Euler's laws and virtual power.

.. math:: \mathrm{ID}(q, v, a) = \sum_b J_b^T m_b (\ddot p_b - \gamma)
    + W_b^T (I_b \dot\omega_b + \omega_b \times I_b \omega_b) = M a + c + g

with the coms p_b, J = dp/dq, angular velocities omega = W v and gravity gamma (Featherstone, *Rigid
Body Dynamics Algorithms*, 2008, ch. 5).  Two forward sweeps of differentiation and a reverse one
make it a recursion from the base to the tips and back, linear in the number of bodies, where
Christoffel symbols take the cube of it.  Floats use this; validated evaluators use those.
"""

from __future__ import annotations

from fractions import Fraction

import casadi as ca

from compiler.dynamics.absolute_angles import Coordinates
from compiler.dynamics.kinematics import Kinematics
from compiler.dynamics.rigid_bodies import angular_jacobian, inertia_of
from compiler.dynamics.symbolic_evaluator import SymbolicEvaluator
from compiler.robots.robot import PointBody, RobotModel


def inverse_dynamics(
    model: RobotModel,
    at: Kinematics,
    motion: tuple[ca.SX, ca.SX, ca.SX],
    gravity: tuple[Fraction, ...],
    constants: SymbolicEvaluator,
    coordinates: Coordinates,
) -> ca.SX:
    """The generalised forces (n,) that cause accelerations; ``motion`` is (q, v, a)."""
    q, v, _ = motion
    d, forces = model.dimension, ca.SX.zeros(len(model.dofs))
    pull = ca.SX.zeros(d)
    if any(gravity):
        pull = ca.vertcat(*(constants.constant(value) for value in gravity))
    masses, coms = [], []
    for body in model.bodies:
        mass, com, inertia = inertia_of(body, at, constants)
        masses.append(mass)
        coms.append(com[:d])
        if not isinstance(body, PointBody):
            angular = angular_jacobian(model, at, body.frame, coordinates)
            forces += _turning(angular, inertia, motion, d)
    if not coms or not len(model.dofs):
        return forces
    places = ca.vertcat(*coms)
    acceleration = _second_derivative(ca.jtimes(places, q, v), motion)
    weights = ca.vertcat(*(ca.repmat(mass, d, 1) for mass in masses))
    inertial = weights * (acceleration - ca.repmat(pull, len(coms), 1))
    return forces + _transposed(places, q, inertial)


def _turning(
    angular: ca.SX, inertia: ca.SX, motion: tuple[ca.SX, ca.SX, ca.SX], dimension: int
) -> ca.SX:
    """Euler's equation of one body; its axis never turns in the plane."""
    _, v, a = motion
    if dimension == 2:
        spin = angular[2, :]
        return spin.T * (inertia[2, 2] * (spin @ a))
    rate = angular @ v
    moment = inertia @ _second_derivative(rate, motion) + ca.cross(rate, inertia @ rate)
    return angular.T @ moment


def _transposed(value: ca.SX, q: ca.SX, weights: ca.SX) -> ca.SX:
    """The transposed Jacobian of a function of q times weights, by one reverse sweep."""
    reverse = True
    return ca.jtimes(value, q, weights, reverse)


def _second_derivative(rate: ca.SX, motion: tuple[ca.SX, ca.SX, ca.SX]) -> ca.SX:
    """The derivative of a function of (q, v) along the motion."""
    q, v, a = motion
    return ca.jtimes(rate, ca.vertcat(q, v), ca.vertcat(v, a))
