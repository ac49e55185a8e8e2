"""The two sides of the equations of motion: rigid bodies, and the forces that drive them."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from fractions import Fraction

import casadi as ca

from compiler.dynamics.composite_bodies import composite_mass_matrix
from compiler.dynamics.kinematics import (
    Coordinates,
    Kinematics,
    absolute_angles,
    generalised_forces,
    own_coordinates,
    own_motion,
)
from compiler.dynamics.spatial_inertia import inertia_tensor
from compiler.dynamics.symbolic_evaluator import SymbolicEvaluator
from compiler.expressions.evaluator import evaluate_expression
from compiler.robots.robot import (
    Body,
    Joint,
    OwnDynamics,
    PointBody,
    RobotModel,
    RodBody,
    SolidBody,
    Turn,
)
from compiler.robots.state_and_input import dry_friction, robot_inputs, robot_states
from grammar_lang import ir

# --- Mass matrix, Coriolis forces and gravity of rigid bodies as CasADi expressions ---------------
#
# They follow from kinetic and potential energy (Lagrange's equations of the second kind). The
# kinetic energy is that of composite bodies (``composite_bodies.py``), except for planar robots in
# absolute angles. For these a column of the Jacobian is a vector rotated by at most one angle, J_i
# = R(y_a) w_i, so
#
# .. math:: J_i \cdot J_j = w_i \cdot R(y_b - y_a)\, w_j
#
# Without this rule a product contains a sum of two squares of sines and cosines instead of 1, and a
# sum of products instead of one cosine. Over a box of angles, intervals lose these cancellations.


def inertia_of(
    body: Body, at: Kinematics, constants: SymbolicEvaluator
) -> tuple[ca.SX, ca.SX, ca.SX]:
    """The mass, the position of the centre of mass, and the inertia about it in world axes."""
    half, twelfth = (constants.constant(Fraction(1, i)) for i in (2, 12))
    match body:
        case RodBody(frame, axis, sign, length, density, _):
            extent, mass = at.scalars[length], at.scalars[density] * at.scalars[length]
            direction = sign * at.axis(frame, axis)
            com = at.origins[frame] + direction * (extent * half)
            about = mass * extent**2 * twelfth
            return mass, com, about * (ca.SX.eye(3) - direction @ direction.T)
        case PointBody(frame):
            return at.mass(body), at.origins[frame], ca.SX.zeros(3, 3)
        case SolidBody(frame, mass_scalar, com_local, inertia):
            local = inertia_tensor([at.scalars[i] for i in inertia])
            turn = at.orientations[frame].matrix()
            return at.scalars[mass_scalar], at.point(frame, com_local), turn @ local @ turn.T


def angular_jacobian(
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
        # An absolute angle: the rate of the joint it is measured from cancels.
        for other, entry in enumerate(coordinates.rows[step.dof]):
            if entry and other != step.dof:
                columns[:, other] = 0
        columns[:, step.dof] = at.axis(node, step.axis)
    return columns


def mass_matrix(
    model: RobotModel,
    at: Kinematics,
    y: ca.SX,
    constants: SymbolicEvaluator,
    coordinates: Coordinates,
) -> ca.SX:
    """M, the Hessian of the kinetic energy in the rates of y, shape (n, n)."""
    if has_turned_columns(model, coordinates):
        mass = _turned_mass_matrix(model, at, y, constants, coordinates)
    else:
        mass = composite_mass_matrix(model, at, own_motion(coordinates, y), constants)
        if coordinates != own_coordinates(model):
            mass = _generalised(mass, coordinates)
    rotors = rotor_inertias(model, constants)
    return mass if rotors is None else mass + _generalised(rotors, coordinates)


def rotor_inertias(model: RobotModel, constants: SymbolicEvaluator) -> ca.SX | None:
    """The rotor inertias as their joints feel them, on a diagonal; None if all are 0."""
    if not any(dof.inertia for dof in model.dofs):
        return None
    found = ca.SX.zeros(len(model.dofs), len(model.dofs))
    for number, dof in enumerate(model.dofs):
        if dof.inertia is not None:
            found[number, number] = evaluate_expression(dof.inertia, constants)
    return found


def _generalised(mass: ca.SX, coordinates: Coordinates) -> ca.SX:
    """D' M D: a quadratic form of the joints' own rates, in the rates of y."""
    for _ in range(2):
        columns = [generalised_forces(coordinates, column) for column in ca.horzsplit(mass)]
        mass = ca.horzcat(*columns).T
    return mass


def _turned_mass_matrix(
    model: RobotModel,
    at: Kinematics,
    y: ca.SX,
    constants: SymbolicEvaluator,
    coordinates: Coordinates,
) -> ca.SX:
    """M of a planar robot in absolute angles."""
    total = ca.SX.zeros(len(model.dofs), len(model.dofs))
    for body in model.bodies:
        mass, com, inertia = inertia_of(body, at, constants)
        spin = angular_jacobian(model, at, body.frame, coordinates)[2, :]
        products = planar_products(ca.jacobian(com, y)[:2, :], y, coordinates.absolute)
        total += mass * products + inertia[2, 2] * (spin.T @ spin)
    return total


def centrifugal_forces(mass: ca.SX, q: ca.SX, v: ca.SX, half: ca.SX) -> ca.SX:
    r"""Coriolis and centrifugal forces by Christoffel symbols of the first kind.

    .. math:: c_i = \sum_{jk} \Bigl(\partial_k M_{ij} - \tfrac12 \partial_i M_{jk}\Bigr) v_j v_k

    ``half`` is the exact input that stands for 1/2.
    """
    n, rows = q.numel(), []
    slope = _slopes(mass, q)
    for i in range(n):
        row = ca.SX(0)
        for j in range(n):
            for k in range(j, n):
                # Doubled throughout, and halved once below by an exact input.
                twice = slope[i, j, k] + slope[i, k, j] - slope[j, k, i]
                row += twice * v[j] * v[k] * (1 if j == k else 2)
        rows.append(row * half)
    return ca.vertcat(*rows) if rows else ca.SX(0, 1)


def _slopes(mass: ca.SX, q: ca.SX) -> dict[tuple[int, int, int], ca.SX]:
    """The derivative of M_ij in q_k by (i, j, k); as M is symmetric, computed for i <= j only."""
    n = q.numel()
    pairs = [(i, j) for i in range(n) for j in range(i, n)]
    jacobian = ca.jacobian(ca.vertcat(*(mass[i, j] for i, j in pairs)), q) if pairs else ca.SX()
    return {
        (*places, k): jacobian[number, k]
        for number, (i, j) in enumerate(pairs)
        for places in ((i, j), (j, i))
        for k in range(n)
    }


def gravitational_forces(
    model: RobotModel,
    at: Kinematics,
    q: ca.SX,
    gravity: tuple[Fraction, ...],
    constants: SymbolicEvaluator,
) -> ca.SX:
    """g, the gradient of the potential energy."""
    if not any(gravity):
        return ca.SX.zeros(len(model.dofs))
    return ca.gradient(potential_energy(model, at, gravity, constants), q)


def potential_energy(
    model: RobotModel, at: Kinematics, gravity: tuple[Fraction, ...], constants: SymbolicEvaluator
) -> ca.SX:
    """The potential energy of all bodies in a uniform field of gravity, J."""
    pull = ca.vertcat(*(constants.constant(value) for value in gravity))
    potential = ca.SX(0)
    for body in model.bodies:
        mass, com, _ = inertia_of(body, at, constants)
        potential -= mass * ca.dot(pull, com[: len(gravity)])
    return potential


NORMAL = 2
"""The axis normal to the plane."""


def has_turned_columns(model: RobotModel, coordinates: Coordinates) -> bool:
    """Whether each column is a rotated vector: planar, and no coordinate moves two frames or flips.

    A rotation about an axis other than the plane's normal would change the sign of angles.
    """
    steps = [node.step for node in model.frames]
    uses = Counter(step.dof for step in steps if isinstance(step, Joint))
    turning = {i for i, dof in enumerate(model.dofs) if dof.kind == "revolute"}
    upright = all(
        step.axis == NORMAL
        for step in steps
        if isinstance(step, Turn) or (isinstance(step, Joint) and step.dof in turning)
    )
    alone = all(count == 1 for count in uses.values())
    return model.dimension == 2 and upright and alone and turning <= coordinates.absolute


def coordinates_for_intervals(model: RobotModel) -> Coordinates:
    """The coordinates in which intervals lose least: absolute angles if all columns are rotated.

    Dry friction needs the joints' own coordinates, as it depends on the signs of their rates.
    """
    if dry_friction(model):
        return own_coordinates(model)
    measured = absolute_angles(model)
    return measured if has_turned_columns(model, measured) else own_coordinates(model)


def planar_products(columns: ca.SX, y: ca.SX, absolute: frozenset[int]) -> ca.SX:
    """The matrix of all products of two columns, shape (n, n); ``columns`` is (2, n)."""
    n = columns.size2()
    angles = [_angle(columns[:, i], y, absolute) for i in range(n)]
    found = ca.SX.zeros(n, n)
    for i in range(n):
        for j in range(i, n):
            product = ca.dot(columns[:, i], columns[:, j])
            found[i, j] = found[j, i] = _relative(product, y, angles[i], angles[j])
    return found


def _angle(column: ca.SX, y: ca.SX, absolute: frozenset[int]) -> int | None:
    """The angle by which a column is rotated; None if it is constant."""
    turned = [number for number in sorted(absolute) if ca.depends_on(column, y[number])]
    return turned[0] if turned else None


def _relative(product: ca.SX, y: ca.SX, first: int | None, second: int | None) -> ca.SX:
    """The product of two columns as a function of the angle between them."""
    if first is None or second is None:
        return product
    if first == second:
        return ca.substitute(product, y[first], ca.SX(0))
    between = y[second] - y[first]
    return ca.substitute(product, ca.vertcat(y[first], y[second]), ca.vertcat(0, between))


# --- The generalised forces on a robot's joints, and the derivatives of its modules' own states ---
#
# .. math:: \tau = \tau(q, \dot q, s, u, \theta), \qquad \dot s = \sigma(q, \dot q, s, u, \theta)
#
# A joint without dynamics of its own is driven by its free input alone (Definition 5).


@dataclass(frozen=True, slots=True)
class Drive:
    """Generalised forces (n,) on the joints' own coordinates, and the derivatives of s (r,)."""

    forces: ca.SX
    derivatives: ca.SX


@dataclass(frozen=True, slots=True)
class Motion:
    """The variables of a drive, as columns: the joints' own q and rates, s, u and theta."""

    q: ca.SX
    rates: ca.SX
    states: ca.SX
    inputs: ca.SX
    parameters: ca.SX


def drive(model: RobotModel, motion: Motion, constants: SymbolicEvaluator) -> Drive:
    """The drive of a robot as expressions."""
    state_places = {(s.symbol, s.name): i for i, s in enumerate(robot_states(model))}
    forces = [ca.SX(0)] * len(model.dofs)
    efforts: dict[int, ca.SX] = {}
    declared: dict[tuple[int, str], ca.SX] = {}
    for place, entry in enumerate(robot_inputs(model)):
        if entry.is_load:
            continue
        if entry.dof is None:
            declared[entry.symbol, entry.name] = motion.inputs[place]
        else:
            efforts[entry.dof] = motion.inputs[place]
            forces[entry.dof] = motion.inputs[place]
    derivatives = [ca.SX(0)] * len(state_places)
    for own in model.own:
        reader = _Reader(own, motion, state_places, efforts, declared, constants)
        for state in own.states:
            derivatives[state_places[own.symbol, state.name]] = reader.read(state.derivative)
        for torque in own.torques:
            forces[own.bound_dofs[torque.dof]] = reader.read(torque.value)
    return Drive(_column(forces), _column(derivatives))


@dataclass(frozen=True, slots=True)
class _Reader:
    """Reads the expressions of one module's own dynamics."""

    own: OwnDynamics
    motion: Motion
    states: Mapping[tuple[int, str], int]
    efforts: Mapping[int, ca.SX]
    declared: Mapping[tuple[int, str], ca.SX]
    constants: SymbolicEvaluator

    def read(self, expression: ir.Expr) -> ca.SX:
        """The graph node of a scalar expression."""
        return evaluate_expression(expression, self.constants, self.leaf)

    def leaf(self, leaf: ir.Expr) -> ca.SX:
        """The graph node of a leaf; one that belongs to a removed degree of freedom is zero."""
        match leaf:
            case ir.ParameterOf(_, name):
                return self.motion.parameters[dict(self.own.parameters)[name]]
            case ir.StateOf(_, name):
                return self.motion.states[self.states[self.own.symbol, name]]
            case ir.InputOf(_, name):
                return self.declared[self.own.symbol, name]
            case ir.DofOf(_, name):
                return self.of_dof(name, lambda dof: self.motion.q[dof])
            case ir.RateOf(_, name):
                return self.of_dof(name, lambda dof: self.motion.rates[dof])
            case ir.EffortOf(_, name):
                return self.of_dof(name, lambda dof: self.efforts[dof])
            case _:
                raise TypeError(f"no scalar of a module's own dynamics: {leaf}")

    def of_dof(self, name: str, value: Callable[[int], ca.SX]) -> ca.SX:
        """A value that belongs to a degree of freedom, zero if that was removed."""
        dof = self.own.bound_dofs.get(name)
        return ca.SX(0) if dof is None else value(dof)


def _column(entries: list[ca.SX]) -> ca.SX:
    return ca.vertcat(*entries) if entries else ca.SX(0, 1)
