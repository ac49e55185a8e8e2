"""The energies of a robot and the factorisation of its mass matrix, as bounds need them."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import casadi as ca

from compiler.dynamics.composite_bodies import composite_mass_matrix
from compiler.dynamics.effector_mass import effector_mass
from compiler.dynamics.kinematics import kinematics, own_coordinates
from compiler.dynamics.rigid_bodies import Motion, drive, potential_energy, rotor_inertias
from compiler.dynamics.symbolic_evaluator import SymbolicEvaluator
from compiler.expressions.scalars import Constant, PiConstant
from compiler.expressions.tape import Tape, tape
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import robot_inputs, robot_states

# --- The LDL^T factorisation of a symmetric positive definite matrix, written out for a graph -----


def ldl_solve(matrix: ca.SX, right: ca.SX) -> ca.SX:
    """``matrix^-1 right`` for a right side of one or more columns; reads the lower triangle.

    It uses elementary operations only, because validated evaluators need them, and no pivoting
    (Golub & Van Loan, *Matrix Computations*, Algorithm 4.1.2).
    """
    n = matrix.size1()
    if not n:
        return ca.SX(0, right.size2())
    lower, scaled = ca.SX.eye(n), ca.SX(n, n)
    inverse = []
    for j in range(n):
        # ``scaled`` is L D, so that no product is computed twice.
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
# Everything is in the joints' own coordinates q, to which efforts, rates and ranges refer. The
# bounds do not depend on the coordinates anyway: with q = D y the forces are D' tau and the mass
# matrix is D' M D, so tau' M^-1 tau and q' M q are the same numbers.


@dataclass(frozen=True, slots=True)
class EnergyGraph:
    """The energies of a robot, and its effectors.

    Inputs of every tape: q (n), theta, then the exact ``constants``.

    - ``mass``: M with the rotors, column by column, (n * n,); it depends only on the coordinates
      ``shape``;
    - ``slopes``: its derivatives in the inputs ``active``, one after another;
    - ``potential``: the potential energy V (1,) and its gradient (n,); None without gravity;
    - ``effectors``: positions (d * e,), then their Jacobian column by column (d * e * n,);
    - ``carried``: the masses that move with the effectors (e,), then the amounts that must not be
      negative for this, then the ``minors`` that must be positive;
    - ``damping``: b of every joint (n,), of any sign, if the forces on the joints are u - b rate;
      None if they have another form, or if modules have states of their own.
    """

    constants: tuple[Constant | PiConstant, ...]
    mass: Tape
    shape: tuple[int, ...]
    slopes: Tape
    active: tuple[int, ...]
    potential: Tape | None
    effectors: Tape
    carried: Tape
    minors: int
    damping: Tape | None


def energy_graph(model: RobotModel, gravity: tuple[Fraction, ...]) -> EnergyGraph:
    """The energy graph of a robot.

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
    matrix = composite_mass_matrix(model, at, q, constants)
    rotors = rotor_inertias(model, constants)
    mass = ca.vec(ca.densify(matrix if rotors is None else matrix + rotors))
    tips = ca.vertcat(ca.SX(0, 1), *(at.origins[frame][:d] for frame in model.effectors))
    effectors = ca.vertcat(tips, ca.vec(ca.densify(ca.jacobian(tips, q))))
    potential = ca.SX(0, 1)
    if any(gravity):
        energy = potential_energy(model, at, gravity, constants)
        potential = ca.vertcat(energy, ca.densify(ca.gradient(energy, q)))
    damping = _damping(model, theta, constants)
    carried = effector_mass(model, at, constants)
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
        read(ca.vertcat(carried.masses, carried.amounts, carried.minors)),
        carried.minors.numel(),
        None if damping is None else read(damping),
    )


def _dependencies(expression: ca.SX, variables: ca.SX) -> tuple[int, ...]:
    """The entries of a column of variables that occur in an expression."""
    if not variables.numel():
        return ()
    columns = ca.jacobian_sparsity(expression, variables).get_triplet()[1]
    return tuple(sorted({int(column) for column in columns}))


def _damping(model: RobotModel, theta: ca.SX, constants: SymbolicEvaluator) -> ca.SX | None:
    """The b of every joint if tau = u - b rate, else None.

    tau has this form if its Jacobian in (q, rate, s, u) is (0, -b, 0, 1) with a diagonal b in which
    none of these variables occurs, and if it is zero at zero.
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
