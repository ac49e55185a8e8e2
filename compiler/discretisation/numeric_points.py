"""The points of a robot in doubles, in many poses at once."""

from __future__ import annotations

from functools import cached_property

import casadi as ca
import numpy as np

from compiler.arrays import Array
from compiler.discretisation.batched_function import BatchedFunction
from compiler.discretisation.spanning_points import Points, SpanningPoints
from compiler.dynamics.equations_of_motion import RobotGraph
from compiler.expressions.scalars import Constant

TRACKING_ROUNDS = 4
TRACKING_DAMPING = 1e-4
LONGEST_STEP = 0.3
"""The longest step in one round, in radians or metres."""


class NumericPoints:
    """Evaluates the positions of effectors and colliders; not for proofs.

    There are n coordinates and p parameters, in SI units. Effectors are the first points, followed
    by those that ``spanning`` makes from the graph's points.
    """

    def __init__(self, graph: RobotGraph) -> None:
        self.graph = graph
        self.n = len(graph.model.dofs)
        self.p = len(graph.model.parameters)
        self.d = graph.model.dimension
        self.constants = np.array(
            [float(c.value) if isinstance(c, Constant) else np.pi for c in graph.constants]
        )
        self.spanning = SpanningPoints(graph)
        self._trackers: dict[tuple[int, int], ca.Function] = {}

    @cached_property
    def _points(self) -> ca.Function:
        return _with_jacobians(self.graph.points, (0, 1))

    @cached_property
    def _points_in_batches(self) -> BatchedFunction:
        """Positions with their derivatives in q and theta, a row per coordinate of a point."""
        return self._in_batches(self._points)

    @cached_property
    def _effectors_in_batches(self) -> BatchedFunction:
        """Positions of the effectors alone with their derivatives."""
        return self._in_batches(_with_jacobians(self.graph.effectors, (0, 1)))

    @cached_property
    def _places_in_batches(self) -> BatchedFunction:
        """Positions of the effectors alone."""
        return self._in_batches(self.graph.effectors)

    @cached_property
    def _positions_in_batches(self) -> BatchedFunction:
        """Positions alone, a row per coordinate of a point."""
        return self._in_batches(self.graph.points)

    def _in_batches(self, function: ca.Function) -> BatchedFunction:
        q, shared = ca.SX.sym("q", self.n), ca.SX.sym("shared", self.p + len(self.constants))
        parts = function.call([q, *ca.vertsplit(shared, [0, self.p, shared.numel()])])
        rows = ca.densify(ca.horzcat(*parts))
        return BatchedFunction.of(ca.Function("points", [q, shared], [ca.cse(rows)]))

    @cached_property
    def _points_of_designs(self) -> BatchedFunction:
        """Positions with derivatives, with separate parameters for each sample."""
        return _of_designs(self._points)

    @cached_property
    def _effectors_of_designs(self) -> BatchedFunction:
        """Positions of the effectors with derivatives, with separate parameters for each sample."""
        return _of_designs(_with_jacobians(self.graph.effectors, (0, 1)))

    def track(
        self, first: Array, theta: Array, point: int, waypoints: Array, box: tuple[Array, Array]
    ) -> Array:
        """Coordinates (K, n) that follow waypoints (K, d), in m, continuously from ``first`` (n,).

        Damped least squares, with a fixed number of rounds per waypoint, kept within the box of
        coordinates, (n,) below and above.
        """
        if len(waypoints) < 2:
            return first[None, :]
        key = len(waypoints) - 1, point
        if key not in self._trackers:
            points = self._points
            if self.spanning.changing and point < len(self.graph.model.effectors):
                points = _with_jacobians(self.graph.effectors, (0, 1))
            self._trackers[key] = _tracker(points, self.n, self.d, point, len(waypoints) - 1)
        tail = np.concatenate([*box, theta, self.constants])
        columns = np.tile(tail[:, None], (1, len(waypoints) - 1))
        found = self._trackers[key](first, np.concatenate([waypoints[1:].T, columns]))
        return np.concatenate([first[None, :], np.asarray(found.full()).T])

    def points(self, q: Array, theta: Array) -> Points:
        """All points at K samples; q (K, n), theta (p,) or (K, p)."""
        if theta.ndim == 1:
            found = self._points_in_batches((q,), np.concatenate([theta, self.constants]))
        else:
            found = self._points_of_designs((q, theta), self.constants)
        return self.spanning.of(self._read(found), theta, self.constants)

    def effectors(self, q: Array, theta: Array) -> Points:
        """The effectors alone at K samples; q (K, n), theta (p,) or (K, p)."""
        if theta.ndim == 1:
            found = self._effectors_in_batches((q,), np.concatenate([theta, self.constants]))
        else:
            found = self._effectors_of_designs((q, theta), self.constants)
        return self._read(found)

    def leading(self, q: Array, theta: Array) -> Points:
        """Points (K, m, d) at K samples, at least the effectors; all if there are not many."""
        return (self.effectors if self.spanning.changing else self.points)(q, theta)

    def places(self, q: Array, theta: Array) -> Array:
        """The positions of the effectors at K samples, (K, e, d) in m; q (K, n), theta (p,)."""
        found = self._places_in_batches((q,), np.concatenate([theta, self.constants]))
        return found.reshape(len(q), found.shape[1] // self.d, self.d)

    def _read(self, found: Array) -> Points:
        """Convert rows (K, m d, 1 + n + p) to points."""
        count, rows, width = found.shape
        parts = found.reshape(count, rows // self.d, self.d, width)
        return Points(parts[..., 0], parts[..., 1 : 1 + self.n], parts[..., 1 + self.n :])

    def positions(self, q: Array, theta: Array) -> Array:
        """The positions of all points at K samples, (K, m, d) in m; q (K, n), theta (p,)."""
        return self.spanning.positions(self.graph_points(q, theta), theta, self.constants)

    def graph_points(self, q: Array, theta: Array) -> Array:
        """The positions of the points of the graph, (K, t, d) in m; some are directions."""
        found = self._positions_in_batches((q,), np.concatenate([theta, self.constants]))
        return found.reshape(len(q), found.shape[1] // self.d, self.d)


def _with_jacobians(function: ca.Function, inputs: tuple[int, ...]) -> ca.Function:
    """The function together with its dense Jacobians in some of its inputs."""
    symbols = [ca.SX.sym(f"i{i}", function.size1_in(i)) for i in range(function.n_in())]
    value = function(*symbols)
    jacobians = [ca.densify(ca.jacobian(value, symbols[i])) for i in inputs]
    return ca.Function("points", symbols, ca.cse([ca.densify(value), *jacobians]))


def _of_designs(points: ca.Function) -> BatchedFunction:
    """Rows of values and Jacobians, with separate parameters for each sample."""
    q, theta, k = (ca.SX.sym(f"i{i}", points.size1_in(i)) for i in range(3))
    rows = ca.densify(ca.horzcat(*points(q, theta, k)))
    return BatchedFunction.of(ca.Function("points", [q, theta, k], [ca.cse(rows)]))


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
