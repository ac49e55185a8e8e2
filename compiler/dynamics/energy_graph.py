"""Kinetic energy as a graph: mass matrix, its factorisation, and what bounds need."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import casadi as ca

from compiler.dynamics.kinematics import Kinematics, kinematics, own_coordinates, rotation
from compiler.dynamics.rigid_bodies import Motion, drive, potential_energy
from compiler.dynamics.symbolic_evaluator import SymbolicEvaluator
from compiler.expressions.scalars import Constant, PiConstant
from compiler.expressions.tape import Tape, tape
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
from compiler.robots.state_and_input import robot_inputs, robot_states

# --- The mass matrix from composite bodies in the frames of the joints ----------------------------
#
# All that a joint carries is one body with mass m, first moment h and inertia I about the joint's
# origin.  Moving the joint gives it the momenta (p, L); with the axis s of an earlier joint,
#
# .. math:: M_{ij} = s_i \cdot L \quad\text{(revolute)}, \qquad M_{ij} = s_i \cdot p
#     \quad\text{(prismatic)}
#
# Only coordinates between the two joints and behind them occur, each in few places, so that
# interval arithmetic loses far less than on the product of Jacobians (``rigid_bodies.py``).
#
# Source: Featherstone, *Rigid Body Dynamics Algorithms* (2008), section 6.2.


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


# --- The LDL^T factorisation of a symmetric positive definite matrix, written out for a graph -----


def ldl_solve(matrix: ca.SX, right: ca.SX) -> ca.SX:
    """``matrix^-1 right`` for a right side of one or more columns; reads the lower triangle.

    Elementary operations only, because validated evaluators need them; no pivoting (Golub & Van
    Loan, *Matrix Computations*, Algorithm 4.1.2).
    """
    n = matrix.size1()
    if not n:
        return ca.SX(0, right.size2())
    lower, scaled = ca.SX.eye(n), ca.SX(n, n)
    inverse = []
    for j in range(n):
        # scaled holds L D, so that no product is formed twice.
        pivot = matrix[j, j] - sum((lower[j, k] * scaled[j, k] for k in range(j)), ca.SX(0))
        inverse.append(1 / pivot)
        for i in range(j + 1, n):
            known = sum((lower[i, k] * scaled[j, k] for k in range(j)), ca.SX(0))
            scaled[i, j] = matrix[i, j] - known
            lower[i, j] = scaled[i, j] * inverse[j]
    rows = [right[i, :] for i in range(n)]
    for i in range(n):
        for k in range(i):
            rows[i] = rows[i] - lower[i, k] * rows[k]
    rows = [row * factor for row, factor in zip(rows, inverse, strict=True)]
    for i in reversed(range(n)):
        for k in range(i + 1, n):
            rows[i] = rows[i] - lower[k, i] * rows[k]
    return ca.vertcat(*rows)


# --- What bounds on energy and on distances need of a robot, as tapes for interval arithmetic -----
#
# All in the joints' own coordinates q: efforts, rates and ranges are of those.  The bounds do not
# depend on coordinates anyway: with q = D y the forces are D' tau and the mass matrix is D' M D, so
# that tau' M^-1 tau and q' M q are the same numbers.


@dataclass(frozen=True, slots=True)
class EnergyGraph:
    """The energies of a robot, and its effectors.

    Inputs of every tape: q (n), theta, then the exact ``constants``.

    - ``mass``: M column by column, (n * n,), of which only the coordinates ``shape`` count;
    - ``slopes``: its derivatives in the inputs ``active``, one after the other;
    - ``potential``: the potential energy V (1,) and its gradient (n,); None without gravity;
    - ``effectors``: positions (d * e,), then their Jacobian column by column (d * e * n,);
    - ``damping``: b >= 0 or not of every joint (n,), where the forces on the joints are u - b rate;
      None where they are anything else, or where modules have states of their own.
    """

    constants: tuple[Constant | PiConstant, ...]
    mass: Tape
    shape: tuple[int, ...]
    slopes: Tape
    active: tuple[int, ...]
    potential: Tape | None
    effectors: Tape
    damping: Tape | None


def energy_graph(model: RobotModel, gravity: tuple[Fraction, ...]) -> EnergyGraph:
    """The graph of a robot.

    Args:
        model: the robot.
        gravity: the acceleration in m/s^2.

    Raises:
        UndefinedValueError: a rule of the robot divides by zero everywhere.
    """
    n, d = len(model.dofs), model.dimension
    q, theta = ca.SX.sym("q", n), ca.SX.sym("theta", len(model.parameters))
    constants = SymbolicEvaluator()
    at = kinematics(model, q, theta, constants, own_coordinates(model))
    mass = ca.vec(ca.densify(composite_mass_matrix(model, at, q, constants)))
    tips = ca.vertcat(ca.SX(0, 1), *(at.origins[frame][:d] for frame in model.effectors))
    effectors = ca.vertcat(tips, ca.vec(ca.densify(ca.jacobian(tips, q))))
    potential = ca.SX(0, 1)
    if any(gravity):
        energy = potential_energy(model, at, gravity, constants)
        potential = ca.vertcat(energy, ca.densify(ca.gradient(energy, q)))
    damping = _damping(model, theta, constants)
    inputs = [q, theta, constants.vector()]
    variables = ca.vertcat(q, theta)
    active = _dependencies(mass, variables)
    slopes = [ca.densify(ca.jacobian(mass, variables[i])) for i in active]

    def read(expression: ca.SX) -> Tape:
        return tape(ca.Function("energy", inputs, [ca.cse(ca.densify(expression))]))

    return EnergyGraph(
        tuple(constants.symbols),
        read(mass),
        _dependencies(mass, q),
        read(ca.vertcat(ca.SX(0, 1), *slopes)),
        active,
        read(potential) if any(gravity) else None,
        read(effectors),
        None if damping is None else read(damping),
    )


def _dependencies(expression: ca.SX, variables: ca.SX) -> tuple[int, ...]:
    """The entries of a column of variables that occur."""
    if not variables.numel():
        return ()
    columns = ca.jacobian_sparsity(expression, variables).get_triplet()[1]
    return tuple(sorted({int(column) for column in columns}))


def _damping(model: RobotModel, theta: ca.SX, constants: SymbolicEvaluator) -> ca.SX | None:
    """The b of every joint, where tau = u - b rate.

    tau has this form if its Jacobian in (q, rate, s, u) is (0, -b, 0, 1) with a diagonal b that
    none of these occurs in, and if it is zero at zero.
    """
    joints = [entry.dof for entry in robot_inputs(model)]
    n, m = len(model.dofs), len(joints)
    places = {dof: place for place, dof in enumerate(joints) if dof is not None}
    if robot_states(model) or len(places) != m or m != n:
        return None
    q, v, u = ca.SX.sym("q", n), ca.SX.sym("v", n), ca.SX.sym("u", m)
    forces = drive(model, Motion(q, v, ca.SX(0, 1), u, theta), constants).forces
    column = ca.vertcat(q, v, u)
    slopes = ca.densify(ca.jacobian(forces, column))
    if ca.depends_on(slopes, column):
        return None
    if not ca.substitute(forces, column, ca.SX.zeros(column.numel())).is_zero():
        return None
    wanted = ca.SX.zeros(n, column.numel())
    for dof, place in places.items():
        wanted[dof, 2 * n + place] = 1
    found = []
    for i in range(n):
        found.append(-slopes[i, n + i])
        wanted[i, n + i] = slopes[i, n + i]
    return ca.vertcat(ca.SX(0, 1), *found) if (slopes - wanted).is_zero() else None
