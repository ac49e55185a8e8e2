r"""A robot as a controlled system in a form that is cheap to differentiate in floats.

.. math:: \dot q = v, \qquad N(q, \theta)\,\dot w = F(q, w, u, \theta), \qquad
    N = \begin{pmatrix} M & 0 \\ 0 & 1 \end{pmatrix}

for w = (v, s), the rates and the modules' own states. With the residual
``R(q, w, w', u, theta) = F - N w'``, the implicit function theorem gives

.. math:: \mathrm d\dot w = N^{-1}\, \mathrm dR

at fixed w' (Carpentier & Mansard, *Analytical Derivatives of Rigid Body Dynamics Algorithms*, RSS
2018), so neither the factorisation nor the accelerations are differentiated.
"""

from __future__ import annotations

from dataclasses import dataclass

import casadi as ca
import numpy as np

from compiler.arrays import Array
from compiler.dynamics.energy_graph import ldl_solve
from compiler.dynamics.equations_of_motion import RobotGraph
from compiler.dynamics.kinematics import generalised_forces, kinematics, own_motion
from compiler.dynamics.newton_euler import inverse_dynamics
from compiler.dynamics.rigid_bodies import Motion, drive, mass_matrix
from compiler.dynamics.robot_points import MADE
from compiler.dynamics.symbolic_evaluator import SymbolicEvaluator
from compiler.expressions.scalars import Constant
from compiler.robots.payloads import loads_of
from compiler.robots.state_and_input import robot_inputs, robot_states
from compiler.time_limits.time_limit import check_time


@dataclass(frozen=True, slots=True)
class ControlledSystem:
    """Functions of one sample, and the values of their constant inputs ``k``.

    - ``forces(q, w, u, theta, k)``: M, shape (n, n), and F, shape (n + r,);
    - ``differential(q, w, a, u, theta, k)``: dR in (q, w, u, theta) at fixed accelerations a,
      shape (n + r, 2n + r + m + p); zero for loads, which are given and not controlled;
    - ``inertial(q, v, a, theta, k)``: M a + c + g, shape (n,), without loads.

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
        """N^-1 times F or dR, for one or more columns."""
        n = self.coordinates
        return ca.vertcat(ldl_solve(mass, forces[:n, :]), forces[n:, :])


def controlled_system(graph: RobotGraph) -> ControlledSystem:
    """The controlled system of a robot, in the same coordinates."""
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
    loads = len(loads_of(model))
    at = kinematics(model, q, theta, constants, coordinates, u[m - loads :])
    own, rates, accelerations = (own_motion(coordinates, each) for each in (q, v, a))
    efforts = inverse_dynamics(model, at, (own, rates, accelerations), graph.gravity, constants)
    inertial = generalised_forces(coordinates, efforts)
    driven = drive(model, Motion(own, rates, w[n:], u, theta), constants)
    residual = ca.vertcat(
        generalised_forces(coordinates, driven.forces) - inertial, driven.derivatives
    )
    mass = ca.densify(mass_matrix(model, at, q, constants, coordinates))
    k = constants.vector()
    check_time(MADE)
    forces = ca.densify(ca.substitute(residual, a, ca.SX.zeros(n)))
    check_time(MADE)
    slopes = ca.jacobian(residual, ca.vertcat(q, w, u, theta))
    if loads:
        steered = n + n + r + m - loads
        slopes = ca.horzcat(slopes[:, :steered], ca.SX(n + r, loads), slopes[:, steered + loads :])
        inertial = ca.substitute(inertial, u[m - loads :], ca.SX.zeros(loads))
    differential = ca.cse([slopes])
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
