"""The cells in which some pose puts an effector, found by sampling and inverse kinematics.

A plan through a cell that no pose reaches is a waste of time.  A cell that is not found may be
reachable all the same, so this prunes a search and proves nothing.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.geometry.abstraction import Abstraction
from solvers.motions.inverse_kinematics import sampled_box, solve_positions
from solvers.motions.task_limits import state_limits
from solvers.parameters.parameter_space import parameter_space

PARAMETERS_LOG2 = 3
POSES = 512
CHUNK = 1 << 22
"""So many products of points and rows are held at a time."""


def reachable_cells(
    numeric: NumericRobot, abstraction: Abstraction, effector: int, seed: int
) -> NDArray[np.bool_]:
    """Per cell whether a pose was found with the effector (from 0) in it, shape (cells,)."""
    space, cells = parameter_space(numeric.graph.model), _Stacked(abstraction)
    found = np.zeros(len(abstraction.cells), dtype=bool)
    rng = np.random.default_rng(seed)
    limits = state_limits(numeric.graph.model)[:, 0]
    reach = np.max(np.abs(cells.centres), initial=1.0)
    lower, upper = sampled_box(numeric, (limits[:, 0], limits[:, 1]), float(reach))
    for theta in space.samples(PARAMETERS_LOG2, seed):
        q = rng.uniform(lower, upper, size=(POSES, numeric.n))
        points = numeric.points(q, theta).value[:, effector]
        found |= cells.hit(points)
        missing = np.flatnonzero(~found)
        if not len(missing):
            break
        targets = cells.centres[missing]
        nearest = [int(np.argmin(np.sum((points - target) ** 2, axis=1))) for target in targets]
        limited = limits[:, 0], limits[:, 1]
        ends, _ = solve_positions(numeric, q[nearest], theta, effector, targets, limited)
        found |= cells.hit(numeric.points(ends, theta).value[:, effector])
    return found


class _Stacked:
    """The rows of all cells, (M, d) and (M,), where each cell's rows begin, and the centres."""

    def __init__(self, abstraction: Abstraction) -> None:
        shapes = [cell.polytope for cell in abstraction.cells]
        self.normals = np.concatenate([shape.A for shape in shapes])
        self.offsets = np.concatenate([shape.b for shape in shapes])
        self.starts = np.cumsum([0, *(len(shape.b) for shape in shapes[:-1])])
        self.centres: Array = np.array([[float(x) for x in shape.centre] for shape in shapes])

    def hit(self, points: Array) -> NDArray[np.bool_]:
        """Per cell whether one of the points (K, d) lies inside."""
        hit = np.zeros(len(self.starts), dtype=bool)
        size = max(1, CHUNK // len(self.offsets))
        for first in range(0, len(points), size):
            excess = points[first : first + size] @ self.normals.T - self.offsets
            worst = np.maximum.reduceat(excess, self.starts, axis=1)
            hit |= np.any(worst < 0, axis=0)
        return hit
