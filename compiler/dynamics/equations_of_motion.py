r"""The equations of motion of any robot model as one CasADi expression graph.

.. math::
    M(q, \theta)\,\ddot q + c(q, \dot q, \theta) + g(q, \theta) = \tau(q, \dot q, s, u, \theta),
    \qquad \dot s = \sigma(q, \dot q, s, u, \theta)

with the modules' own states s; together one controlled system x' = f(x, theta, u), Definition 5.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from functools import cached_property

import casadi as ca

from compiler.dynamics.energy_graph import ldl_solve
from compiler.dynamics.kinematics import (
    Coordinates,
    Kinematics,
    generalised_forces,
    kinematics,
    own_coordinates,
    own_motion,
)
from compiler.dynamics.rigid_bodies import (
    Motion,
    centrifugal_forces,
    drive,
    gravitational_forces,
    mass_matrix,
)
from compiler.dynamics.robot_points import MADE, Numbering, RobotPoints, robot_points
from compiler.dynamics.symbolic_evaluator import SymbolicEvaluator
from compiler.expressions.scalars import Constant, PiConstant
from compiler.robots.payloads import loads_of
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import robot_inputs, robot_states
from compiler.time_limits.time_limit import check_time

MOST_INSTRUCTIONS = 40_000
"""First derivatives up to this many instructions get second ones, which have 5 to 7 times more."""
MOST_OF_SECOND = 10_000
"""The most instructions of second derivatives for which third ones are made."""


@dataclass(frozen=True, slots=True)
class _Expressions:
    """The variables of a graph, and the expressions of its functions."""

    q: ca.SX
    w: ca.SX
    u: ca.SX
    theta: ca.SX
    k: ca.SX
    half: ca.SX
    points: RobotPoints
    at: Kinematics
    mass: ca.SX
    regular_mass: ca.SX
    gravitational: ca.SX
    forces: ca.SX
    derivatives: ca.SX
    conditions: ca.SX
    loads: ca.SX


@dataclass(frozen=True)
class RobotGraph:
    """The expression graph of a robot, read by several back ends; ``gravity`` is in m/s^2.

    Inputs, each a column: ``q``, ``w`` (the rates v of q, then the modules' own states), ``u``
    (inputs), ``theta`` and ``k``, the exact constants listed in ``constants``.  Where
    ``coordinates`` are absolute angles, ``q`` and ``v`` stand for these and their rates; ``u``
    always holds the joints' own inputs.  With n degrees of freedom, r own states, m inputs, e
    effectors, b body points and d the dimension of the workspace:

    - ``mass_matrix(q, theta, k)``: M, shape (n, n), kg m^2 (kg for prismatic rows), without loads
      (which are picked up and put down); ``loaded_mass_matrix(q, u, theta, k)``: M with them;
    - ``centrifugal(q, v, theta, k)``: c, shape (n,), N m (N), without loads;
    - ``gravitational(q, theta, k)``: g, shape (n,); ``bias(q, v, theta, k)``: c + g; without loads;
    - ``acceleration(q, w, u, theta, k)``: the derivative of w, shape (n + r,); floats have a
      cheaper way (``controlled_system.py``);
    - ``balance(q, w, u, theta, k)``: M column by column (n * n,), then tau - c - g (n,), then the
      derivatives of the own states (r,): the parts from which a validated evaluator solves for the
      accelerations itself, without the graph's own divisions;
    - ``variation(q, w, a, u, theta, k)``: the Jacobian of (tau - c - g - M a, own derivatives) in
      (q, w) for given accelerations a, column by column ((n + r) * (2n + r),);
    - ``input_slopes(q, w, u, theta, k)``: the Jacobian of (tau - c - g, own derivatives) in u,
      column by column ((n + r) * m,);
    - ``conditions(q, w, u, theta, k)``: quantities that must not be zero (the first ``divisors``
      entries) or not negative (the others), so that the values above exist as they were written;
    - ``effectors(q, theta, k)``: positions, shape (d * e,), metres;
    - ``body_points(q, theta, k)``: positions, shape (d * b,), metres; ``points(q, theta, k)``:
      effectors, body points, differences and directions (:mod:`compiler.dynamics.robot_points`).

    A function is made when it is first asked for: their sizes differ by orders of magnitude.
    """

    model: RobotModel
    gravity: tuple[Fraction, ...]
    coordinates: Coordinates
    constants: tuple[Constant | PiConstant, ...]
    divisors: int
    parts: _Expressions = field(repr=False)

    @cached_property
    def holding_inputs(self) -> RobotGraph:
        """A robot whose old inputs are constant states, to which its new inputs are added.

        ``w`` has m more entries, the held inputs; the new inputs ``u`` (m,) are added to them.
        """
        p = self.parts
        held, added = (ca.SX.sym(name, p.u.numel()) for name in ("held", "added"))
        read = [p.mass, p.regular_mass, p.gravitational, p.forces, p.derivatives, p.conditions]
        found = ca.substitute([*read, p.loads], [p.u], [held + added])
        parts = _Expressions(p.q, p.w, added, p.theta, p.k, p.half, p.points, p.at, *found)
        return replace(self, parts=_with_still(parts, held))

    def weighed(self, groups: Sequence[Sequence[int]]) -> RobotGraph:
        """A robot with masses multiplied by factors, which are the last entries of ``w``.

        Each factor applies to all masses and inertias of a group of bodies, given by number; a body
        may be in several ``groups``.
        """
        factors = ca.SX.sym("factor", len(groups))
        alike: dict[tuple[int, ...], list[int]] = {}
        for body in range(len(self.model.bodies)):
            weights = tuple(i for i, group in enumerate(groups) if body in group)
            alike.setdefault(weights, []).append(body)
        mass, regular, pull = self._of_bodies((), rotors=True)
        for weights, bodies in alike.items():
            weight = ca.SX(1)
            for number in weights:
                weight *= factors[number]
            part = self._of_bodies(bodies)
            mass, regular, pull = (
                total + weight * own for total, own in zip((mass, regular, pull), part, strict=True)
            )
        parts = replace(self.parts, mass=mass, regular_mass=regular, gravitational=pull)
        return replace(self, parts=_with_still(parts, factors))

    def efforts_of(self, groups: Sequence[Sequence[int]]) -> ca.Function:
        """The forces M a + c + g that the bodies of each group require, one column per group.

        Its inputs are ``q``, ``w``, the accelerations a (n,), ``u``, ``theta`` and ``k``.
        """
        q, v, a = self.parts.q, self._rates, ca.SX.sym("a", len(self.model.dofs))
        columns = []
        for group in groups:
            mass, _, pull = self._of_bodies(group)
            columns.append(mass @ a + centrifugal_forces(mass, q, v, self.parts.half) + pull)
        return self._function("efforts", [q, self.parts.w, a, self.parts.u], ca.horzcat(*columns))

    def _of_bodies(
        self, bodies: Sequence[int], *, rotors: bool = False
    ) -> tuple[ca.SX, ca.SX, ca.SX]:
        """The part of M, of M without literal entries, and of g from some bodies, or ``rotors``."""
        p = self.parts
        plain = not any(dof.inertia for dof in self.model.dofs)
        if plain and rotors:
            return ca.SX(0), ca.SX(0), ca.SX(0)
        if plain and len(bodies) == len(self.model.bodies):
            return p.mass, p.regular_mass, p.gravitational
        constants = SymbolicEvaluator()
        at = kinematics(self.model, p.q, p.theta, constants, self.coordinates, p.loads)
        dofs = self.model.dofs if rotors else (replace(d, inertia=None) for d in self.model.dofs)
        kept = tuple(self.model.bodies[i] for i in bodies)
        model = replace(self.model, bodies=kept, dofs=tuple(dofs))
        mass = mass_matrix(model, at, p.q, constants, self.coordinates)
        pull = gravitational_forces(model, at, p.q, self.gravity, constants)
        # The constants of a part are among the constants of the whole.
        known = [self.constants.index(symbol) for symbol in constants.symbols]
        k = ca.vertcat(*(p.k[i] for i in known)) if known else ca.SX(0, 1)
        mass, pull = ca.substitute([mass, pull], [constants.vector()], [k])
        return mass, mass, pull

    def _function(self, name: str, inputs: Sequence[ca.SX], output: ca.SX) -> ca.Function:
        columns = [*inputs, self.parts.theta, self.parts.k]
        check_time(MADE)
        shared = ca.cse(ca.densify(output))
        check_time(MADE)
        return ca.Function(name, columns, [shared])

    @property
    def _rates(self) -> ca.SX:
        return self.parts.w[: len(self.model.dofs)]

    @cached_property
    def _centrifugal(self) -> ca.SX:
        return centrifugal_forces(self.parts.mass, self.parts.q, self._rates, self.parts.half)

    @property
    def _drive(self) -> ca.SX:
        """Tau - c - g."""
        return self.parts.forces - self._centrifugal - self.parts.gravitational

    @cached_property
    def mass_matrix(self) -> ca.Function:
        """M without loads."""
        return self._function("mass_matrix", [self.parts.q], self._unloaded(self.parts.mass))

    @cached_property
    def loaded_mass_matrix(self) -> ca.Function:
        """M."""
        return self._function("mass_matrix", [self.parts.q, self.parts.u], self.parts.mass)

    def _unloaded(self, expression: ca.SX) -> ca.SX:
        loads, none = self.parts.loads, ca.SX.zeros(self.parts.loads.shape)
        return ca.substitute(expression, loads, none) if loads.numel() else expression

    @cached_property
    def centrifugal(self) -> ca.Function:
        """Centrifugal and Coriolis forces c."""
        forces = self._unloaded(self._centrifugal)
        return self._function("centrifugal", [self.parts.q, self._rates], forces)

    @cached_property
    def gravitational(self) -> ca.Function:
        """Gravitational forces g."""
        pull = self._unloaded(self.parts.gravitational)
        return self._function("gravitational", [self.parts.q], pull)

    @cached_property
    def bias(self) -> ca.Function:
        """The sum of c and g."""
        both = self._unloaded(self._centrifugal + self.parts.gravitational)
        return self._function("bias", [self.parts.q, self._rates], both)

    @cached_property
    def acceleration(self) -> ca.Function:
        """The derivative of w."""
        p = self.parts
        rates = ca.vertcat(ldl_solve(p.regular_mass, self._drive), p.derivatives)
        return self._function("acceleration", [p.q, p.w, p.u], rates)

    @cached_property
    def balance(self) -> ca.Function:
        """M, tau - c - g and the derivatives of the modules' own states."""
        p = self.parts
        items = ca.vertcat(ca.vec(ca.densify(p.mass)), self._drive, p.derivatives)
        return self._function("balance", [p.q, p.w, p.u], items)

    @cached_property
    def variation(self) -> ca.Function:
        """The Jacobian of the balance, for given accelerations."""
        p, a = self.parts, ca.SX.sym("a", len(self.model.dofs))
        residual = ca.vertcat(self._drive - p.mass @ a, p.derivatives)
        jacobian = ca.jacobian(residual, ca.vertcat(p.q, p.w))
        return self._function("variation", [p.q, p.w, a, p.u], ca.vec(ca.densify(jacobian)))

    @cached_property
    def curvature(self) -> tuple[ca.Function, tuple[tuple[int, int, int], ...]] | None:
        """The non-zero second derivatives of the balance, and their indices.

        An index (i, j, k), j >= k, means output i and entries j and k of (q, w, a). None if
        ``variation`` has so many instructions that its derivatives would take minutes.
        """
        if self.variation.n_instructions() > MOST_INSTRUCTIONS:
            return None
        p, a = self.parts, ca.SX.sym("a", len(self.model.dofs))
        residual = ca.vertcat(self._drive - p.mass @ a, p.derivatives)
        entries = ca.vertcat(p.q, p.w, a)
        first = ca.jacobian(residual, entries)
        second = ca.jacobian(first.nz[:], entries)
        rows, columns = first.sparsity().get_triplet()
        places, kept = [], []
        for number, (entry, k) in enumerate(zip(*second.sparsity().get_triplet(), strict=True)):
            if columns[entry] >= k:
                places.append((rows[entry], columns[entry], k))
                kept.append(number)
        values = second.nz[kept] if kept else ca.SX(0, 1)
        return self._function("curvature", [p.q, p.w, a, p.u], ca.vertcat(values)), tuple(places)

    @cached_property
    def curvature_slopes(self) -> tuple[ca.Function, tuple[tuple[int, int], ...]] | None:
        """The non-zero first derivatives of the values of ``curvature``, and their indices.

        An index (v, l) means value v and entry l of (q, w, a). None if ``curvature`` has so many
        instructions that the derivatives take longer than they save.
        """
        if self.curvature is None or self.curvature[0].n_instructions() > MOST_OF_SECOND:
            return None
        p, a = self.parts, ca.SX.sym("a", len(self.model.dofs))
        entries = ca.vertcat(p.q, p.w, a)
        values = self.curvature[0](p.q, p.w, a, p.u, p.theta, p.k)
        slopes = ca.jacobian(values, entries)
        places = tuple(zip(*slopes.sparsity().get_triplet(), strict=True))
        kept = slopes.nz[:] if places else ca.SX(0, 1)
        return self._function("curvature_slopes", [p.q, p.w, a, p.u], kept), places

    @cached_property
    def input_slopes(self) -> ca.Function:
        """The Jacobian, in the inputs, of the forces and of the own derivatives."""
        p = self.parts
        jacobian = ca.jacobian(ca.vertcat(p.forces, p.derivatives), p.u)
        return self._function("input_slopes", [p.q, p.w, p.u], ca.vec(ca.densify(jacobian)))

    @cached_property
    def conditions(self) -> ca.Function:
        """Divisors, then radicands."""
        p = self.parts
        return self._function("conditions", [p.q, p.w, p.u], p.conditions)

    @cached_property
    def effectors(self) -> ca.Function:
        """Positions of the effectors."""
        return self._function("effectors", [self.parts.q], self.parts.points.effectors)

    @cached_property
    def body_points(self) -> ca.Function:
        """Positions of the base points of bodies and shapes."""
        return self._function("body_points", [self.parts.q], self.parts.points.bodies)

    @cached_property
    def sizes(self) -> ca.Function:
        """The sizes of the shapes, in metres."""
        return self._function("sizes", [], self.parts.points.sizes)

    @property
    def numbering(self) -> Numbering:
        """The numbers of the points of each collider, pair and effector frame."""
        return self.parts.points.numbering

    @property
    def _points(self) -> ca.SX:
        points = self.parts.points
        return ca.vertcat(points.effectors, points.bodies, points.others)

    @cached_property
    def points(self) -> ca.Function:
        """Effectors, body points, differences, directions."""
        return self._function("points", [self.parts.q], self._points)

    @cached_property
    def point_slopes(self) -> ca.Function:
        """The Jacobian of the points in the coordinates, column by column."""
        jacobian = ca.jacobian(self._points, self.parts.q)
        return self._function("point_slopes", [self.parts.q], ca.vec(ca.densify(jacobian)))


def robot_graph(
    model: RobotModel,
    gravity: tuple[Fraction, ...] = (),
    coordinates: Coordinates | None = None,
) -> RobotGraph:
    """The graph of a robot.

    Args:
        model: the robot.
        gravity: the acceleration in m/s^2, default none.
        coordinates: the coordinates of the motion, default the joints' own.
    """
    coordinates = coordinates or own_coordinates(model)
    n, r, m = len(model.dofs), len(robot_states(model)), len(robot_inputs(model))
    q, w, u = (ca.SX.sym(name, size) for name, size in (("q", n), ("w", n + r), ("u", m)))
    theta = ca.SX.sym("theta", len(model.parameters))
    # All constants are collected here, so that every function has the same inputs k.
    constants = SymbolicEvaluator()
    half = constants.constant(Fraction(1, 2))
    loads = u[m - len(loads_of(model)) :]
    body = kinematics(model, q, theta, constants, coordinates, loads)
    check_time(MADE)
    mass = mass_matrix(model, body, q, constants, coordinates)
    check_time(MADE)
    pull = gravitational_forces(model, body, q, gravity, constants)
    own = own_motion(coordinates, q), own_motion(coordinates, w[:n])
    driven = drive(model, Motion(*own, w[n:], u, theta), constants)
    regular = _unfolded(mass, constants)
    points = robot_points(body)
    forces = generalised_forces(coordinates, driven.forces)
    parts = _Expressions(
        q, w, u, theta, constants.vector(), half, points, body, mass, regular, pull,
        forces, driven.derivatives, constants.conditions.vector(), loads,
    )  # fmt: skip
    divisors = len(constants.conditions.divisors)
    symbols = tuple(constants.symbols)
    return RobotGraph(model, gravity, coordinates, symbols, divisors, parts)


def _with_still(parts: _Expressions, entries: ca.SX) -> _Expressions:
    """Add constant entries to the modules' own states."""
    return replace(
        parts,
        w=ca.vertcat(parts.w, entries),
        derivatives=ca.vertcat(parts.derivatives, ca.SX(entries.numel(), 1)),
    )


def _unfolded(matrix: ca.SX, constants: SymbolicEvaluator) -> ca.SX:
    """The matrix with its literal entries as inputs, so that quotients of them stay exact."""
    result = ca.SX(matrix)
    for i in range(matrix.size1()):
        for j in range(matrix.size2()):
            result[i, j] = constants.unfolded(matrix[i, j])
    return result
