r"""The equations of motion of any robot model as one CasADi expression graph.

.. math::
    M(q, \theta)\,\ddot q + c(q, \dot q, \theta) + g(q, \theta) = \tau(q, \dot q, s, u, \theta),
    \qquad \dot s = \sigma(q, \dot q, s, u, \theta)

with the modules' own states s; together one controlled system x' = f(x, theta, u), Definition 5.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import casadi as ca

from compiler.arithmetic.scalars import Constant, PiConstant
from compiler.dynamics.absolute_angles import Coordinates, own_coordinates
from compiler.dynamics.coordinate_change import generalised_forces, own_motion
from compiler.dynamics.drive import Motion, drive
from compiler.dynamics.kinematics import ConstantInputs, kinematics
from compiler.dynamics.ldl import ldl_solve
from compiler.dynamics.rigid_bodies import centrifugal, gravitational, mass_matrix
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import robot_inputs, robot_states


@dataclass(frozen=True, slots=True)
class RobotGraph:
    """One robot's expression graph, read by several back ends; ``gravity`` is in m/s^2.

    Inputs, each a column: ``q``, ``w`` (the rates v of q, then the modules' own states), ``u``
    (inputs), ``theta`` and ``k``, the exact constants listed in ``constants``.  Where
    ``coordinates`` are absolute angles, ``q`` and ``v`` stand for those and their rates; ``u`` are
    the joints' own inputs always.  With n degrees of freedom, r own states, m inputs, e effectors,
    b body points and d the dimension of the workspace:

    - ``mass_matrix(q, theta, k)``: M, shape (n, n), kg m^2 (kg for prismatic rows);
    - ``bias(q, v, theta, k)``: c + g, shape (n,), N m (N);
    - ``acceleration(q, w, u, theta, k)``: the derivative of w, shape (n + r,); floats have a
      cheaper way (``controlled_system.py``);
    - ``balance(q, w, u, theta, k)``: M column by column (n * n,), then tau - c - g (n,), then the
      derivatives of the own states (r,): the parts that a validated reading solves itself,
      without the graph's own divisions;
    - ``variation(q, w, a, u, theta, k)``: the Jacobian of (tau - c - g - M a, own derivatives) in
      (q, w) for given accelerations a, column by column ((n + r) * (2n + r),);
    - ``conditions(q, w, u, theta, k)``: what must not be zero (the first ``divisors`` entries), and
      what must not be negative, for the values above to exist as they were written;
    - ``effectors(q, theta, k)``: positions, shape (d * e,), metres;
    - ``body_points(q, theta, k)``: positions, shape (d * b,), metres; ``hulls`` says which of
      them span which body.
    """

    model: RobotModel
    gravity: tuple[Fraction, ...]
    coordinates: Coordinates
    constants: tuple[Constant | PiConstant, ...]
    mass_matrix: ca.Function
    bias: ca.Function
    acceleration: ca.Function
    balance: ca.Function
    variation: ca.Function
    effectors: ca.Function
    body_points: ca.Function
    hulls: tuple[tuple[int, ...], ...]
    conditions: ca.Function
    divisors: int


def robot_graph(
    model: RobotModel,
    gravity: tuple[Fraction, ...] = (),
    coordinates: Coordinates | None = None,
) -> RobotGraph:
    """Build the graph of a robot.

    Args:
        model: the robot.
        gravity: the acceleration in m/s^2, default none.
        coordinates: what the motion is written in, default the joints' own coordinates.
    """
    coordinates = coordinates or own_coordinates(model)
    n, r = len(model.dofs), len(robot_states(model))
    q, w, u, a = (
        ca.SX.sym(name, size)
        for name, size in (("q", n), ("w", n + r), ("u", len(robot_inputs(model))), ("a", n))
    )
    v = w[:n]
    theta = ca.SX.sym("theta", len(model.parameters))
    constants = ConstantInputs()
    body = kinematics(model, q, theta, constants, coordinates)
    mass = mass_matrix(model, body, q, constants, coordinates)
    bias = centrifugal(mass, q, v, constants) + gravitational(model, body, q, gravity, constants)
    own = own_motion(coordinates, q), own_motion(coordinates, v)
    driven = drive(model, Motion(*own, w[n:], u, theta), constants)
    force = generalised_forces(coordinates, driven.forces) - bias
    acceleration = ldl_solve(_unfolded(mass, constants), force)
    d = model.dimension
    points = [body.body_points(item) for item in model.bodies]
    hulls, start = [], 0
    for group in points:
        hulls.append(tuple(range(start, start + len(group))))
        start += len(group)
    tips = _stack([body.origins[frame][:d] for frame in model.effectors])
    corners = _stack([point[:d] for group in points for point in group])
    k = constants.vector()

    def function(name: str, inputs: list[ca.SX], output: ca.SX) -> ca.Function:
        return ca.Function(name, [*inputs, theta, k], [ca.cse(ca.densify(output))])

    return RobotGraph(
        model,
        gravity,
        coordinates,
        tuple(constants.symbols),
        function("mass_matrix", [q], mass),
        function("bias", [q, v], bias),
        function("acceleration", [q, w, u], ca.vertcat(acceleration, driven.derivatives)),
        function(
            "balance",
            [q, w, u],
            ca.vertcat(ca.vec(ca.densify(mass)), force, driven.derivatives),
        ),
        function(
            "variation",
            [q, w, a, u],
            _jacobian(ca.vertcat(force - mass @ a, driven.derivatives), ca.vertcat(q, w)),
        ),
        function("effectors", [q], tips),
        function("body_points", [q], corners),
        tuple(hulls),
        function("conditions", [q, w, u], constants.conditions.vector()),
        len(constants.conditions.divisors),
    )


def _unfolded(matrix: ca.SX, constants: ConstantInputs) -> ca.SX:
    """The matrix with its literal entries as inputs, so that quotients of them stay exact."""
    result = ca.SX(matrix)
    for i in range(matrix.size1()):
        for j in range(matrix.size2()):
            result[i, j] = constants.unfolded(matrix[i, j])
    return result


def _jacobian(value: ca.SX, state: ca.SX) -> ca.SX:
    return ca.vec(ca.densify(ca.jacobian(value, state)))


def _stack(columns: list[ca.SX]) -> ca.SX:
    return ca.vertcat(*columns) if columns else ca.SX(0, 1)
