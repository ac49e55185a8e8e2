r"""Motion and gains optimised together, for the tube of disturbed motions that they leave.

What is minimised is the estimate of that tube (``disturbance_spread`` to second order, as
``spread_cost`` weighs it), over inputs, states and gains, against the robustness:

.. math::
    \max\ \rho / S - w\, c(x, u, K) / c_0
    \quad\text{s.t. all constraints, narrowed by as many spreads as the alternation leaves.}

The motion is found by sequential convex programs in which the gradient of c is a linear price; the
gains are those of the regulator, or these refined by a quasi-Newton method. At gains that are the
best for a motion, the gradient of c with them held is that of their best value (the envelope
theorem), so that both together make a descent in motion and gains.

Gradients are one-sided differences, along states, inputs and gains that change as piecewise linear
functions of time with ``NODES`` nodes.
"""

from __future__ import annotations

from dataclasses import dataclass, field, fields, replace
from functools import partial
from typing import Any

import numpy as np

from compiler.arrays import Array
from solvers.backends.conic import ConvexProgram, NotSolved, Optimum
from solvers.backends.portfolio import UsualSolver
from solvers.trajectory.control import synthesise_control
from solvers.trajectory.control_problem import (
    FULL,
    ControlOutcome,
    IterationBudget,
    input_margin,
)
from solvers.trajectory.convex_step import ConvexStep
from solvers.trajectory.disturbance_spread import (
    DisturbanceSpread,
    SecondOrder,
    disturbance_spread,
    second_order,
)
from solvers.trajectory.feedback import input_scales, spread_cost
from solvers.trajectory.gain_refinement import hats, refined_gains
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.path_timing import Entries
from solvers.trajectory.task_limits import effort_scale, input_groups
from solvers.trajectory.trajectory import Trajectory

NODES = 12
"""Of states and inputs."""
DIFFERENCE = 1e-4
"""Of states in SI, of inputs in units of their bounds."""
STEPS = 5
FIRST_RADIUS, LEAST_RADIUS = 0.1, 0.01
"""Of the trust region, in rad or m."""
PRICED = IterationBudget(6, 10.0, 1e-8, 4, 6)
"""A tolerance that no loss of robustness exceeds: a price is worth some."""
ROUNDS = 2
"""So often a motion is narrowed by its own spread."""
DIGITS = 6


@dataclass(frozen=True)
class Method:
    """What is optimised for the tube: motions (with a ``price``), gains (``refined``).

    A tube as wide as at first costs the part ``price`` of the effort bound. With ``settled`` motion
    and gains alternate a few times for each width of the tightening.
    """

    price: float = 0.0
    settled: bool = False
    refined: bool = False


@dataclass(slots=True)
class Record:
    """What an optimisation has computed so far."""

    estimates: int = 0
    """Tubes that were estimated."""
    steps: int = 0
    """Programs for a motion that were solved with a price."""
    taken: int = 0
    """Of these, those that were better."""
    change: Array | None = None
    """The last refinement, with which the next one begins."""
    refined: dict[bytes, tuple[Array, DisturbanceSpread | None]] = field(
        default_factory=dict[bytes, tuple[Array, "DisturbanceSpread | None"]]
    )
    """The gains by motion."""


@dataclass(frozen=True)
class TubeProblem(PathProblem):
    """A path problem whose motions, or gains, or both, are optimised for the tube.

    ``factor`` is the number of spreads by which its constraints are narrowed.
    """

    method: Method = Method()
    factor: float = 1.0
    record: Record = field(default_factory=Record)

    def spreading(self, trajectory: Trajectory, factor: float) -> TubeProblem:
        """The same task, narrowed by so many spreads."""
        spread = self.controlled(trajectory)[1]
        scaled = None if spread is None else spread.scaled(factor)
        return replace(self, spread=scaled, factor=factor)

    def controlled(self, trajectory: Trajectory) -> tuple[Array, DisturbanceSpread | None]:
        """The gains about a trajectory, refined if they are to be, with their spread."""
        if not self.method.refined:
            return PathProblem.controlled(self, trajectory)
        key = trajectory.x.tobytes() + trajectory.u.tobytes()
        if key not in self.record.refined:
            self.record.refined[key] = with_refined_gains(self, trajectory)
        return self.record.refined[key]

    def solve(
        self,
        start: Trajectory,
        entries: Entries | None = None,
        box: tuple[Array, Array] | None = None,
        budget: IterationBudget = FULL,
        radius: float = 0.5,
    ) -> ControlOutcome:
        """The most robust motion, and from there the best one for the tube."""
        outcome = PathProblem.solve(self, start, entries, box, budget, radius)
        if self.spread is None or not outcome.feasible or box is not None:
            return outcome
        if self.method.settled:
            return self.resettled(outcome, entries, budget)
        steps = self.waypoints()[1] if entries is None else entries
        return best_for_tube(self, outcome, steps) if self.method.price else outcome

    def resettled(
        self, outcome: ControlOutcome, entries: Entries | None, budget: IterationBudget
    ) -> ControlOutcome:
        """The motion narrowed by its own spread, as nearly as a few rounds get."""
        for _ in range(ROUNDS):
            self.record.steps += 1
            narrow = self.spreading(outcome.trajectory, self.factor)
            again = PathProblem.solve(narrow, outcome.trajectory, entries, None, budget)
            if not again.feasible:
                break
            self.record.taken += 1
            outcome = again
        return outcome


def tube_problem(path_problem: PathProblem, method: Method) -> TubeProblem:
    """The same task with another method."""
    known = {each.name: getattr(path_problem, each.name) for each in fields(PathProblem)}
    return TubeProblem(**known, method=method)


# --- The tube of a motion, and its gradient ------------------------------------------------------


@dataclass(frozen=True)
class TubeEstimate:
    """The tube about one motion, for all gains."""

    problem: PathProblem
    trajectory: Trajectory
    steps: Any
    second: SecondOrder
    scales: Array

    def spread(self, gains: Array) -> DisturbanceSpread:
        """With these gains (k, m, N)."""
        if isinstance(self.problem, TubeProblem):
            self.problem.record.estimates += 1
        numeric, task = self.problem.numeric, self.problem.task
        with np.errstate(all="ignore"):
            return disturbance_spread(
                numeric, task, self.trajectory, self.steps, gains, self.second
            )

    def cost(self, gains: Array) -> float:
        """How wide it is and how much it commands, as the alternation weighs it."""
        return spread_cost(self.spread(gains), self.scales, np.zeros(0))


def tube_estimate(problem: PathProblem, trajectory: Trajectory) -> TubeEstimate:
    """That of a motion, whose states need not be what its inputs cause."""
    numeric, dt = problem.numeric, float(problem.task.step)
    x, u, theta = trajectory.x, trajectory.u, trajectory.theta
    scales = input_scales(input_groups(problem.model, problem.task), numeric.m)
    with np.errstate(all="ignore"):
        steps = numeric.step(x[:-1], u, theta, dt, problem.substeps)
        return TubeEstimate(
            problem, trajectory, steps, second_order(numeric, trajectory, dt), scales
        )


def motion_gradient(
    problem: PathProblem, trajectory: Trajectory, gains: Array
) -> tuple[Array, Array]:
    """The gradients (k + 1, N) and (k, m) of the cost in states and inputs, at given gains.

    The derivative along a function of a node is shared among the samples by its values, so that it
    is exact for all changes that are piecewise linear.
    """
    at = tube_estimate(problem, trajectory)
    base = at.cost(gains)
    x, u = trajectory.x, trajectory.u
    by_x, by_u = np.zeros_like(x), np.zeros_like(u)
    for values, found, units in (
        (x, by_x, np.ones(x.shape[1])),
        (u, by_u, at.scales),
    ):
        shapes = hats(len(values), NODES)
        dual = np.linalg.solve(shapes @ shapes.T, shapes)
        for column, unit in enumerate(units):
            for shape, weights in zip(shapes, dual, strict=True):
                moved = values.copy()
                moved[:, column] += DIFFERENCE * unit * shape
                there = Trajectory(
                    moved if values is x else x, moved if values is u else u, trajectory.theta
                )
                slope = (tube_estimate(problem, there).cost(gains) - base) / (DIFFERENCE * unit)
                found[:, column] += slope * weights
    return by_x, by_u


# --- Motions --------------------------------------------------------------------------------------


@dataclass(frozen=True)
class PricedSolver:
    """The usual solvers, of programs whose first unknowns have a further linear price (q,)."""

    price: Array
    solvers: UsualSolver = field(default_factory=UsualSolver)

    def solve(self, program: ConvexProgram, tolerance: float) -> Optimum | NotSolved:
        """The optimum with the price."""
        linear = program.linear.copy()
        linear[: len(self.price)] += self.price
        return self.solvers.solve(replace(program, linear=linear), tolerance)


def best_for_tube(problem: TubeProblem, first: ControlOutcome, entries: Entries) -> ControlOutcome:
    """The motion from a feasible one on that is the best for its tube, step by step.

    Every step is narrowed by the spread of the motion that it begins with. Motions are compared by
    the margin of their inputs that their own spread leaves.
    """
    scale = effort_scale(input_groups(problem.model, problem.task))
    gains = problem.controlled(first.trajectory)[0]
    whole = tube_estimate(problem, first.trajectory).cost(gains)
    if not (np.isfinite(whole) and whole > 0):
        return first
    best, cost, radius, worth = first, whole, FIRST_RADIUS, problem.method.price
    narrow = problem.spreading(best.trajectory, problem.factor)
    for _ in range(STEPS):
        if radius < LEAST_RADIUS:
            break
        by_x, by_u = motion_gradient(problem, best.trajectory, gains)
        price = worth / whole * np.concatenate([by_x.ravel(), by_u.ravel()])
        if not np.isfinite(price).all():
            break
        steps = partial(ConvexStep, solver=PricedSolver(price))
        asked = replace(narrow.problem(entries), steps=steps)
        while radius >= LEAST_RADIUS:
            problem.record.steps += 1
            with np.errstate(all="ignore"):
                trial = synthesise_control(asked, best.trajectory, None, PRICED, radius)
            if trial.feasible:
                tried = problem.controlled(trial.trajectory)[0]
                wide = tube_estimate(problem, trial.trajectory).cost(tried)
                wider = problem.spreading(trial.trajectory, problem.factor)
                margin = input_margin(wider.groups, trial.trajectory.u)
                gained = (margin - input_margin(narrow.groups, best.trajectory.u)) / scale
                if gained + worth * (cost - wide) / whole > 0:
                    problem.record.taken += 1
                    best, cost, gains, narrow = trial, wide, tried, wider
                    break
            radius /= 3
    return best


# --- Gains ----------------------------------------------------------------------------------------


def with_refined_gains(
    problem: TubeProblem, trajectory: Trajectory
) -> tuple[Array, DisturbanceSpread | None]:
    """The gains about a motion from those of the regulator on, by a quasi-Newton method."""
    gains, spread = PathProblem.controlled(problem, trajectory)
    if spread is None or not gains.any():
        return gains, spread
    estimate, measured = tube_estimate(problem, trajectory), 2 * problem.numeric.n
    found, change = refined_gains(gains, measured, estimate.cost, problem.record.change)
    if not change.any():
        return gains, spread
    problem.record.change = change
    found = rounded(found)
    return found, estimate.spread(found)


def rounded(gains: Array) -> Array:
    """To as many digits as a certificate states."""
    few = [float(f"{value:.{DIGITS}g}") for value in gains.ravel().tolist()]
    return np.array(few).reshape(gains.shape)
