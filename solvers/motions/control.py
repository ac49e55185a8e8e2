"""Configuration robustness by sequential convex programming (P.Synthesis, problem (i)).

Linearise, solve, measure on the nonlinear robot, repeat.  The merit function is exact: robustness
less penalties for the largest fictitious input, the largest position excess and the largest excess
over the limits of the motion (a seed may break them, a convex step never does), so a fixpoint with
all of them at zero is a trajectory of the nonlinear (discretised) robot.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from compiler.discretisation.float_reading import Array, FloatReading
from solvers.backends.conic import NotSolved
from solvers.motions.convex_step import (
    Model,
    PositionRows,
    StepResult,
    Trajectory,
    Weights,
    convex_step,
    fictitious_inputs,
)
from solvers.motions.motion_limits import InputGroup, MotionLimits

RowsOf = Callable[[Array], PositionRows]
"""Position rows for the positions (k + 1, m, d) of a reference trajectory."""

SMALLEST_RADIUS = 1e-5
LARGEST_RADIUS = 2.0
GROWTH = 1.5
STILL = 1e-7
DECAY = 0.6
"""In the second half of the iterations the trust region shrinks at least by this factor."""
FUNNEL = 0.3
FREE_STEPS = 3
"""Steps that are taken whatever their defects, to get away from the seed."""
MERIT_WEIGHT = 0.3
NOT_FINITE = "not finite"
WORST = 10.0
"""The largest violation that is told apart, in units of the effort bound."""
EXCESS = 1e-4
"""Position excess in metres that the margin absorbs."""
LIMIT_EXCESS = 1e-4
"""The same for joint limits and rates, in rad or m (/s)."""
ROUNDING = 1e-7
"""Inputs that leave their bounds by no more, relatively, have left them by rounding."""
DEFECT = 1e-3
"""Fictitious effort, in units of the bound, up to which simulation closes a defect."""


@dataclass(frozen=True, slots=True)
class ControlProblem:
    """A robot, its limits and its time grid; positions are constrained by ``rows_of``."""

    reading: FloatReading
    dt: float
    substeps: int
    limits: MotionLimits
    groups: tuple[InputGroup, ...]
    rows_of: RowsOf

    @property
    def scale(self) -> float:
        """The largest margin of an input, the unit in which defects are weighed."""
        return max((group.widest_margin for group in self.groups), default=1.0)


@dataclass(frozen=True, slots=True)
class Effort:
    """How hard to try: iterations, the relative improvement that ends them, program accuracy."""

    iterations: int
    tolerance: float
    accuracy: float


FULL = Effort(40, 1e-5, 1e-8)
SURVEY = Effort(14, 1e-4, 1e-6)
"""Enough to compare parameters with each other."""


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
    outside: float
    margin: float

    def infeasibility(self, scale: float) -> float:
        """The largest defect in units of the effort bound, plus the position excess in metres."""
        return float(np.max(self.fictitious, initial=0.0)) / scale + self.excess

    def merit(self, scale: float) -> float:
        """What progress is measured by; small where robust and nearly feasible."""
        return -self.margin / scale + MERIT_WEIGHT * self.infeasibility(scale)


def input_margin(groups: tuple[InputGroup, ...], u: Array) -> float:
    """The least margin over all steps and groups."""
    return min((group.margin(u) for group in groups), default=0.0)


def effort_peak(groups: tuple[InputGroup, ...], u: Array) -> float:
    """The largest effort over all steps, of whichever group attains it."""
    return max(
        (
            float(np.max(np.linalg.norm(u[:, list(g.inputs)], axis=1), initial=0.0))
            if g.norm2
            else float(np.max(np.abs(u[:, list(g.inputs)]), initial=0.0))
            for g in groups
            if g.effort
        ),
        default=0.0,
    )


def within_bounds(groups: tuple[InputGroup, ...], u: Array) -> Array:
    """Inputs (k, m) with what rounding left outside their bounds put back on them."""
    kept = u.copy()
    for group in groups:
        columns = list(group.inputs)
        if group.norm2:
            continue
        clipped = np.clip(u[:, columns], group.lower, group.upper)
        near = np.abs(clipped - u[:, columns]) <= ROUNDING * (1 + abs(group.upper))
        kept[:, columns] = np.where(near, clipped, u[:, columns])
    return kept


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


def _measure(problem: ControlProblem, trajectory: Trajectory) -> _Measured | None:
    """Linearise about a trajectory and measure its defects; None where that is not finite."""
    reading = problem.reading
    x, u, theta = trajectory.x, trajectory.u, trajectory.theta
    if not np.isfinite(x).all():
        return None
    with np.errstate(all="ignore"):
        dynamics = reading.step(x[:-1], u, theta, problem.dt, problem.substeps)
        points = reading.points(x[:, : reading.n], theta)
        try:
            fictitious = fictitious_inputs(reading, trajectory, problem.dt)
            gap = (x[1:] - dynamics.value)[:, :, None]
            defect = np.linalg.solve(fictitious, gap)[:, :, 0]
        except np.linalg.LinAlgError:
            return None
    parts = (dynamics.value, dynamics.state, dynamics.input, dynamics.parameter, defect)
    if not all(np.isfinite(part).all() for part in parts):
        return None
    rows = problem.rows_of(points.value)
    return _Measured(
        Model(trajectory, dynamics, points, fictitious),
        rows,
        np.max(np.abs(defect), axis=1, initial=0.0),
        float(np.max(rows.excess(points), initial=0.0)),
        limit_excess(problem.limits, x),
        input_margin(problem.groups, u),
    )


def linearised(problem: ControlProblem, about: Trajectory) -> tuple[Model, PositionRows] | None:
    """The robot linearised about a trajectory, with its half-planes; None where not finite."""
    measured = _measure(problem, about)
    return None if measured is None else (measured.model, measured.rows)


def synthesise_control(
    problem: ControlProblem,
    start: Trajectory,
    theta_box: tuple[Array, Array] | None = None,
    effort: Effort = FULL,
    radius: float = 0.5,
    weights: Weights | None = None,
) -> ControlOutcome:
    """Iterate convex steps from a seed trajectory to a fixpoint.

    With ``theta_box`` the parameters are unknowns within that box, else they stay as seeded.
    """
    weights = weights or Weights()
    current = _measure(problem, start)
    if current is None:
        return _hopeless(problem, start)
    status = "iteration limit"
    used = 0
    while used < effort.iterations and radius >= SMALLEST_RADIUS:
        used += 1
        if used > effort.iterations // 2:
            radius *= DECAY
        result = convex_step(
            current.model,
            current.rows,
            problem.limits,
            problem.groups,
            radius,
            theta_box,
            weights,
            accuracy=effort.accuracy,
        )
        if isinstance(result, NotSolved):
            radius /= 4
            status = f"convex step: {result.status}"
            continue
        trial = _measure(problem, result.trajectory)
        if trial is None or (
            used > FREE_STEPS and not _within_funnel(problem, current, trial, result, radius)
        ):
            radius /= 2
            continue
        moved = float(np.max(np.abs(trial.model.about.x - current.model.about.x)))
        before, after = current.merit(problem.scale), trial.merit(problem.scale)
        current = trial
        if after > before - effort.tolerance * (1 + abs(before)):
            radius /= 2
        elif used <= effort.iterations // 2:
            radius = min(LARGEST_RADIUS, radius * GROWTH)
        if moved < STILL or radius < SMALLEST_RADIUS:
            status = "fixpoint"
            break
    return _outcome(problem, current, used, status)


def _within_funnel(
    problem: ControlProblem,
    current: _Measured,
    trial: _Measured,
    result: StepResult,
    radius: float,
) -> bool:
    """Whether the defects that linearisation has caused are small for this trust region."""
    scale = problem.scale
    beyond = trial.infeasibility(scale) - _conceded(result, scale)
    return beyond <= max(current.infeasibility(scale) / 2, FUNNEL * min(1.0, radius))


def _conceded(result: StepResult, scale: float) -> float:
    """The infeasibility that the convex step itself could not avoid."""
    return result.largest_fictitious / scale + result.position_slack


def _outcome(
    problem: ControlProblem, at: _Measured, iterations: int, status: str
) -> ControlOutcome:
    """Close the small remaining defects by simulation, then judge."""
    trajectory = _simulated(problem, at.model.about)
    measured = _measure(problem, trajectory)
    defect = float(np.max(at.fictitious, initial=0.0))
    small = at.excess <= EXCESS and defect < DEFECT * problem.scale
    closed = (
        measured is not None
        and small
        and measured.excess <= 3 * EXCESS
        and max(at.outside, measured.outside) <= LIMIT_EXCESS
        and measured.margin >= 0
    )
    if closed and measured is not None:
        best, value = measured, measured.margin
    else:
        violation = defect + max(0.0, -at.margin) + at.excess + at.outside
        best, value = at, -min(violation, WORST * problem.scale)
        trajectory = at.model.about
    return ControlOutcome(
        trajectory,
        closed,
        value,
        effort_peak(problem.groups, trajectory.u),
        best.fictitious,
        best.excess,
        iterations,
        status,
    )


def _hopeless(problem: ControlProblem, start: Trajectory) -> ControlOutcome:
    """The outcome of a seed about which nothing can be computed."""
    k = len(start.u)
    peak = effort_peak(problem.groups, start.u)
    worst = np.full(k, np.inf)
    return ControlOutcome(
        trajectory=start,
        feasible=False,
        robustness=-WORST * problem.scale,
        effort_peak=peak,
        fictitious=worst,
        excess=float("inf"),
        iterations=0,
        status=NOT_FINITE,
    )


def _simulated(problem: ControlProblem, trajectory: Trajectory) -> Trajectory:
    """The trajectory that the inputs cause from the same initial state."""
    first = trajectory.x[0].copy()
    if problem.limits.start_rates == 0.0:
        first[problem.reading.n : 2 * problem.reading.n] = 0.0
    if problem.limits.start_values is not None:
        first[: problem.reading.n] = problem.limits.start_values
    first[2 * problem.reading.n :] = problem.limits.own_start
    u = within_bounds(problem.groups, trajectory.u)
    states = problem.reading.simulate(first, u, trajectory.theta, problem.dt, problem.substeps)
    return Trajectory(states, u, trajectory.theta)
