"""The positions of a robot's points over many boxes of coordinates and parameters.

Two enclosures are intersected: the natural one, and the centred form f(c) + f'(box) (box - c),
which is tighter for small boxes. Both are in floats and only guide a search.

Source: Moore, Kearfott & Cloud, *Introduction to Interval Analysis* (2009), chapter 6.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import casadi as ca
import numpy as np

from compiler.arrays import Array
from compiler.dynamics.corner_points import corner_points
from compiler.dynamics.equations_of_motion import RobotGraph
from compiler.expressions.evaluators.balls import constant_ball
from compiler.expressions.evaluators.intervals import (
    BatchedIntervalEvaluator,
    IntervalBatch,
    common,
    product,
)
from compiler.expressions.tape import Tape, tape
from solvers.impossibility.coordinate_cover import Numbers


@dataclass(frozen=True, slots=True, eq=False)
class Placed:
    """m points in d dimensions for K boxes of v variables.

    ``value`` is the natural enclosure (K, m, d), ``centre`` the points at the boxes' middles (K, m,
    d); ``slopes`` (K, m, d, v) enclose the derivatives, ``radii`` are (K, v).
    """

    value: IntervalBatch
    centre: Array
    slopes: IntervalBatch
    radii: Array

    def along(self, normals: Array, points: Numbers) -> IntervalBatch:
        """The products of some points with r normals (r, d), shape (K, len(points), r)."""
        natural = _combined(IntervalBatch(*(end[:, points] for end in ends(self.value))), normals)
        turned = (np.moveaxis(end[:, points], 2, 3) for end in ends(self.slopes))
        slopes = _combined(IntervalBatch(*turned), normals)
        radius = np.einsum("kmvr,kv->kmr", slopes.magnitude, self.radii)
        middle = self.centre[:, points] @ normals.T
        return common(natural, IntervalBatch(middle - radius, middle + radius))

    @property
    def effects(self) -> Array:
        """How far each variable moves the points at most, in metres, shape (K, v)."""
        moved = self.slopes.magnitude.max(axis=2) * self.radii[:, None, :]
        return np.asarray(np.nan_to_num(moved, nan=np.inf).max(axis=1, initial=0.0))


class BoxPoints:
    """Some points of a robot, numbered as in ``CornerPoints``, over boxes of (q, theta).

    Raises:
        ValueError: the rules or their derivatives have no exact value.
    """

    def __init__(self, graph: RobotGraph, points: Sequence[int]) -> None:
        self.d = graph.model.dimension
        n, p = len(graph.model.dofs), len(graph.model.parameters)
        q, theta, k = graph.parts.q, graph.parts.theta, graph.parts.k
        everything = ca.densify(corner_points(graph.parts.at).points)
        entries = [point * self.d + axis for point in points for axis in range(self.d)]
        value = everything[entries] if entries else ca.SX(0, 1)
        self.variables = n + p
        self.count = len(points)
        self._constants = [_constant(float(constant_ball(c).mid())) for c in graph.constants]
        slopes = ca.densify(ca.jacobian(value, ca.vertcat(q, theta)))
        inputs = [q, theta, k]
        self._value = tape(ca.Function("value", inputs, [ca.cse(value)]))
        # Row by row: all derivatives of one entry are together.
        both = ca.vertcat(value, ca.vec(slopes.T))
        self._both = tape(ca.Function("both", inputs, [ca.cse(both)]))

    def over(self, low: Array, high: Array) -> Placed:
        """The points for boxes from ``low`` to ``high`` (K, n + p)."""
        middle = (low + high) / 2
        size = self.count * self.d
        centre = self._run(self._value, middle, middle)
        both = self._run(self._both, low, high)
        count, shape = len(low), (self.count, self.d)
        return Placed(
            IntervalBatch(*(end[:, :size].reshape(count, *shape) for end in ends(both))),
            ((centre.low + centre.high) / 2).reshape(count, *shape),
            IntervalBatch(
                *(end[:, size:].reshape(count, *shape, self.variables) for end in ends(both))
            ),
            (high - low) / 2,
        )

    def _run(self, program: Tape, low: Array, high: Array) -> IntervalBatch:
        inputs = [IntervalBatch(low[:, i], high[:, i]) for i in range(self.variables)]
        found = program.evaluate([*inputs, *self._constants], BatchedIntervalEvaluator())
        result = np.empty((2, len(low), program.outputs))
        for i, batch in enumerate(found):
            result[0, :, i] = batch.low
            result[1, :, i] = batch.high
        return IntervalBatch(result[0], result[1])


def _combined(values: IntervalBatch, normals: Array) -> IntervalBatch:
    """Interval products of the last axis (d) with normals (r, d)."""
    total: IntervalBatch | None = None
    for axis in range(normals.shape[1]):
        weights = normals[:, axis]
        term = product(
            IntervalBatch(*(end[..., axis, None] for end in ends(values))),
            IntervalBatch(weights, weights),
        )
        total = (
            term if total is None else IntervalBatch(total.low + term.low, total.high + term.high)
        )
    if total is None:
        raise ValueError("there are no dimensions")
    return total


def ends(batch: IntervalBatch) -> tuple[Array, Array]:
    """The lower and upper ends, in the shape (...) of the batch."""
    return batch.low, batch.high


def _constant(value: float) -> IntervalBatch:
    exact = np.asarray(value)
    return IntervalBatch(exact, exact)
