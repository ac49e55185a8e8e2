"""A trajectory held against the nonlinear robot: linearised there, with its defects."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compiler.arrays import Array
from solvers.trajectory.control_problem import ControlProblem, input_margin
from solvers.trajectory.linear_model import Model, PositionRows, fictitious_inputs
from solvers.trajectory.task_limits import MotionLimits
from solvers.trajectory.trajectory import Trajectory


@dataclass(frozen=True, slots=True)
class MeasuredMotion:
    """A linearisation with its half-planes, and what the trajectory breaks.

    ``fictitious`` (k,) are the largest components of the fictitious inputs that would close the
    ``defect`` (SI, the largest), ``excess`` is that of positions (m), ``outside`` that of limits.
    """

    model: Model
    rows: PositionRows
    fictitious: Array
    defect: float
    excess: float
    outside: float
    margin: float

    @property
    def trajectory(self) -> Trajectory:
        """The trajectory."""
        return self.model.about

    def infeasibility(self, scale: float) -> float:
        """The largest fictitious input in units of the effort bound, plus the excess in metres."""
        return float(np.max(self.fictitious, initial=0.0)) / scale + self.excess


def measured(problem: ControlProblem, trajectory: Trajectory) -> MeasuredMotion | None:
    """Linearise about a trajectory and measure its defects; None where that is not finite."""
    numeric = problem.numeric
    x, u, theta = trajectory.x, trajectory.u, trajectory.theta
    if not (np.isfinite(x).all() and np.isfinite(u).all() and np.isfinite(theta).all()):
        return None
    with np.errstate(all="ignore"):
        dynamics = numeric.step(x[:-1], u, theta, problem.dt, problem.substeps)
        points = numeric.points(x[:, : numeric.n], theta)
        try:
            fictitious = fictitious_inputs(numeric, trajectory, problem.dt)
            gap = x[1:] - dynamics.value
            needed = np.linalg.solve(fictitious, gap[:, :, None])[:, :, 0]
        except np.linalg.LinAlgError:
            return None
    parts = (dynamics.value, dynamics.state, dynamics.input, dynamics.parameter, needed)
    if not all(np.isfinite(part).all() for part in (*parts, points.value, points.by_q)):
        return None
    rows = problem.rows_of(points.value)
    return MeasuredMotion(
        Model(trajectory, dynamics, points, fictitious),
        rows,
        np.max(np.abs(needed), axis=1, initial=0.0),
        float(np.max(np.abs(gap), initial=0.0)),
        float(np.max(rows.excess(points), initial=0.0)),
        limit_excess(problem.limits, x),
        input_margin(problem.groups, u),
    )


def limit_excess(limits: MotionLimits, x: Array) -> float:
    """By how much states (k + 1, N) leave the limits of a motion at most; 0 if they keep them."""
    n = len(limits.lower)
    q, v = x[:, :n], x[:, n : 2 * n]
    gaps = [limits.lower - q, q - limits.upper, (limits.rate_lower - v)[1:]]
    gaps += [(v - limits.rate_upper)[1:], np.abs(v[:1]) - limits.start_rates]
    gaps.append(np.abs(v[-1:]) - limits.final_rates)
    if limits.start_values is not None:
        gaps.append(np.abs(q[:1] - limits.start_values))
    gaps.append(np.abs(x[0, 2 * n :] - limits.own_start))
    return max(float(np.max(gap, initial=0.0)) for gap in gaps)
