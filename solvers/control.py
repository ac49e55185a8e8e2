"""Configuration robustness by sequential convex programming (P.Synthesis, problem (i)).

Linearise, solve, measure on the nonlinear robot, repeat.  The merit function is exact: robustness
less penalties for the largest fictitious input and the largest position excess, so a fixpoint
with both at zero is a trajectory of the nonlinear (discretised) robot.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from compiler.float_reading import Array, FloatReading
from solvers.conic import NotSolved
from solvers.convex_step import (
    InputGroup,
    Model,
    MotionLimits,
    PositionRows,
    StepResult,
    Trajectory,
    Weights,
    convex_step,
    fictitious_inputs,
)

RowsOf = Callable[[Array], PositionRows]
"""Position rows for the positions (k + 1, m, d) of a reference trajectory."""

SMALLEST_RADIUS = 1e-7
EXCESS = 1e-6
"""Position excess in metres that the margin absorbs."""
DEFECT = 1e-2
"""Fictitious effort up to which a defect is rounding, closed by simulation."""


@dataclass(frozen=True, slots=True)
class ControlProblem:
    """A robot, its limits and its time grid; positions are constrained by ``rows_of``."""

    reading: FloatReading
    dt: float
    substeps: int
    limits: MotionLimits
    groups: tuple[InputGroup, ...]
    rows_of: RowsOf


@dataclass(frozen=True, slots=True)
class ControlOutcome:
    """Where the iteration ended.

    ``robustness`` is rho where ``feasible``, else minus the largest violation in units of effort;
    ``fictitious`` (k,) is the largest component of each v_i, ``excess`` the position excess (m).
    """

    trajectory: Trajectory
    feasible: bool
    robustness: float
    effort_peak: float
    fictitious: Array
    excess: float
    iterations: int
    status: str


@dataclass(frozen=True, slots=True)
class _Measured:
    """A trajectory held against the nonlinear robot."""

    model: Model
    rows: PositionRows
    fictitious: Array
    excess: float
    margin: float

    def merit(self, weights: Weights) -> float:
        largest = float(np.max(self.fictitious, initial=0.0))
        return -self.margin + weights.fictitious * largest + weights.position * self.excess


def input_margin(groups: tuple[InputGroup, ...], u: Array) -> float:
    """The least bound minus effort over all steps and groups."""
    margins = []
    for group in groups:
        inputs = u[:, list(group.dofs)]
        size = np.linalg.norm(inputs, axis=1) if group.norm2 else np.abs(inputs)
        margins.append(group.bound - float(np.max(size, initial=0.0)))
    return min(margins, default=0.0)


def effort_peak(groups: tuple[InputGroup, ...], u: Array) -> float:
    """The largest effort over all steps, of whichever group attains it."""
    return max(
        (
            float(np.max(np.linalg.norm(u[:, list(g.dofs)], axis=1), initial=0.0))
            if g.norm2
            else float(np.max(np.abs(u[:, list(g.dofs)]), initial=0.0))
            for g in groups
        ),
        default=0.0,
    )


def _measure(
    problem: ControlProblem, trajectory: Trajectory, rows: PositionRows | None
) -> _Measured:
    """Linearise about a trajectory and measure its defects."""
    reading = problem.reading
    x, u, theta = trajectory.x, trajectory.u, trajectory.theta
    dynamics = reading.step(x[:-1], u, theta, problem.dt, problem.substeps)
    points = reading.points(x[:, : reading.n], theta)
    fictitious = fictitious_inputs(reading, trajectory, problem.dt)
    defect = np.linalg.solve(fictitious, (x[1:] - dynamics.value)[:, :, None])[:, :, 0]
    if rows is None:
        rows = problem.rows_of(points.value)
    return _Measured(
        Model(trajectory, dynamics, points, fictitious),
        rows,
        np.max(np.abs(defect), axis=1, initial=0.0),
        float(np.max(rows.excess(points), initial=0.0)),
        input_margin(problem.groups, u),
    )


def linearised(problem: ControlProblem, about: Trajectory) -> tuple[Model, PositionRows]:
    """The robot linearised about a trajectory, and the half-planes chosen there."""
    measured = _measure(problem, about, None)
    return measured.model, measured.rows


def synthesise_control(
    problem: ControlProblem,
    start: Trajectory,
    theta_box: tuple[Array, Array] | None = None,
    iterations: int = 40,
    radius: float = 0.5,
    weights: Weights | None = None,
    tolerance: float = 1e-5,
) -> ControlOutcome:
    """Iterate convex steps from a seed trajectory to a fixpoint.

    With ``theta_box`` the parameters are unknowns within that box, else they stay as seeded.
    """
    weights = weights or Weights()
    current = _measure(problem, start, None)
    status = "iteration limit"
    used = 0
    while used < iterations:
        used += 1
        result = convex_step(
            current.model, current.rows, problem.limits, problem.groups, radius, theta_box, weights
        )
        if isinstance(result, NotSolved):
            radius /= 4
            if radius < SMALLEST_RADIUS:
                status = f"convex step: {result.status}"
                break
            continue
        merit = current.merit(weights)
        predicted = merit - _predicted(result, weights)
        if predicted < tolerance * (1 + abs(merit)):
            status = "fixpoint"
            break
        trial = _measure(problem, result.trajectory, current.rows)
        ratio = (merit - trial.merit(weights)) / predicted
        if ratio > 0.05:
            current = _measure(problem, result.trajectory, None)
        radius = _next_radius(radius, ratio)
        if radius < SMALLEST_RADIUS:
            status = "trust region"
            break
    return _outcome(problem, current, used, status)


def _predicted(result: StepResult, weights: Weights) -> float:
    return (
        -result.margin
        + weights.fictitious * result.largest_fictitious
        + weights.position * result.position_slack
    )


def _next_radius(radius: float, ratio: float) -> float:
    """The usual trust-region update."""
    if ratio < 0.05:
        return radius / 4
    if ratio < 0.3:
        return radius / 2
    return min(2.0, radius * 2) if ratio > 0.8 else radius


def _outcome(
    problem: ControlProblem, at: _Measured, iterations: int, status: str
) -> ControlOutcome:
    """Close the small remaining defects by simulation, then judge."""
    trajectory = _simulated(problem, at.model.about)
    measured = _measure(problem, trajectory, None)
    defect = float(np.max(at.fictitious, initial=0.0))
    closed = at.excess <= EXCESS and measured.excess <= 10 * EXCESS and defect < DEFECT
    if closed and measured.margin >= 0:
        best, value = measured, measured.margin
    else:
        best, value = at, -(defect + max(0.0, -at.margin) + at.excess)
        trajectory = at.model.about
    return ControlOutcome(
        trajectory,
        best is measured,
        value,
        effort_peak(problem.groups, trajectory.u),
        best.fictitious,
        best.excess,
        iterations,
        status,
    )


def _simulated(problem: ControlProblem, trajectory: Trajectory) -> Trajectory:
    """The trajectory that the inputs cause from the same initial state."""
    first = trajectory.x[:1].copy()
    if problem.limits.start_rates == 0.0:
        first[:, problem.reading.n :] = 0.0
    if problem.limits.start_values is not None:
        first[:, : problem.reading.n] = problem.limits.start_values
    states = [first]
    for i in range(len(trajectory.u)):
        after = problem.reading.step(
            states[-1], trajectory.u[i : i + 1], trajectory.theta, problem.dt, problem.substeps
        )
        states.append(after.value)
    return Trajectory(np.concatenate(states), trajectory.u, trajectory.theta)
