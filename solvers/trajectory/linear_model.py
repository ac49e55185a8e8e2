"""A robot linearised about a trajectory, with the half-planes that bind its positions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import Linearisation, NumericRobot, Points
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
        """Signed violation (R,) of each row, metres; positive where violated."""
        at = points.value[self.sample, self.point]
        return np.asarray(np.einsum("rd,rd->r", self.normal, at) - self.offset)


@dataclass(frozen=True, slots=True)
class Model:
    """Everything linearised about one trajectory.

    ``fictitious`` is B' of C.2, shape (k, N, N); ``mobility`` is given where it has a price.
    """

    about: Trajectory
    dynamics: Linearisation
    points: Points
    fictitious: Array
    mobility: Mobility | None = None


def fictitious_inputs(numeric: NumericRobot, trajectory: Trajectory, dt: float) -> Array:
    """B' of C.2 in Definition 7, (k, N, N): a unit slack is the effort that causes it in a step.

    An effort f held for ``dt`` seconds moves a coordinate by dt^2/2 M^-1 f and its rate by
    dt M^-1 f.  A state of a module's own is moved by dt in its own unit.
    """
    n, k = numeric.n, len(trajectory.u)
    inverse = np.linalg.inv(numeric.mass_matrix(trajectory.x[:-1, :n], trajectory.theta))
    matrix = np.zeros((k, numeric.size, numeric.size))
    matrix[:, :n, :n] = dt**2 / 2 * inverse
    matrix[:, n : 2 * n, n : 2 * n] = dt * inverse
    own = np.arange(2 * n, numeric.size)
    matrix[:, own, own] = dt
    return matrix
