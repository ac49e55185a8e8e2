"""A robot in doubles: its equations of motion, over all steps at once.

The discrete step and its exact derivatives are computed by ``step_map``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TypeAlias, TypeVar

import casadi as ca
import numpy as np

from compiler.arrays import Array
from compiler.discretisation.batched_function import BatchedFunction, batched
from compiler.discretisation.numeric_points import NumericPoints
from compiler.dynamics.controlled_system import ControlledSystem, controlled_system
from compiler.dynamics.equations_of_motion import RobotGraph
from compiler.robots.state_and_input import robot_inputs, robot_states

Groups: TypeAlias = tuple[tuple[int, ...], ...]
"""Groups of bodies, by number."""


@dataclass(frozen=True, slots=True)
class Linearisation:
    """The step map about (x, u, theta) at K samples: value and Jacobians.

    Shapes: value (K, N), state (K, N, N), input (K, N, m), parameter (K, N, p).
    """

    value: Array
    state: Array
    input: Array
    parameter: Array


class NumericRobot(NumericPoints):
    """Evaluates a robot's graph in doubles; not for proofs.

    A state x has N = 2n + r entries: n coordinates, n rates and the r states of the modules; there
    are m inputs and p parameters. All are in SI units.
    """

    def __init__(self, graph: RobotGraph) -> None:
        super().__init__(graph)
        self.r = len(robot_states(graph.model))
        self.m = len(robot_inputs(graph.model))
        self.size = 2 * self.n + self.r
        self._rollouts: dict[tuple[str, int, int], ca.Function] = {}
        self._burdens: dict[Groups, BatchedFunction] = {}

    # Made when first needed: most structures are judged by their points alone.

    @cached_property
    def _system(self) -> ControlledSystem:
        return controlled_system(self.graph)

    @cached_property
    def _rates(self) -> BatchedFunction:
        return BatchedFunction.of(rates_of_change(self._system))

    @cached_property
    def _step(self) -> BatchedFunction:
        system, width = self._system, 1 + self.size + self.m + self.p
        return BatchedFunction(lambda batch: step_map(system, batch), (self.size, width))

    @cached_property
    def _mass_matrix(self) -> BatchedFunction:
        """M column by column, so that a row of results is one column of it."""
        function = self.graph.loaded_mass_matrix
        q, u = ca.SX.sym("q", self.n), ca.SX.sym("u", self.m)
        p, k = function.size1_in(2), function.size1_in(3)
        shared = ca.SX.sym("shared", p + k)
        mass = function(q, u, *ca.vertsplit(shared, [0, p, p + k]))
        square = ca.reshape(ca.densify(mass), self.n, self.n)
        return BatchedFunction.of(ca.Function("mass", [q, u, shared], [ca.cse(square)]))

    def acceleration(self, x: Array, u: Array, theta: Array) -> tuple[Array, Array]:
        """The derivative of rates and own states (K, n + r), and its Jacobian in (x, u, theta).

        The Jacobian has the shape (K, n + r, N + m + p).
        """
        shared = np.concatenate([theta, self._system.constants])
        found = self._rates((x, u), shared)
        return found[:, :, 0], found[:, :, 1:]

    def step(self, x: Array, u: Array, theta: Array, dt: float, substeps: int) -> Linearisation:
        """The state ``dt`` seconds later and its Jacobians; x (K, N), u (K, m), theta (p,).

        The step consists of ``substeps`` equal steps of the classical Runge-Kutta method with the
        inputs held.
        """
        size = self.size
        shared = np.concatenate([theta, self._system.constants, [dt / substeps]])
        found = self._step((x, u), shared)
        for _ in range(substeps - 1):
            further = self._step((found[:, :, 0], u), shared)
            carried = further[:, :, 1 : 1 + size] @ found[:, :, 1:]
            found[:, :, 0] = further[:, :, 0]
            found[:, :, 1:] = carried
            found[:, :, 1 + size :] += further[:, :, 1 + size :]
        value, state, input_, parameter = np.split(found, [1, 1 + size, 1 + size + self.m], axis=2)
        return Linearisation(value[:, :, 0], state, input_, parameter)

    def simulate(self, x: Array, u: Array, theta: Array, dt: float, substeps: int) -> Array:
        """States (k + 1, N) from an initial one (N,) under inputs (k, m), by the step map.

        Every input is held for ``dt`` seconds.
        """
        key = ("simulate", len(u), substeps)
        if key not in self._rollouts:
            self._rollouts[key] = _rollout(self._system, substeps, len(u))
        tail = np.concatenate([theta, self._system.constants, [dt / substeps]])
        columns = np.tile(tail[:, None], (1, len(u)))
        states = self._rollouts[key](x, np.concatenate([u.T, columns]))
        return np.concatenate([x[None, :], np.asarray(states.full()).T])

    def mass_matrix(self, q: Array, theta: Array, u: Array | None = None) -> Array:
        """M at K samples, (K, n, n), in kg m^2 (kg for prismatic rows); q (K, n), theta (p,).

        Loads are present as the inputs (K, m) say; without inputs they are absent.
        """
        inputs = np.zeros((len(q), self.m)) if u is None else u
        return self._mass_matrix((q, inputs), np.concatenate([theta, self.constants]))

    def slowed(
        self, groups: Groups, x: Array, accelerations: Array, u: Array, theta: Array
    ) -> Array:
        """The accelerations due to the bodies of each group, M^-1 (M_i a + c_i + g_i).

        Shape (K, n, groups), for states (K, N), accelerations (K, n), inputs (K, m) and parameters
        theta (p,).
        """
        if groups not in self._burdens:
            self._burdens[groups] = BatchedFunction.of(_efforts(self.graph, groups))
        columns = x[:, : self.n], x[:, self.n :], accelerations, u
        asked = self._burdens[groups](columns, np.concatenate([theta, self.constants]))
        return np.asarray(np.linalg.solve(self.mass_matrix(x[:, : self.n], theta, u), asked))


def _efforts(graph: RobotGraph, groups: Groups) -> ca.Function:
    """The forces that groups of bodies require of the joints, with theta and k in one column."""
    function = graph.efforts_of(groups)
    sizes = [function.size1_in(i) for i in range(function.n_in())]
    *own, shared = (ca.SX.sym("i", size) for size in (*sizes[:4], sum(sizes[4:])))
    value = function(*own, *ca.vertsplit(shared, [0, sizes[4], sum(sizes[4:])]))
    return ca.Function("efforts", [*own, shared], [ca.densify(value)])


def _rollout(system: ControlledSystem, substeps: int, steps: int) -> ca.Function:
    """All steps of the classical Runge-Kutta method in one call."""
    step = value_map(system)
    x, extra = (ca.SX.sym(name, step.size1_in(i)) for i, name in enumerate(("x", "e")))
    after = x
    for _ in range(substeps):
        after = step(after, extra)
    return ca.Function("step", [x, extra], [after]).mapaccum("simulate", steps)


# --- The discrete step of a controlled system, and its derivatives, as functions of one sample ----
#
# The step is the classical Runge-Kutta method with inputs held (Kutta 1901). Its derivatives follow
# from the variational equations, so they are exactly those of the step (Hairer, Norsett & Wanner,
# *Solving Ordinary Differential Equations I*, I.14). It is written for q' = v (as by Nystrom,
# ibid., II.14): the stages of q are known polynomials in the accelerations, and so are their
# derivatives, so only the derivatives of w' must be solved for.


Graph = TypeVar("Graph", ca.SX, ca.MX)

NODES = (0.0, 0.5, 0.5, 1.0)


def rates_of_change(system: ControlledSystem) -> ca.Function:
    """``(x, u, (theta, k))`` to w' and its derivatives in (x, u, theta), side by side.

    Shape (n + r, 1 + 2n + r + m + p), x = (q, w).
    """
    n, x, u, theta, k = _symbols(system)
    mass, forces = system.forces(x[:n], x[n:], u, theta, k)
    rate = system.accelerate(mass, forces)
    by_all = system.differential(x[:n], x[n:], rate[:n], u, theta, k)
    both = ca.horzcat(rate, system.accelerate(mass, by_all))
    return ca.Function("rates", [x, u, ca.vertcat(theta, k)], [ca.densify(both)])


def step_map(system: ControlledSystem, batch: int) -> ca.Function:
    """``(x, u, (theta, k, h))`` to the states a time h later and their derivatives, for a batch.

    Shape (N, 1 + N + m + p), N = 2n + r. The stages share their programs, which would not fit in
    the processor's cache if they were written out four times.
    """
    n, size = system.coordinates, 2 * system.coordinates + system.states
    height = size - n
    x, u = ca.MX.sym("x", batch, size), ca.MX.sym("u", batch, system.inputs)
    shared = ca.MX.sym("shared", system.parameters + len(system.constants) + 1)
    h = shared[-1]
    heart, carry_w, carry_q, solve, finish = (
        batched(f, batch)
        for f in (_heart(system), *_carries(system), _solution(system), _finish(system))
    )
    none = ca.MX(0, 1)
    rates: list[ca.MX] = []
    slopes: list[ca.MX] = []
    for stage, node in enumerate(NODES):
        found = heart(*_stage(x, h, n, rates), u, shared[:-1])
        rate, mass, moved = ca.horzsplit(found, [0, height, height + n * n, found.size2()])
        by_q, by_v, rest = ca.horzsplit(moved, [0, height * n, 2 * height * n, moved.size2()])
        if stage:
            by_w = moved[:, height * n : height * size]
            moved = ca.horzcat(by_q, by_v + node * h * by_q, rest)
            moved += carry_w(by_w, node * h * slopes[-1], none)
        if stage > 1:
            moved += carry_q(by_q, node * NODES[stage - 1] * h**2 * slopes[-2], none)
        rates.append(rate)
        slopes.append(ca.horzcat(rate, solve(mass, moved, none)))
    return ca.Function("step", [x, u, shared], [finish(x, *_sums(slopes, h), h)])


def _heart(system: ControlledSystem) -> ca.Function:
    """The derivatives of w, M, and dR in (x, u, theta) at one stage, as one column."""
    n, x, u, theta, k = _symbols(system)
    q, w = x[:n], x[n:]
    mass, forces = system.forces(q, w, u, theta, k)
    rates = system.accelerate(mass, forces)
    by_all = system.differential(q, w, rates[:n], u, theta, k)
    parts = ca.vertcat(*(ca.vec(ca.densify(item)) for item in (rates, mass, by_all)))
    return ca.Function("heart", [q, w, u, ca.vertcat(theta, k)], [parts])


def _carries(system: ControlledSystem) -> tuple[ca.Function, ca.Function]:
    """The contributions of slopes of w to dR, through w and through q."""
    n, height = system.coordinates, system.coordinates + system.states
    width = system.coordinates + height + system.inputs + system.parameters
    slopes = ca.SX.sym("s", height, 1 + width)
    by_w, by_q = ca.SX.sym("w", height, height), ca.SX.sym("q", height, n)
    found = by_w @ slopes[:, 1:], by_q @ slopes[:n, 1:]
    columns = ca.vec(by_w), ca.vec(by_q)
    through_w, through_q = (
        ca.Function("carry", [column, ca.vec(slopes), ca.SX(0, 1)], [ca.densify(value)])
        for column, value in zip(columns, found, strict=True)
    )
    return through_w, through_q


def _solution(system: ControlledSystem) -> ca.Function:
    """N^-1 dR."""
    n, height = system.coordinates, system.coordinates + system.states
    mass = ca.SX.sym("m", n, n)
    moved = ca.SX.sym("d", height, n + height + system.inputs + system.parameters)
    found = ca.densify(system.accelerate(mass, moved))
    return ca.Function("solve", [ca.vec(mass), ca.vec(moved), ca.SX(0, 1)], [found])


def _finish(system: ControlledSystem) -> ca.Function:
    """The state and its derivatives from the weighted sums of the slopes."""
    n, height = system.coordinates, system.coordinates + system.states
    width = 1 + n + height + system.inputs + system.parameters
    x, h = ca.SX.sym("x", n + height), ca.SX.sym("h")
    lead, total = ca.SX.sym("l", height, width), ca.SX.sym("t", height, width)
    size = n + height
    start = ca.horzcat(x, ca.SX.eye(size), ca.SX(size, width - 1 - size))
    after = start + ca.vertcat(h * start[n : 2 * n, :] + lead[:n, :], total)
    return ca.Function("finish", [x, ca.vec(lead), ca.vec(total), h], [ca.densify(after)])


def value_map(system: ControlledSystem) -> ca.Function:
    """``(x, (u, theta, k, h))`` to the state a time h later, shape (N,), without derivatives."""
    n, x, u, theta, k = _symbols(system)
    h = ca.SX.sym("h")
    rates: list[ca.SX] = []
    for _ in NODES:
        place, speed = _stage(x.T, h, n, rates)
        mass, forces = system.forces(place, speed, u, theta, k)
        rates.append(system.accelerate(mass, forces).T)
    lead, total = _sums(rates, h)
    after = x + ca.vertcat(h * x[n : 2 * n] + lead.T[:n], total.T)
    return ca.Function("step", [x, ca.vertcat(u, theta, k, h)], [ca.densify(after)])


def _stage(x: Graph, h: Graph, n: int, rates: Sequence[Graph]) -> tuple[Graph, Graph]:
    """The q and w at which the next stage is evaluated, one row per sample, as for the rates."""
    node, place, speed = NODES[len(rates)] * h, x[:, :n], x[:, n:]
    if rates:
        place = place + node * x[:, n : 2 * n]
        speed = speed + node * rates[-1]
    if len(rates) > 1:
        place = place + node * NODES[len(rates) - 1] * h * rates[-2][:, :n]
    return place, speed


def _sums(slopes: Sequence[Graph], h: Graph) -> tuple[Graph, Graph]:
    """The weighted sums of the slopes of w that change q and w over the step."""
    first, second, third, fourth = slopes
    lead = first + second + third
    return h**2 / 6 * lead, h / 6 * (lead + second + third + fourth)


def _symbols(system: ControlledSystem) -> tuple[int, ca.SX, ca.SX, ca.SX, ca.SX]:
    """n, and the symbols of (x, u, theta, k)."""
    n = system.coordinates
    sizes = (2 * n + system.states, system.inputs, system.parameters, len(system.constants))
    x, u, theta, k = (ca.SX.sym(*item) for item in zip("xutk", sizes, strict=True))
    return n, x, u, theta, k
