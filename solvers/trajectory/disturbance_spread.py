"""How far disturbed motions get from the planned one, to first order, for a search to leave room.

The spread of the start and of the inputs is carried along the linearised motion,
``D[i + 1] = A[i] D[i] + B[i] d[i]``, and summed by absolute values, so that every corner counts.
Nothing is proved by it: the proof encloses all disturbed motions of the nonlinear robot.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.tasks.disturbance_radii import disturbance_radii
from grammar_lang import ir
from solvers.trajectory.trajectory import Trajectory


@dataclass(frozen=True, slots=True, eq=False)
class DisturbanceSpread:
    """Half-widths of the disturbed motions.

    Attributes:
        points: (k + 1, m) of the positions of all points at the samples, in metres.
        states: (n, 2) of coordinates and rates, the largest along the motion, in SI units.
    """

    points: Array
    states: Array

    @property
    def widest(self) -> float:
        """The largest of the positions, in metres."""
        return float(np.max(self.points, initial=0.0))

    def scaled(self, factor: float) -> DisturbanceSpread:
        """So many times as wide."""
        return DisturbanceSpread(factor * self.points, factor * self.states)


def disturbance_spread(
    numeric: NumericRobot, task: ir.Task, trajectory: Trajectory, substeps: int
) -> DisturbanceSpread:
    """The spread of the motions that a task's ``robust`` clauses allow about a trajectory.

    Inputs are taken to be off by a constant part in every step.
    """
    n, k, theta = numeric.n, len(trajectory.u), trajectory.theta
    part = 0.0 if task.robust is None else float(task.robust.effort)
    radii = [float(radius) for radius in disturbance_radii(task, numeric.graph.model)]
    step = numeric.step(trajectory.x[:-1], trajectory.u, theta, float(task.step), substeps)
    columns = np.zeros((numeric.size, 2 * n))
    columns[: 2 * n] = np.diag(radii)
    by_q = numeric.points(trajectory.x[:, :n], theta).by_q
    points, states = np.zeros(by_q.shape[:2]), np.zeros((k + 1, 2 * n))
    for sample in range(k + 1):
        states[sample] = np.abs(columns[: 2 * n]).sum(axis=1)
        moved = np.abs(by_q[sample] @ columns[:n]).sum(axis=2)
        points[sample] = np.linalg.norm(moved, axis=1)
        if sample < k:
            pushed = step.input[sample] * (part * np.abs(trajectory.u[sample]))
            columns = np.concatenate([step.state[sample] @ columns, pushed], axis=1)
    return DisturbanceSpread(points, states.max(axis=0).reshape(2, n).T)
