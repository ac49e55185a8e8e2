r"""Equations of motion of any robot model as one CasADi expression graph.

.. math:: M(q, \theta)\,\ddot q + c(q, \dot q, \theta) + g(q, \theta) = u

from the kinetic and potential energy of its bodies (Lagrange's equations of the second kind).
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import casadi as ca

from compiler.arithmetic.scalars import Constant, PiConstant
from compiler.dynamics.absolute_angles import Coordinates, own_coordinates
from compiler.dynamics.kinematics import ConstantInputs, Kinematics, kinematics
from compiler.robots.robot import Body, Joint, PointBody, RobotModel, RodBody, SolidBody


@dataclass(frozen=True, slots=True)
class RobotGraph:
    """One robot's expression graph, read by several back ends.

    Inputs, each a column: ``q``, ``v`` (rates), ``u`` (free inputs), ``theta`` and ``k``, the
    exact constants listed in ``constants``.  Where ``coordinates`` are absolute angles, ``q`` and
    ``v`` stand for those and their rates; ``u`` are the joints' own inputs always.  With n degrees
    of freedom, e effectors, b body points and d the dimension of the workspace:

    - ``mass_matrix(q, theta, k)``: M, shape (n, n), kg m^2 (kg for prismatic rows);
    - ``bias(q, v, theta, k)``: c + g, shape (n,), N m (N);
    - ``acceleration(q, v, u, theta, k)``: the second derivative of q, shape (n,);
    - ``balance(q, v, u, theta, k)``: M column by column (n * n,), then u - c - g (n,): the parts
      that a validated reading solves itself, without the graph's own divisions;
    - ``variation(q, v, a, u, theta, k)``: the Jacobian of u - c - g - M a in (q, v) for given
      accelerations a, column by column (n * 2n,);
    - ``effectors(q, theta, k)``: positions, shape (d * e,), metres;
    - ``body_points(q, theta, k)``: positions, shape (d * b,), metres; ``hulls`` says which of
      them span which body.
    """

    model: RobotModel
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
    n = len(model.dofs)
    q, v, u, a = (ca.SX.sym(name, n) for name in "qvua")
    theta = ca.SX.sym("theta", len(model.parameters))
    constants = ConstantInputs()
    body = kinematics(model, q, theta, constants, coordinates)
    mass = _mass_matrix(model, body, q, constants, coordinates)
    bias = _bias(mass, q, v, constants) + _gravity(model, body, q, gravity, constants)
    drive = _generalised(coordinates, u) - bias
    acceleration = _solve(_unfolded(mass, constants), drive) if n else ca.SX(0, 1)
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
        coordinates,
        tuple(constants.symbols),
        function("mass_matrix", [q], mass),
        function("bias", [q, v], bias),
        function("acceleration", [q, v, u], acceleration),
        function("balance", [q, v, u], ca.vertcat(ca.vec(ca.densify(mass)), drive)),
        function("variation", [q, v, a, u], _jacobian(drive - mass @ a, ca.vertcat(q, v))),
        function("effectors", [q], tips),
        function("body_points", [q], corners),
        tuple(hulls),
    )


def _unfolded(matrix: ca.SX, constants: ConstantInputs) -> ca.SX:
    """The matrix with its literal entries as inputs, so that quotients of them stay exact."""
    result = ca.SX(matrix)
    for i in range(matrix.size1()):
        for j in range(matrix.size2()):
            result[i, j] = constants.unfolded(matrix[i, j])
    return result


def _generalised(coordinates: Coordinates, u: ca.SX) -> ca.SX:
    """The joints' own inputs as generalised forces: D' u, by virtual work."""
    rows = coordinates.rows
    forces = [ca.SX(0)] * len(rows)
    for i, row in enumerate(rows):
        for j, entry in enumerate(row):
            if entry:
                forces[j] = forces[j] + (u[i] if entry > 0 else -u[i])
    return _stack(forces)


def _jacobian(value: ca.SX, state: ca.SX) -> ca.SX:
    return ca.vec(ca.densify(ca.jacobian(value, state)))


def _stack(columns: list[ca.SX]) -> ca.SX:
    return ca.vertcat(*columns) if columns else ca.SX(0, 1)


def _inertia(body: Body, at: Kinematics, constants: ConstantInputs) -> tuple[ca.SX, ca.SX, ca.SX]:
    """Mass, position of the com, and inertia about it in world axes."""
    half, twelfth = (constants.read(Constant(Fraction(1, i))) for i in (2, 12))
    match body:
        case RodBody(frame, axis, sign, length, density, _):
            extent, mass = at.scalars[length], at.scalars[density] * at.scalars[length]
            direction = sign * at.axis(frame, axis)
            com = at.origins[frame] + direction * (extent * half)
            about = mass * extent**2 * twelfth
            return mass, com, about * (ca.SX.eye(3) - direction @ direction.T)
        case PointBody(frame, mass_scalar):
            return at.scalars[mass_scalar], at.origins[frame], ca.SX.zeros(3, 3)
        case SolidBody(frame, mass_scalar, com_local, inertia):
            local = ca.SX.zeros(3, 3)
            items = [at.scalars[i] for i in inertia]
            if len(items) == 1:
                local[2, 2] = items[0]
            else:
                places = [(0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)]
                for (row, column), item in zip(places, items, strict=True):
                    local[row, column] = item
                    local[column, row] = item
            turn = at.orientations[frame].matrix()
            return at.scalars[mass_scalar], at.point(frame, com_local), turn @ local @ turn.T


def _angular_jacobian(
    model: RobotModel, at: Kinematics, frame: int, coordinates: Coordinates
) -> ca.SX:
    """The Jacobian of the angular velocity of a frame in y, shape (3, n)."""
    columns = ca.SX.zeros(3, len(model.dofs))
    for node in model.chain(frame):
        step = model.frames[node].step
        if not isinstance(step, Joint) or model.dofs[step.dof].kind != "revolute":
            continue
        if step.dof not in coordinates.absolute:
            columns[:, step.dof] += step.sign * at.axis(node, step.axis)
            continue
        # Measured from a fixed direction: the rate of the joint it is measured from drops out.
        for other, entry in enumerate(coordinates.rows[step.dof]):
            if entry and other != step.dof:
                columns[:, other] = 0
        columns[:, step.dof] = at.axis(node, step.axis)
    return columns


def _mass_matrix(
    model: RobotModel,
    at: Kinematics,
    q: ca.SX,
    constants: ConstantInputs,
    coordinates: Coordinates,
) -> ca.SX:
    """M, the Hessian of the kinetic energy in the rates."""
    total = ca.SX.zeros(len(model.dofs), len(model.dofs))
    for body in model.bodies:
        mass, com, inertia = _inertia(body, at, constants)
        linear = ca.jacobian(com, q)
        angular = _angular_jacobian(model, at, body.frame, coordinates)
        if model.dimension == 2:
            spin = angular[2, :]
            total += mass * (linear.T @ linear) + inertia[2, 2] * (spin.T @ spin)
        else:
            total += mass * (linear.T @ linear) + angular.T @ inertia @ angular
    return total


def _bias(mass: ca.SX, q: ca.SX, v: ca.SX, constants: ConstantInputs) -> ca.SX:
    r"""Coriolis and centrifugal forces by Christoffel symbols of the first kind.

    .. math:: c_i = \sum_{jk} \Bigl(\partial_k M_{ij} - \tfrac12 \partial_i M_{jk}\Bigr) v_j v_k
    """
    n, rows = q.numel(), []
    half = constants.read(Constant(Fraction(1, 2)))
    for i in range(n):
        row = ca.SX(0)
        for j in range(n):
            for k in range(j, n):
                # Doubled throughout, and halved once by an exact input below.
                term = ca.jacobian(mass[i, j], q[k]) + ca.jacobian(mass[i, k], q[j])
                twice = term - ca.jacobian(mass[j, k], q[i])
                row += twice * v[j] * v[k] * (1 if j == k else 2)
        rows.append(row * half)
    return _stack(rows)


def _gravity(
    model: RobotModel,
    at: Kinematics,
    q: ca.SX,
    gravity: tuple[Fraction, ...],
    constants: ConstantInputs,
) -> ca.SX:
    """g, the gradient of the potential energy."""
    if not any(gravity):
        return ca.SX.zeros(len(model.dofs))
    pull = ca.vertcat(*(constants.read(Constant(value)) for value in gravity))
    potential = ca.SX(0)
    for body in model.bodies:
        mass, com, _ = _inertia(body, at, constants)
        potential -= mass * ca.dot(pull, com[: len(gravity)])
    return ca.gradient(potential, q)


def _solve(matrix: ca.SX, right: ca.SX) -> ca.SX:
    """``matrix^-1 right`` by the LDL^T factorisation of a symmetric positive definite matrix.

    Written out, because the validated reading needs elementary operations only.
    """
    n = right.numel()
    lower, diagonal = ca.SX.eye(n), [ca.SX(0)] * n
    for j in range(n):
        diagonal[j] = matrix[j, j] - sum(
            (lower[j, k] ** 2 * diagonal[k] for k in range(j)), ca.SX(0)
        )
        for i in range(j + 1, n):
            known = sum((lower[i, k] * lower[j, k] * diagonal[k] for k in range(j)), ca.SX(0))
            lower[i, j] = (matrix[i, j] - known) / diagonal[j]
    y = [ca.SX(0)] * n
    for i in range(n):
        y[i] = right[i] - sum((lower[i, k] * y[k] for k in range(i)), ca.SX(0))
    x = [ca.SX(0)] * n
    for i in reversed(range(n)):
        above = sum((lower[k, i] * x[k] for k in range(i + 1, n)), ca.SX(0))
        x[i] = y[i] / diagonal[i] - above
    return _stack(x)
