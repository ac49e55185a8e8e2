r"""The fastest timing of a given way in joint space that the limits of a robot allow.

Along a way q(s) the inputs are linear in the acceleration and the square of the rate of s,

.. math:: u = P (q' \ddot s + (q'' - a_2) \dot s^2 - a_0), \qquad
   \ddot q = a_0 + a_1 \dot s + a_2 \dot s^2 + B u, \quad P = B^+ ,

so that the rates from which the robot can still brake form an interval of squared rates at each
place.  The intervals are computed backwards from the end of the way; forwards, the fastest rate is
taken (Pham & Pham, *A new approach to time-optimal path parameterization based on reachability
analysis*, 2018).  Friction that grows with rates (a_1) is neglected.  The result is only a seed.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from solvers.trajectory.task_limits import InputGroup, MotionLimits

PLACES = 120
"""The number of steps into which a way is divided."""
TINY = 1e-9
FASTEST = 1e12
"""Stands for an unbounded squared rate, 1/s^2."""


@dataclass(frozen=True, slots=True, eq=False)
class Timing:
    """A way (w, n) in coordinates with the time (w,) in seconds at which each place is passed."""

    way: Array
    times: Array

    @property
    def duration(self) -> float:
        """The duration in seconds."""
        return float(self.times[-1])

    def sampled(self, steps: int) -> Array:
        """Coordinates (steps + 1, n) at equidistant times over the whole duration."""
        at = np.linspace(0.0, self.duration, steps + 1)
        q: Array = np.stack([np.interp(at, self.times, column) for column in self.way.T], axis=1)
        return q


def fastest_timing(
    numeric: NumericRobot,
    limits: MotionLimits,
    groups: Sequence[InputGroup],
    theta: Array,
    motion: Array,
) -> Timing | None:
    """The fastest timing along the way of a motion, from rest.

    Args:
        numeric: the robot.
        limits: the limits of rates and accelerations, and whether it ends at rest.
        groups: the bounds on inputs.
        theta: the parameters, (p,).
        motion: coordinates, (k + 1, n); only their way matters.

    Returns:
        The timing; None if inputs cannot hold the robot somewhere on the way, or nothing moves.
    """
    way = _evenly(motion)
    if way is None:
        return None
    places = _Places(numeric, limits, groups, theta, way)
    reachable = _backwards(places)
    if reachable is None:
        return None
    squared = _forwards(places, reachable)
    if not np.all(np.isfinite(squared)):
        return None
    rates = np.sqrt(squared)
    steps = 2 * places.width / np.maximum(rates[:-1] + rates[1:], TINY)
    return Timing(way, np.concatenate([[0.0], np.cumsum(steps)]))


def _evenly(motion: Array) -> Array | None:
    """Places (w, n) on the way of a motion, evenly spaced by length in coordinates."""
    ways = np.linalg.norm(np.diff(motion, axis=0), axis=1)
    along = np.concatenate([[0.0], np.cumsum(ways)])
    if not along[-1] > TINY:
        return None
    kept = np.concatenate([[True], np.diff(along) > 0])
    at = np.linspace(0.0, along[-1], PLACES + 1)
    columns = [np.interp(at, along[kept], column) for column in motion[kept].T]
    places: Array = np.stack(columns, axis=1)
    return places


class _Places:
    """The linear limits G (a, b) <= h on the acceleration a and squared rate b at each place."""

    def __init__(
        self,
        numeric: NumericRobot,
        limits: MotionLimits,
        groups: Sequence[InputGroup],
        theta: Array,
        way: Array,
    ) -> None:
        count, n = way.shape
        self.width = 1.0 / (count - 1)
        first = np.gradient(way, self.width, axis=0)
        second = np.gradient(first, self.width, axis=0)
        self.fastest = _rate_limits(limits, first)
        rest, push, square = _dynamics(numeric, limits, theta, way, first)
        inverse = np.linalg.pinv(push)

        def inputs(acceleration: Array) -> Array:
            found: Array = np.einsum("smn,sn->sm", inverse, acceleration)
            return found

        by_a, by_b, alone = inputs(first), inputs(second - square), inputs(-rest)
        lower, upper = _input_bounds(groups, numeric.m)
        rows = [np.stack([by_a, by_b], axis=2), -np.stack([by_a, by_b], axis=2)]
        most = [upper - alone, alone - lower]
        if limits.accelerations.size:
            least = np.atleast_2d(limits.accelerations).min(axis=0)
            bound = np.broadcast_to(least, (count, n))
            along = np.stack([first, second], axis=2)
            rows += [along, -along]
            most += [bound, bound]
        self.rows, self.most = np.concatenate(rows, axis=1), np.concatenate(most, axis=1)


def _rate_limits(limits: MotionLimits, first: Array) -> Array:
    """The largest squared rate (w,) that joint limits allow at each place."""
    low = limits.rate_lower.reshape(-1, limits.joints).max(axis=0)
    high = limits.rate_upper.reshape(-1, limits.joints).min(axis=0)
    bound = np.where(first > 0, high, -low)
    bound[-1] = np.minimum(bound[-1], limits.final_rates)
    with np.errstate(all="ignore"):
        share = np.where(np.abs(first) > TINY, np.maximum(bound, TINY) / np.abs(first), np.inf)
    squared: Array = np.minimum(np.min(share, axis=1) ** 2, FASTEST)
    return squared


def _dynamics(
    numeric: NumericRobot, limits: MotionLimits, theta: Array, way: Array, first: Array
) -> tuple[Array, Array, Array]:
    """Accelerations at rest (w, n), by inputs (w, n, m), and by the square of the rate (w, n)."""
    n, m = numeric.n, numeric.m
    own = np.tile(limits.own_start, (len(way), 1))
    still = np.zeros((len(way), m))

    def at(rates: Array) -> tuple[Array, Array]:
        x = np.concatenate([way, rates, own], axis=1)
        value, jacobian = numeric.acceleration(x, still, theta)
        return value[:, :n], jacobian[:, :n, numeric.size : numeric.size + m]

    with np.errstate(all="ignore"):
        rest, push = at(np.zeros_like(first))
        there, back = at(first)[0], at(-first)[0]
    square = (there + back) / 2 - rest
    return np.nan_to_num(rest), np.nan_to_num(push), np.nan_to_num(square)


def _input_bounds(groups: Sequence[InputGroup], inputs: int) -> tuple[Array, Array]:
    """Bounds (m,) on each input; for a bounded norm, a box within the ball."""
    lower, upper = np.full(inputs, -FASTEST), np.full(inputs, FASTEST)
    for group in groups:
        own, kept = list(group.inputs), float(np.max(group.kept, initial=0.0))
        part = np.sqrt(len(own)) if group.norm2 else 1.0
        upper[own] = (group.upper - kept) / part
        lower[own] = -upper[own] if group.norm2 else group.lower + kept
    return lower, upper


def _backwards(places: _Places) -> Array | None:
    """The least and greatest squared rates (w, 2) from which the end of the way can be reached."""
    count = len(places.fastest)
    found = np.zeros((count, 2))
    found[-1] = 0.0, places.fastest[-1]
    for place in range(count - 2, -1, -1):
        after = np.array([[2 * places.width, 1.0]])
        rows = np.concatenate([places.rows[place], after, -after, [[0.0, 1.0], [0.0, -1.0]]])
        ends = [found[place + 1, 1], -found[place + 1, 0], places.fastest[place], 0.0]
        corners = _corners(rows, np.concatenate([places.most[place], ends]))
        if not len(corners):
            return None
        found[place] = max(0.0, corners[:, 1].min()), corners[:, 1].max()
    return found if found[0, 0] <= TINY else None


def _corners(rows: Array, most: Array) -> Array:
    """The corners (c, 2) of the polygon ``rows`` x <= ``most``."""
    one, other = np.array(list(combinations(range(len(rows)), 2))).T
    pairs = np.stack([rows[one], rows[other]], axis=1)
    known = np.abs(np.linalg.det(pairs)) > TINY * (1 + np.abs(pairs).max(axis=(1, 2)) ** 2)
    right = np.stack([most[one], most[other]], axis=1)[known]
    points = np.linalg.solve(pairs[known], right[:, :, None])[:, :, 0]
    size = 1 + np.abs(most) + np.abs(points) @ np.abs(rows).T
    inside = np.all(points @ rows.T <= most + 1e-7 * size, axis=1)
    kept: Array = points[inside]
    return kept


def _forwards(places: _Places, reachable: Array) -> Array:
    """The squared rates (w,) of the fastest timing from rest."""
    found = np.zeros(len(reachable))
    for place in range(len(reachable) - 1):
        rows, most = places.rows[place], places.most[place]
        left = most - rows[:, 1] * found[place]
        steep = rows[:, 0] > TINY
        fastest = np.min(left[steep] / rows[steep, 0], initial=FASTEST)
        after = found[place] + 2 * places.width * fastest
        found[place + 1] = np.clip(after, reachable[place + 1, 0], reachable[place + 1, 1])
    return found
