"""The question of a control synthesis, its budget, and its answer."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from enum import StrEnum

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.discretisation.spanning_points import Points
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import robot_inputs
from solvers.trajectory.convex_step import ConvexStep, StepMaker
from solvers.trajectory.held_start import held_start
from solvers.trajectory.linear_model import (
    Model,
    PositionRows,
    acceleration_ranges,
    bends,
    fictitious_inputs,
)
from solvers.trajectory.mobility import mobility
from solvers.trajectory.task_limits import ROUNDING, InputGroup, MotionLimits, effort_scale
from solvers.trajectory.trajectory import Trajectory

RowsOf = Callable[[Array, Array], PositionRows]
"""Position rows for the positions (k + 1, m, d) of a reference trajectory and its bends (k, m, d):
the distances (m) of its points from their chords half way through each step."""
EXCESS = 1e-4
"""Position excess, in units of length, that the margin absorbs."""


@dataclass(frozen=True, slots=True)
class ControlProblem:
    """A robot, its limits and its time grid; positions are constrained by ``rows_of``.

    A step takes ``dt`` seconds and is integrated in ``substeps`` parts.  ``steps`` makes the solver
    of the convex steps; ``rates`` is the price of squared rates in them, in SI. ``mobility`` is the
    price of phi (``mobility.py``) per sample, for efforts that are off by ``errors`` (n,) at the
    joints.  Tolerances in metres refer to the robot's ``unit`` of length (m).  Positions may exceed
    their rows by ``excess``, in metres.  ``held`` says that inputs must be able to balance the
    robot at its start.  ``loads`` (k, c) are the last inputs, which are given.  ``prices`` are
    those of the parameters (p,), in SI; empty if they have none.
    """

    numeric: NumericRobot
    dt: float
    substeps: int
    limits: MotionLimits
    groups: tuple[InputGroup, ...]
    rows_of: RowsOf
    steps: StepMaker = field(default=ConvexStep)
    rates: float = 0.0
    mobility: float = 0.0
    errors: Array = field(default_factory=lambda: np.zeros(0))
    unit: float = 1.0
    excess: float = EXCESS
    held: bool = False
    loads: Array = field(default_factory=lambda: np.zeros((0, 0)))
    prices: tuple[float, ...] = ()

    def loaded(self, motion: Trajectory) -> Trajectory:
        """A motion with the given loads."""
        if not self.loads.size:
            return motion
        steered = motion.u[:, : motion.u.shape[1] - self.loads.shape[1]]
        return replace(motion, u=np.concatenate([steered, self.loads], axis=1))

    @property
    def scale(self) -> float:
        """The unit of effort by which defects are weighted."""
        return effort_scale(self.groups)

    def paid(self, motion: Trajectory, near: Model) -> float:
        """What a motion pays for its rates, its mobility (that of ``near``) and its parameters."""
        n = self.numeric.n
        found = self.rates * float(np.sum(motion.x[:, n : 2 * n] ** 2))
        if near.mobility is not None:
            found += self.mobility * float(np.sum(near.mobility.value))
        if self.prices:
            found += float(np.dot(self.prices, motion.theta))
        return found

    def rows(self, trajectory: Trajectory, points: Points) -> PositionRows:
        """The position rows about a trajectory with these points."""
        n = self.numeric.n
        bent = bends(points, trajectory.x[:, n : 2 * n], self.dt)
        return self.rows_of(points.value, bent)


@dataclass(frozen=True, slots=True)
class IterationBudget:
    """The effort of a synthesis: iterations, the relative gain that ends them, accuracy, polishing.

    A polishing step is a convex step that hardly moves, so that it leaves only second-order
    defects.  The iteration ends after ``quiet`` steps in a row without gain; the price of moves
    falls from each to the next, because a small gain means little while moves are expensive.  It
    does not end while steps cause defects beyond ``calm``, relative to the effort bound.  If
    violations remain, it ends after ``quiet`` + 1 steps that do not reduce them.
    """

    iterations: int
    tolerance: float
    accuracy: float
    polish_steps: int
    quiet: int = 1
    calm: float = 0.05


FULL = IterationBudget(60, 1e-5, 1e-9, 6, 2, 2e-3)
SURVEY = IterationBudget(8, 2e-3, 1e-6, 2)
"""Enough to compare parameters with each other."""


class Ending(StrEnum):
    """The ways in which an iteration of convex steps can end."""

    FIXPOINT = "fixpoint"
    LIMIT = "iteration limit"
    VIOLATIONS = "violations remain"
    UNSOLVED = "convex step"
    NOT_FINITE = "not finite"
    MOTIONLESS = "motionless"


@dataclass(frozen=True, slots=True, eq=False)
class ControlOutcome:
    """The result of the iteration.

    ``robustness`` is rho (Definition 7) if ``feasible``, else minus the largest violation in units
    of effort; ``effort_peak`` is in N m, or N. ``fictitious`` (k,) is the largest component of each
    v_i, ``excess`` the position excess (m), ``defect`` the largest one left by the convex steps
    (SI), before the motion was simulated.  If ``regulated``, it was simulated with feedback,
    because its inputs alone did not produce it.  ``detail`` is a solver's message about a step that
    it did not solve.
    """

    trajectory: Trajectory
    feasible: bool
    robustness: float
    effort_peak: float
    fictitious: Array
    excess: float
    iterations: int
    ending: Ending
    defect: float = 0.0
    regulated: bool = False
    detail: str = ""


def input_margin(groups: tuple[InputGroup, ...], u: Array) -> float:
    """The least margin of inputs (k, m) over all steps and groups, each relative to its widest.

    It is scaled by the widest margin of all groups: with a single bound, it is in units of the
    inputs.  Inputs with only one admissible value are ignored unless they have another value.
    """
    scale, found = effort_scale(groups), list[float]()
    for group in groups:
        weight, margin = group.weight(scale), group.margin(u)
        if weight > 0:
            found.append(margin / weight)
        elif margin < 0:
            found.append(margin)
    return min(found, default=0.0)


def effort_weights(model: RobotModel, groups: tuple[InputGroup, ...]) -> Array | None:
    """The unit of effort at each coordinate (n,), relative to the one at the widest bound.

    None if all bounds are equal.
    """
    scale = effort_scale(groups)
    bounds = [group for group in groups if group.effort and group.widest_margin > 0]
    if all(group.weight(scale) == 1.0 for group in bounds):
        return None
    inputs, weights = robot_inputs(model), np.ones(len(model.dofs))
    for group in bounds:
        joints = [dof for i in group.inputs if (dof := inputs[i].dof) is not None]
        weights[joints] = group.weight(scale)
    return weights


def effort_peak(groups: tuple[InputGroup, ...], u: Array) -> float:
    """The largest effort (N m or N) of inputs (k, m) over all steps and groups."""
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
    """Inputs (k, m) clipped to their bounds if they exceed them only by rounding errors."""
    kept = u.copy()
    for group in groups:
        columns = list(group.inputs)
        if group.norm2:
            continue
        clipped = np.clip(u[:, columns], *group.bounds())
        near = np.abs(clipped - u[:, columns]) <= ROUNDING * (1 + abs(group.upper))
        kept[:, columns] = np.where(near, clipped, u[:, columns])
    return kept


# --- A trajectory evaluated on the nonlinear robot: its linearisation and its defects -------------


@dataclass(frozen=True, slots=True)
class MeasuredMotion:
    """A linearisation with its half-planes, and the violations of the trajectory.

    ``fictitious`` (k,) are the largest components of the fictitious inputs that would close the
    defects, ``defect`` the largest of these (SI).  ``excess`` is that of positions (m), ``outside``
    that of limits (SI), and ``margin`` that of the inputs, in their units.
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

    def infeasibility(self, problem: ControlProblem) -> float:
        """The largest fictitious input in units of the effort bound, plus the excess in lengths."""
        largest = float(np.max(self.fictitious, initial=0.0))
        return largest / problem.scale + self.excess / problem.unit


STEEPEST = 1e8
"""With larger derivatives, linearisation is meaningless: rates are absurd there."""


def measured(problem: ControlProblem, trajectory: Trajectory) -> MeasuredMotion | None:
    """Linearise about a trajectory and evaluate its defects; None if that is not possible.

    Its loads are replaced by those of the problem.
    """
    numeric, trajectory = problem.numeric, problem.loaded(trajectory)
    x, u, theta = trajectory.x, trajectory.u, trajectory.theta
    if not (np.isfinite(x).all() and np.isfinite(u).all() and np.isfinite(theta).all()):
        return None
    priced = problem.mobility > 0
    with np.errstate(all="ignore"):
        dynamics = numeric.step(x[:-1], u, theta, problem.dt, problem.substeps)
        points = numeric.points(x[:, : numeric.n], theta)
        try:
            weights = effort_weights(numeric.graph.model, problem.groups)
            fictitious = fictitious_inputs(numeric, trajectory, problem.dt, weights)
            gap = x[1:] - dynamics.value
            needed = np.linalg.solve(fictitious, gap[:, :, None])[:, :, 0]
            pushed = mobility(numeric, trajectory, problem.errors, problem.dt) if priced else None
        except np.linalg.LinAlgError:
            return None
    parts = (dynamics.value, dynamics.state, dynamics.input, dynamics.parameter, needed)
    if not all(np.isfinite(part).all() for part in (*parts, points.value, points.by_q)):
        return None
    if np.max(np.abs(dynamics.state)) > STEEPEST:
        return None
    rows = problem.rows(trajectory, points)
    holding = None
    if problem.held:
        own = problem.limits.own_start
        holding = held_start(numeric, trajectory, problem.groups, own, problem.unit)
    rises, beyond = _accelerated(problem, trajectory)
    if not np.isfinite(beyond):
        return None
    return MeasuredMotion(
        Model(trajectory, dynamics, points, fictitious, pushed, rises, holding),
        rows,
        np.max(np.abs(needed), axis=1, initial=0.0),
        float(np.max(np.abs(gap), initial=0.0)),
        max(
            0.0 if holding is None else holding.excess,
            float(np.max(rows.excess(points), initial=0.0)),
        ),
        max(beyond, limit_excess(problem.limits, x)),
        input_margin(problem.groups, u),
    )


LEAST_MEAN = 0.2
"""The mean acceleration of a step is left at least this share of the bound."""
SHIFTED = 0.05
"""The middle of the end accelerations differs from the mean by at most this share of the bound."""
JUDGED = 1e-3
"""Bounds may be exceeded by this share; proofs keep a margin of ten times as much."""


def _accelerated(problem: ControlProblem, trajectory: Trajectory) -> tuple[Array | None, float]:
    """The rise and fall that rates may have in each step, (2, k, n), and the excess (SI).

    The accelerations at the ends of a step are assumed to differ from its mean as they do in the
    trajectory.  Without bounds on accelerations the answer is None and 0.
    """
    largest, n, dt = problem.limits.accelerations, problem.numeric.n, problem.dt
    if not largest.size:
        return None, 0.0
    with np.errstate(all="ignore"):
        least, most = acceleration_ranges(problem.numeric, trajectory)
        mean = np.diff(trajectory.x[:, n : 2 * n], axis=0) / dt
        # A seed's inputs need not match its accelerations, which then shifts both ends alike.
        half = (most - least) / 2 + SHIFTED * np.where(np.isfinite(largest), largest, 0.0)
        off = np.clip(np.array([most - mean, mean - least]), 0.0, half)
        excess = np.max(np.maximum(most, -least) - (1 + JUDGED) * largest, initial=0.0)
        return dt * np.maximum(largest - off, LEAST_MEAN * largest), float(excess)


def limit_excess(limits: MotionLimits, x: Array) -> float:
    """The largest excess of states (k + 1, N) over the limits of a motion; 0 if there is none.

    It is in SI units: rad or m for coordinates, the same per second for rates.
    """
    n = limits.joints
    q, v = x[:, :n], x[:, n : 2 * n]
    gaps = [limits.lower - q, q - limits.upper, (limits.rate_lower - v)[1:]]
    gaps += [(v - limits.rate_upper)[1:], np.abs(v[:1]) - limits.start_rates]
    gaps.append(np.abs(v[-limits.final_samples :]) - limits.final_rates)
    if limits.start_values is not None:
        gaps.append(np.abs(q[:1] - limits.start_values))
    gaps.append(np.abs(x[0, 2 * n :] - limits.own_start))
    if limits.loop is not None:
        gaps.append(np.abs(x[-1] - x[limits.loop] - limits.turned))
    return max(float(np.max(gap, initial=0.0)) for gap in gaps)
