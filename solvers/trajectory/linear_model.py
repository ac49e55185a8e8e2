"""A robot linearised about a trajectory, with the half-planes that constrain its positions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import Linearisation, NumericRobot
from compiler.discretisation.spanning_points import Points
from solvers.trajectory.mobility import Mobility
from solvers.trajectory.subproblem import Indices
from solvers.trajectory.trajectory import Trajectory


@dataclass(frozen=True, slots=True)
class PositionRows:
    """Constraints ``normal . p(sample, point) <= offset``, metres, one per entry.

    Shapes: sample, point, offset (R,), normal (R, d), unit normals.
    """

    sample: Indices
    point: Indices
    normal: Array
    offset: Array

    def excess(self, points: Points) -> Array:
        """The signed violation (R,) of each row, in metres; positive if violated."""
        at = points.value[self.sample, self.point]
        return np.asarray(np.einsum("rd,rd->r", self.normal, at) - self.offset)


@dataclass(frozen=True, slots=True)
class Model:
    """The linearisation about one trajectory.

    ``fictitious`` is B' of C.2, shape (k, N, N).  ``mobility`` is given if it has a price.
    ``holding`` constrains the inputs that balance the robot at its start, if this is required.
    ``rises`` (2, k, n) is how much rates may rise and fall in each step, if accelerations are
    bounded.
    """

    about: Trajectory
    dynamics: Linearisation
    points: Points
    fictitious: Array
    mobility: Mobility | None = None
    rises: Array | None = None
    holding: LinearRows | None = None


@dataclass(frozen=True, slots=True)
class LinearRows:
    """Position rows linearised about a trajectory: by_q . dq + by_theta . dtheta <= slack, metres.

    Shapes: sample, slack (R,), by_q (R, n), by_theta (R, p).
    """

    sample: Indices
    by_q: Array
    by_theta: Array
    slack: Array

    @staticmethod
    def of(model: Model, rows: PositionRows) -> LinearRows:
        """The rows of a model, linearised."""
        points, pick, normal = model.points, (rows.sample, rows.point), rows.normal[:, None, :]
        by_q, by_theta = (
            np.matmul(normal, slopes[pick])[:, 0, :] for slopes in (points.by_q, points.by_theta)
        )
        slack = rows.offset - np.einsum("rd,rd->r", rows.normal, points.value[pick])
        found = LinearRows(rows.sample, by_q, by_theta, slack)
        return found if model.holding is None else found.joined(model.holding)

    @property
    def excess(self) -> float:
        """The largest violation of the rows, 0 if there is none."""
        return float(np.max(-self.slack, initial=0.0))

    def joined(self, other: LinearRows) -> LinearRows:
        """These rows, followed by others."""
        return LinearRows(
            np.concatenate([self.sample, other.sample]),
            np.concatenate([self.by_q, other.by_q]),
            np.concatenate([self.by_theta, other.by_theta]),
            np.concatenate([self.slack, other.slack]),
        )

    def taken(self, some: Indices) -> LinearRows:
        """Some of the rows, by their indices (w,)."""
        return LinearRows(self.sample[some], self.by_q[some], self.by_theta[some], self.slack[some])

    def left(self, moves: Array, parameters: Array) -> Array:
        """The slack (R,) after moves (k + 1, n) of coordinates and (p,) of parameters."""
        used = np.einsum("rn,rn->r", self.by_q, moves[self.sample])
        return np.asarray(self.slack - used - self.by_theta @ parameters)


def fictitious_inputs(
    numeric: NumericRobot, trajectory: Trajectory, dt: float, weights: Array | None = None
) -> Array:
    """B' of C.2 in Definition 7, (k, N, N): a unit slack is the effort that causes it in a step.

    An effort f held for ``dt`` seconds moves a coordinate by dt^2/2 M^-1 f and its rate by dt M^-1
    f.  A module's own state is moved by dt in its own unit.  For coordinates with ``weights`` (n,),
    a slack of 1 is that multiple of the unit effort.
    """
    n, k = numeric.n, len(trajectory.u)
    inverse = np.linalg.inv(
        numeric.mass_matrix(trajectory.x[:-1, :n], trajectory.theta, trajectory.u)
    )
    inverse = inverse if weights is None else inverse * weights
    matrix = np.zeros((k, numeric.size, numeric.size))
    matrix[:, :n, :n] = dt**2 / 2 * inverse
    matrix[:, n : 2 * n, n : 2 * n] = dt * inverse
    own = np.arange(2 * n, numeric.size)
    matrix[:, own, own] = dt
    return matrix


def acceleration_ranges(numeric: NumericRobot, trajectory: Trajectory) -> Array:
    """The least and the greatest acceleration at the ends of each step, (2, k, n)."""
    x, u, n = trajectory.x, trajectory.u, numeric.n
    first, last = (
        numeric.acceleration(states, u, trajectory.theta)[0][:, :n] for states in (x[:-1], x[1:])
    )
    return np.array([np.minimum(first, last), np.maximum(first, last)])


def bends(points: Points, rates: Array, dt: float) -> Array:
    """The distance of points from their chords halfway through the steps, (k, m, d), in metres.

    ``rates`` are (k + 1, n), a step takes ``dt`` seconds.  For a cubic this is where the deviation
    is largest; for the true motion this holds to third order.
    """
    velocities = np.einsum("kmdn,kn->kmd", points.by_q, rates)
    found = np.asarray(dt / 8 * (velocities[:-1] - velocities[1:]))
    if points.changing is not None:
        for part, bent in points.changing.bends(rates, dt):
            found[:, part] = bent
    return found
