r"""A robot as a controlled system in the form that floats differentiate cheaply.

.. math:: \dot q = v, \qquad N(q, \theta)\,\dot w = F(q, w, u, \theta), \qquad
    N = \begin{pmatrix} M & 0 \\ 0 & 1 \end{pmatrix}

for w = (v, s), the rates and the modules' own states.  With the residual
``R(q, w, w', u, theta) = F - N w'``, the implicit function theorem gives

.. math:: \mathrm d\dot w = N^{-1}\, \mathrm dR

at fixed w' (Carpentier & Mansard, *Analytical Derivatives of Rigid Body Dynamics Algorithms*, RSS
2018), so that neither the factorisation nor the accelerations are differentiated.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import casadi as ca
import numpy as np

from compiler.arrays import Array
from compiler.dynamics.energy_graph import ldl_solve
from compiler.dynamics.equations_of_motion import MADE, RobotGraph
from compiler.dynamics.kinematics import (
    Coordinates,
    Kinematics,
    generalised_forces,
    kinematics,
    own_motion,
)
from compiler.dynamics.rigid_bodies import Motion, angular_jacobian, drive, inertia_of
from compiler.dynamics.symbolic_evaluator import SymbolicEvaluator
from compiler.expressions.scalars import Constant
from compiler.robots.robot import PointBody, RobotModel
from compiler.robots.state_and_input import robot_inputs, robot_states
from compiler.time_limits.time_limit import check_time


@dataclass(frozen=True, slots=True)
class ControlledSystem:
    """Functions of one sample, and the values of their constant inputs ``k``.

    - ``forces(q, w, u, theta, k)``: M, shape (n, n), and F, shape (n + r,);
    - ``differential(q, w, a, u, theta, k)``: dR in (q, w, u, theta) at fixed accelerations a,
      shape (n + r, 2n + r + m + p);
    - ``inertial(q, v, a, theta, k)``: M a + c + g, shape (n,).

    ``coordinates``, ``states``, ``inputs`` and ``parameters`` are n, r, m and p.
    """

    coordinates: int
    states: int
    inputs: int
    parameters: int
    constants: Array
    forces: ca.Function
    differential: ca.Function
    inertial: ca.Function

    def accelerate(self, mass: ca.SX, forces: ca.SX) -> ca.SX:
        """N^-1 times F or dR, of one or more columns."""
        n = self.coordinates
        return ca.vertcat(ldl_solve(mass, forces[:n, :]), forces[n:, :])


def controlled_system(graph: RobotGraph) -> ControlledSystem:
    """The same robot in the same coordinates."""
    model, coordinates = graph.model, graph.coordinates
    n, r, m, p = (
        len(items)
        for items in (model.dofs, robot_states(model), robot_inputs(model), model.parameters)
    )
    q, w, a, u, theta = (
        ca.SX.sym(name, size)
        for name, size in (("q", n), ("w", n + r), ("a", n), ("u", m), ("theta", p))
    )
    v, constants = w[:n], SymbolicEvaluator()
    at = kinematics(model, q, theta, constants, coordinates)
    inertial = inverse_dynamics(model, at, (q, v, a), graph.gravity, constants, coordinates)
    own = own_motion(coordinates, q), own_motion(coordinates, v)
    driven = drive(model, Motion(*own, w[n:], u, theta), constants)
    residual = ca.vertcat(
        generalised_forces(coordinates, driven.forces) - inertial, driven.derivatives
    )
    k = constants.vector()
    check_time(MADE)
    mass = ca.densify(ca.jacobian(inertial, a))
    forces = ca.densify(ca.substitute(residual, a, ca.SX.zeros(n)))
    check_time(MADE)
    differential = ca.cse([ca.jacobian(residual, ca.vertcat(q, w, u, theta))])
    check_time(MADE)
    both = ca.cse([mass, forces])
    check_time(MADE)
    return ControlledSystem(
        n,
        r,
        m,
        p,
        np.array([float(c.value) if isinstance(c, Constant) else np.pi for c in constants.symbols]),
        ca.Function("forces", [q, w, u, theta, k], both),
        ca.Function("differential", [q, w, a, u, theta, k], differential),
        ca.Function("inertial", [q, v, a, theta, k], [inertial]),
    )


# --- Inverse dynamics of rigid bodies by Newton's and Euler's laws and virtual power --------------
#
# .. math:: \mathrm{ID}(q, v, a) = \sum_b J_b^T m_b (\ddot p_b - \gamma)
#     + W_b^T (I_b \dot\omega_b + \omega_b \times I_b \omega_b) = M a + c + g
#
# with the coms p_b, J = dp/dq, angular velocities omega = W v and gravity gamma (Featherstone,
# *Rigid Body Dynamics Algorithms*, 2008, ch. 5).  Two forward sweeps of differentiation and a
# reverse one make it a recursion from the base to the tips and back, linear in the number of
# bodies, where Christoffel symbols take the cube of it.  Floats use this; validated evaluators use
# those.


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
