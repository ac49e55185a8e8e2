"""The floating-point reading of a robot's graph, over all steps at once.

The discrete step is the classical Runge-Kutta method with zero-order-hold inputs; its exact
derivatives in state, input and parameters come from the variational equations carried along.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TypeAlias

import casadi as ca
import numpy as np
from numpy.typing import NDArray

from compiler.arithmetic.scalars import (
    Apply,
    Constant,
    ParameterLeaf,
    PiConstant,
    ScalarNode,
    read_scalars,
)
from compiler.dynamics.equations_of_motion import RobotGraph
from compiler.robots.state_and_input import robot_inputs, robot_states

Array: TypeAlias = NDArray[np.float64]

TRACKING_ROUNDS = 4
TRACKING_DAMPING = 1e-4
LONGEST_STEP = 0.3
"""Per round, in radians or metres."""


@dataclass(frozen=True, slots=True)
class Linearisation:
    """The step map about (x, u, theta) at K samples: value and Jacobians.

    Shapes: value (K, N), state (K, N, N), input (K, N, m), parameter (K, N, p).
    """

    value: Array
    state: Array
    input: Array
    parameter: Array


@dataclass(frozen=True, slots=True)
class Points:
    """Positions of m points at K samples: value (K, m, d), by_q (K, m, d, n), by_theta (.., p)."""

    value: Array
    by_q: Array
    by_theta: Array


class FloatReading:
    """Evaluates a robot's graph in doubles; not for proofs.

    A state x has N = 2n + r entries: n coordinates, n rates and the r states of the modules' own;
    there are m inputs and p parameters.
    """

    def __init__(self, graph: RobotGraph) -> None:
        self.graph = graph
        self.n = len(graph.model.dofs)
        self.r = len(robot_states(graph.model))
        self.m = len(robot_inputs(graph.model))
        self.p = len(graph.model.parameters)
        self.d = graph.model.dimension
        self.constants = np.array(
            [float(c.value) if isinstance(c, Constant) else np.pi for c in graph.constants]
        )
        self.size = 2 * self.n + self.r
        self._maps: dict[tuple[str, int], ca.Function] = {}
        self._rollouts: dict[tuple[str, int, float, int], ca.Function] = {}
        self._functions = {
            "step": _with_jacobians(graph.acceleration, (0, 1, 2, 3)),
            "points": _with_jacobians(_all_points(graph), (0, 1)),
            "mass": graph.mass_matrix,
        }

    def _call(self, name: str, columns: list[Array], theta: Array) -> list[Array]:
        """Evaluate at K samples; each column is (K, m), each result (K, numel)."""
        count = len(columns[0])
        key = (name, count)
        if key not in self._maps:
            self._maps[key] = self._functions[name].map(count)
        repeated = [np.tile(vector[:, None], (1, count)) for vector in (theta, self.constants)]
        outputs = self._maps[key].call([*(c.T for c in columns), *repeated])
        return [np.asarray(output.full()).reshape(-1, count, order="F").T for output in outputs]

    def acceleration(self, x: Array, u: Array, theta: Array) -> tuple[Array, Array]:
        """The derivative of rates and own states (K, n + r), its Jacobian in (x, u, theta)."""
        n, height, count = self.n, self.n + self.r, len(x)
        value, *blocks = self._call("step", [x[:, :n], x[:, n:], u], theta)
        jacobian = [block.reshape(count, -1, height).transpose(0, 2, 1) for block in blocks]
        return value, np.concatenate(jacobian, axis=2)

    def step(self, x: Array, u: Array, theta: Array, dt: float, substeps: int) -> Linearisation:
        """The state ``dt`` later and its Jacobians; x (K, N), u (K, m), theta (p,)."""
        size, inputs = self.size, self.m
        sensitivity = np.zeros((len(x), size, size + inputs + self.p))
        sensitivity[:, :, :size] = np.eye(size)
        h = dt / substeps
        for _ in range(substeps):
            x, sensitivity = self._substep(x, u, theta, h, sensitivity)
        return Linearisation(
            x, sensitivity[:, :, :size], sensitivity[:, :, size : size + inputs],
            sensitivity[:, :, size + inputs :],
        )  # fmt: skip

    def _substep(
        self, x: Array, u: Array, theta: Array, h: float, sensitivity: Array
    ) -> tuple[Array, Array]:
        """One classical Runge-Kutta step of the state and its sensitivities."""
        n, size = self.n, self.size
        slope = np.zeros_like(x)
        slope_s = np.zeros_like(sensitivity)
        total, total_s = np.zeros_like(x), np.zeros_like(sensitivity)
        for fraction, weight in ((0.0, 1.0), (0.5, 2.0), (0.5, 2.0), (1.0, 1.0)):
            at = x + fraction * h * slope
            at_s = sensitivity + fraction * h * slope_s
            value, jacobian = self.acceleration(at, u, theta)
            slope = np.concatenate([at[:, n : 2 * n], value], axis=1)
            bottom = jacobian[:, :, :size] @ at_s
            bottom[:, :, size:] += jacobian[:, :, size:]
            slope_s = np.concatenate([at_s[:, n : 2 * n], bottom], axis=1)
            total += weight * slope
            total_s += weight * slope_s
        return x + h / 6 * total, sensitivity + h / 6 * total_s

    def simulate(self, x: Array, u: Array, theta: Array, dt: float, substeps: int) -> Array:
        """States (k + 1, N) from an initial one (N,) under inputs (k, m), by the step map."""
        key = ("simulate", len(u), dt, substeps)
        if key not in self._rollouts:
            self._rollouts[key] = _rollout(self.graph, dt, substeps, len(u))
        tail = np.concatenate([theta, self.constants])
        columns = np.tile(tail[:, None], (1, len(u)))
        states = self._rollouts[key](x, np.concatenate([u.T, columns]))
        return np.concatenate([x[None, :], np.asarray(states.full()).T])

    def track(
        self, first: Array, theta: Array, point: int, waypoints: Array, box: tuple[Array, Array]
    ) -> Array:
        """Coordinates (K, n) that follow waypoints (K, d) continuously from ``first`` (n,).

        Damped least squares, a fixed number of rounds per waypoint, kept within the box.
        """
        if len(waypoints) < 2:
            return first[None, :]
        key = ("track", len(waypoints) - 1, float(point), 0)
        if key not in self._rollouts:
            functions = self._functions["points"]
            self._rollouts[key] = _tracker(functions, self.n, self.d, point, len(waypoints) - 1)
        tail = np.concatenate([*box, theta, self.constants])
        columns = np.tile(tail[:, None], (1, len(waypoints) - 1))
        found = self._rollouts[key](first, np.concatenate([waypoints[1:].T, columns]))
        return np.concatenate([first[None, :], np.asarray(found.full()).T])

    def points(self, q: Array, theta: Array) -> Points:
        """Effectors first, then body points, at K samples; q (K, n)."""
        count, d = len(q), self.d
        value, by_q, by_theta = self._call("points", [q], theta)
        m = value.shape[1] // d
        return Points(
            value.reshape(count, m, d),
            by_q.reshape(count, self.n, m, d).transpose(0, 2, 3, 1),
            by_theta.reshape(count, self.p, m, d).transpose(0, 2, 3, 1),
        )

    def mass_matrix(self, q: Array, theta: Array) -> Array:
        """M at K samples, shape (K, n, n)."""
        (value,) = self._call("mass", [q], theta)
        return value.reshape(len(q), self.n, self.n)


def scalar_floats(nodes: Sequence[ScalarNode], theta: Array) -> list[float]:
    """The value of every scalar of a robot at parameters theta (p,), SI."""
    functions: Mapping[str, Callable[..., float]] = {
        "neg": lambda a: -a, "abs": abs, "sqrt": math.sqrt,
        "sin": math.sin, "cos": math.cos, "tan": math.tan,
        "+": lambda a, b: a + b, "-": lambda a, b: a - b,
        "*": lambda a, b: a * b, "/": lambda a, b: a / b,
    }  # fmt: skip

    def leaf(node: Constant | PiConstant | ParameterLeaf) -> float:
        match node:
            case Constant(value):
                return float(value)
            case PiConstant():
                return math.pi
            case ParameterLeaf(index):
                return float(theta[index])

    def apply(node: Apply, arguments: list[float]) -> float:
        if node.operation == "^":
            return float(arguments[0] ** node.exponent)
        return float(functions[node.operation](*arguments))

    return read_scalars(nodes, leaf, apply)


def _with_jacobians(function: ca.Function, inputs: tuple[int, ...]) -> ca.Function:
    """The function together with its dense Jacobians in some of its inputs."""
    symbols = [ca.SX.sym(f"i{i}", function.size1_in(i)) for i in range(function.n_in())]
    value = function(*symbols)
    jacobians = [ca.densify(ca.jacobian(value, symbols[i])) for i in inputs]
    return ca.Function("linearised", symbols, ca.cse([ca.densify(value), *jacobians]))


def _rollout(graph: RobotGraph, dt: float, substeps: int, steps: int) -> ca.Function:
    """All steps of the classical Runge-Kutta method in one call."""
    f = graph.acceleration
    n, w, m, p, c = (f.size1_in(i) for i in range(5))
    x, extra = ca.SX.sym("x", n + w), ca.SX.sym("e", m + p + c)
    u, theta, k = ca.vertsplit(extra, [0, m, m + p, m + p + c])

    def slope(at: ca.SX) -> ca.SX:
        return ca.vertcat(at[n : 2 * n], f(at[:n], at[n:], u, theta, k))

    after, h = x, dt / substeps
    for _ in range(substeps):
        k1 = slope(after)
        k2 = slope(after + h / 2 * k1)
        k3 = slope(after + h / 2 * k2)
        k4 = slope(after + h * k3)
        after = after + h / 6 * (k1 + 2 * k2 + 2 * k3 + k4)
    return ca.Function("step", [x, extra], [after]).mapaccum("simulate", steps)


def _tracker(points: ca.Function, n: int, d: int, point: int, steps: int) -> ca.Function:
    """Damped least squares from waypoint to waypoint in one call."""
    p, c = points.size1_in(1), points.size1_in(2)
    q, extra = ca.SX.sym("q", n), ca.SX.sym("e", d + 2 * n + p + c)
    target, lower, upper, theta, k = ca.vertsplit(
        extra, [0, d, d + n, d + 2 * n, d + 2 * n + p, d + 2 * n + p + c]
    )
    rows = slice(point * d, point * d + d)
    at = q
    for _ in range(TRACKING_ROUNDS):
        value, jacobian, _ = points(at, theta, k)
        error, slope = target - value[rows], jacobian[rows, :]
        gram = slope @ slope.T + TRACKING_DAMPING * ca.SX.eye(d)
        step = slope.T @ (ca.inv(gram) @ error)
        longest = ca.fmax(1, ca.norm_2(step) / LONGEST_STEP)
        at = ca.fmin(ca.fmax(at + step / longest, lower), upper)
    return ca.Function("follow", [q, extra], [at]).mapaccum("track", steps)


def _all_points(graph: RobotGraph) -> ca.Function:
    """Effectors, then body points, as one function of (q, theta, k)."""
    symbols = [
        ca.SX.sym(f"i{i}", graph.effectors.size1_in(i)) for i in range(graph.effectors.n_in())
    ]
    both = ca.vertcat(graph.effectors(*symbols), graph.body_points(*symbols))
    return ca.Function("points", symbols, [both])
