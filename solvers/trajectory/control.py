"""Configuration robustness by sequential convex programming (P.Synthesis, problem (i)).

Linearise, solve, evaluate on the nonlinear robot, repeat.  Squared moves have a price, so that what
the objective leaves open stays as it is (a proximal point method).  The price adapts to the
observed linearisation errors, and its term vanishes at the fixpoint.  Fictitious inputs are
offered, at an exact penalty, as long as a step needs them.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from compiler.arrays import Array
from solvers.backends.conic import NotSolved
from solvers.trajectory.control_problem import (
    FULL,
    ControlOutcome,
    ControlProblem,
    Ending,
    IterationBudget,
    MeasuredMotion,
    effort_peak,
    measured,
    within_bounds,
)
from solvers.trajectory.convex_step import StepSolver
from solvers.trajectory.feedback import closed_motion, input_scales, regulator
from solvers.trajectory.subproblem import StepResult, SubproblemSpec, TrustRegion, Weights
from solvers.trajectory.trajectory import Trajectory

SMALLEST_RADIUS = 1e-4
PROXIMAL = 2e-4
LEAST_PROXIMAL, MOST_PROXIMAL = 1e-5, 10.0
"""The range of the price of moves, per rad^2 or m^2."""
SAMPLES = 100
"""The price applies to this many samples moving alike, whatever the grid."""
POLISHING_PROXIMAL = 100.0
"""The price of moves in a polishing step."""
FUNNEL = 0.05
"""Defects up to this share of the effort bound are accepted in good steps."""
LEVEL_DECAY, LEVEL_GROWTH = 0.7, 2.0
STEADY = 0.7
"""A gain above this share of the last one shows that steps are too short."""
SMALL = 1e-4
"""Gains below this share of the effort bound are small."""
PRICES = ((0.2, 0.25), (1.0, 0.5), (4.0, 2.0))
PROXIMAL_GROWTH = 4.0
"""``PRICES``: factors for the price of moves up to multiples of the level; beyond, this one."""
PROXIMAL_DECAY = 0.3
"""The factor after a step that gained nothing."""
FREE_STEPS = 2
"""Steps that are accepted whatever their defects, to get away from the seed."""
NEEDED = 1e-6
"""Steps that concede more than this, relative to the effort bound or in metres, need help."""
STUCK = 0.9
"""A step that leaves more than this share of the unavoidable violation has hardly helped."""
POLISHED_DEFECT = 1e-9
"""A defect in SI at which no polishing is needed."""
COARSE = 1e-5
"""The accuracy of programs whose steps cause larger errors themselves; polishing steps use the

full one.
"""
NEAR = 0.1
"""A seed may violate its half-planes by this, in units of length, without fictitious inputs."""
WORST = 10.0
"""Violations are capped at this, in units of the effort bound."""
LIMIT_EXCESS = 1e-4
"""The excess over joint limits and rates that is absorbed, in rad or m (/s)."""
DEFECT = 1e-3
"""Fictitious effort, in units of the bound, up to which simulation can close a defect."""


@dataclass(slots=True)
class Iteration:
    """A control synthesis in progress."""

    problem: ControlProblem
    step: StepSolver
    budget: IterationBudget
    region: TrustRegion
    current: MeasuredMotion
    used: int = 0
    ending: Ending = Ending.LIMIT
    detail: str = ""
    fictitious: bool = True
    stuck: int = 0
    quiet: int = 0
    level: float = FUNNEL
    conceded: float = np.inf
    gained: float = 0.0
    """The gain of the last step; ``best`` is its worth."""
    best: float = -np.inf

    def run(self) -> None:
        """Iterate until nothing is gained, nothing helps or the iterations are used up."""
        while self.used < self.budget.iterations and self.advance():
            pass
        if self.conceded <= DEFECT:
            self.polish()

    def advance(self) -> bool:
        """Take one convex step; return whether to continue."""
        self.used += 1
        result = self.solved(self.region, max(COARSE, self.budget.accuracy))
        if result is None:
            return self.region.radius >= SMALLEST_RADIUS
        trial = measured(self.problem, result.trajectory)
        if trial is None or self.strayed(trial, result):
            self.hold()
            return self.region.radius >= SMALLEST_RADIUS
        return self.follow(trial, result)

    def follow(self, trial: MeasuredMotion, result: StepResult) -> bool:
        """Accept the result of a convex step; return whether to continue."""
        self.current = trial
        gained = (self.worth(result, trial) - self.best) / self.problem.scale
        self.adapt(trial, gained)
        return not self.ended(result, trial, gained)

    def worth(self, result: StepResult, trial: MeasuredMotion) -> float:
        """The worth of a step: its margin, less the prices of rates, mobility and parameters."""
        paid = self.problem.paid(result.trajectory, trial.model)
        return result.margin - self.problem.scale * paid

    def solved(self, region: TrustRegion, accuracy: float) -> StepResult | None:
        """The convex step about the current motion; if it fails, adapt what is tried next."""
        at = self.current
        result = self.step.solve(at.model, at.rows, region, accuracy, fictitious=self.fictitious)
        if isinstance(result, StepResult):
            return result
        self.relent(result)
        return None

    def relent(self, failure: NotSolved) -> None:
        """After an unsolved step, offer fictitious inputs; if it had them, shorten it."""
        self.ending, self.detail = Ending.UNSOLVED, failure.text
        if self.fictitious:
            self.region = TrustRegion(self.region.radius / 4, self.region.proximal)
        self.fictitious = True

    def strayed(self, trial: MeasuredMotion, result: StepResult) -> bool:
        """Whether linearisation errors are large and larger than before."""
        beyond = trial.infeasibility(self.problem) - _conceded(result, self.problem)
        return self.used > FREE_STEPS and beyond > max(
            FUNNEL, 2 * self.current.infeasibility(self.problem)
        )

    def hold(self) -> None:
        """Raise the price of moves and shrink the trust region."""
        proximal = min(MOST_PROXIMAL, 8 * self.region.proximal)
        self.region = TrustRegion(self.region.radius / 2, proximal)

    def adapt(self, after: MeasuredMotion, gained: float) -> None:
        """Price moves so that defects stay near a level, which falls as gains become small.

        The level rises again while gains do not shrink.  A step that lost worth was too long.
        """
        if self.gained > 0 and gained > max(STEADY * self.gained, SMALL):
            self.level = min(FUNNEL, LEVEL_GROWTH * self.level)
        elif gained < SMALL:
            self.level = max(DEFECT, LEVEL_DECAY * self.level)
        self.gained = gained
        level = self.level
        caused = after.infeasibility(self.problem)
        factor = next((f for times, f in PRICES if caused <= times * level), PROXIMAL_GROWTH)
        if self.used > FREE_STEPS and gained < -self.budget.tolerance:
            factor = PROXIMAL_GROWTH
        price = min(MOST_PROXIMAL, max(LEAST_PROXIMAL, factor * self.region.proximal))
        self.region = TrustRegion(self.region.radius, price)

    def ended(self, result: StepResult, trial: MeasuredMotion, gained: float) -> bool:
        """Whether nothing is gained any more, or no step reduces the remaining violations."""
        conceded = _conceded(result, self.problem)
        self.stuck = self.stuck + 1 if conceded > STUCK * self.conceded > STUCK * NEEDED else 0
        self.conceded, self.best = conceded, self.worth(result, trial)
        self.fictitious = conceded > NEEDED
        if conceded > DEFECT:
            self.ending = Ending.VIOLATIONS
            return self.stuck > self.budget.quiet
        self.ending = Ending.FIXPOINT
        if (
            abs(gained) >= self.budget.tolerance
            or trial.infeasibility(self.problem) >= self.budget.calm
        ):
            self.quiet = 0
            return False
        self.quiet += 1
        proximal = max(LEAST_PROXIMAL, self.region.proximal * PROXIMAL_DECAY)
        self.region = TrustRegion(self.region.radius, proximal)
        return self.quiet >= self.budget.quiet

    def polish(self) -> None:
        """Remove the remaining defects and excess by steps that hardly move."""
        region = TrustRegion(self.region.radius, POLISHING_PROXIMAL)
        for _ in range(self.budget.polish_steps):
            at = self.current
            if at.defect <= POLISHED_DEFECT and at.excess <= self.problem.excess:
                break
            result = self.solved(region, self.budget.accuracy)
            trial = None if result is None else measured(self.problem, result.trajectory)
            if trial is None:
                break
            self.used += 1
            self.current = trial


def _conceded(result: StepResult, problem: ControlProblem) -> float:
    """The infeasibility that the convex step itself could not avoid."""
    return result.largest_fictitious / problem.scale + result.position_slack / problem.unit


def synthesise_control(
    problem: ControlProblem,
    start: Trajectory,
    theta_box: tuple[Array, Array] | None = None,
    budget: IterationBudget = FULL,
    radius: float = 0.5,
    weights: Weights | None = None,
) -> ControlOutcome:
    """Iterate convex steps from a seed trajectory to a fixpoint.

    Problem (i) of P.Synthesis: the inputs of maximal robustness (Definition 7), on the repeatedly
    linearised robot.  With ``theta_box``, lower and upper bounds (p,), the parameters are unknowns
    within that box; otherwise they keep their seed values.  ``radius`` is that of the first trust
    region, in rad or m.
    """
    iteration = begun(problem, start, theta_box, budget, radius, weights)
    if iteration is None:
        return _hopeless(problem, start)
    iteration.run()
    return judged(problem, iteration)


def begun(
    problem: ControlProblem,
    start: Trajectory,
    theta_box: tuple[Array, Array] | None,
    budget: IterationBudget,
    radius: float = 0.5,
    weights: Weights | None = None,
) -> Iteration | None:
    """The iteration at its start, with ``theta_box`` sides (p,); None if it cannot be evaluated."""
    current = measured(problem, start)
    if current is None:
        return None
    prices = weights or Weights(
        rates=problem.rates, mobility=problem.mobility, parameters=problem.prices
    )
    prices = replace(prices, position=prices.position / problem.unit)
    question = SubproblemSpec(problem.limits, problem.groups, theta_box, prices, unit=problem.unit)
    step, region = problem.steps(question), TrustRegion(radius, PROXIMAL)
    # A seed within its half-planes hardly needs help; otherwise the first step shows it.
    far = current.excess > NEAR * problem.unit
    return Iteration(problem, step, budget, region, current, fictitious=far)


def judged(problem: ControlProblem, iteration: Iteration) -> ControlOutcome:
    """Close the small remaining defects by simulation, then evaluate the motion."""
    at = iteration.current
    defect = float(np.max(at.fictitious, initial=0.0))
    found, regulated = None, False
    if (
        at.excess <= problem.excess
        and defect < DEFECT * problem.scale
        and at.outside <= LIMIT_EXCESS
    ):
        found = _closed(problem, _simulated(problem, at.trajectory))
        if found is None:
            found, regulated = _closed(problem, _regulated(problem, at)), True
    closed = found is not None
    if found is not None:
        best, value = found, found.margin
    else:
        best, value = at, -_violation(problem, at)
    return ControlOutcome(
        best.trajectory,
        closed,
        value,
        effort_peak(problem.groups, best.trajectory.u),
        best.fictitious,
        best.excess,
        iteration.used,
        iteration.ending,
        at.defect,
        regulated,
        iteration.detail if iteration.ending is Ending.UNSOLVED else "",
    )


def as_it_is(problem: ControlProblem, motion: Trajectory) -> ControlOutcome | None:
    """The outcome of a motion without any change, where defects count as violations; or None."""
    at = measured(problem, motion)
    if at is None:
        return None
    feasible = _keeps(problem, at) and at.defect <= POLISHED_DEFECT
    return ControlOutcome(
        at.trajectory,
        feasible,
        at.margin if feasible else -_violation(problem, at),
        effort_peak(problem.groups, motion.u),
        at.fictitious,
        at.excess,
        0,
        Ending.FIXPOINT if feasible else Ending.VIOLATIONS,
        at.defect,
    )


def _violation(problem: ControlProblem, at: MeasuredMotion) -> float:
    """The total violation of a motion, in units of effort."""
    largest = float(np.max(at.fictitious, initial=0.0))
    places = problem.scale * (at.excess / problem.unit + at.outside)
    return min(largest + max(0.0, -at.margin) + places, WORST * problem.scale)


def _closed(problem: ControlProblem, motion: Trajectory) -> MeasuredMotion | None:
    """A motion without defects, if it satisfies its constraints; else None."""
    found = measured(problem, motion)
    return found if found is not None and _keeps(problem, found) else None


def _keeps(problem: ControlProblem, at: MeasuredMotion) -> bool:
    """Whether a motion without defects satisfies its constraints, up to small tolerances."""
    near = at.excess <= 3 * problem.excess and at.outside <= LIMIT_EXCESS
    return near and at.margin >= 0


def _regulated(problem: ControlProblem, at: MeasuredMotion) -> Trajectory:
    """The motion with feedback about the one found, so that an unstable one does not leave it."""
    numeric, about = problem.numeric, at.trajectory
    scales = input_scales(problem.groups, numeric.m)
    gains = regulator(at.model.dynamics, 2 * numeric.n, scales)
    first = _first(problem, about)
    return closed_motion(numeric, first, about, gains, problem.groups, problem.dt, problem.substeps)


def shortfall(problem: ControlProblem, outcome: ControlOutcome, *, posed: bool = False) -> str:
    """A phrase for what an infeasible outcome lacks besides force, to follow "the motion found".

    For a ``posed`` task it may be a pose.
    """
    if outcome.robustness >= 0:
        return "does not keep to these cells"
    at = measured(problem, outcome.trajectory)
    if at is None:
        return "has no finite equations of motion"
    if at.excess > problem.excess:
        if posed:
            return "lacks some of the margins to the sets around it, or its pose"
        far = at.excess >= 0.1  # 600 mm would be written as 6e+02 mm
        lacking = f"{at.excess:.2g} m" if far else f"{1000 * at.excess:.2g} mm"
        return f"lacks {lacking} of the margins to the sets around it"
    if at.outside > LIMIT_EXCESS:
        return f"passes a limit of a joint or a rate by {at.outside:.2g} (SI)"
    if float(np.max(at.fictitious, initial=0.0)) >= DEFECT * problem.scale:
        return "does not satisfy the equations of motion yet: the iteration has ended before"
    return "is not what its inputs cause: the simulated robot leaves it, as an unstable one does"


def _hopeless(problem: ControlProblem, start: Trajectory) -> ControlOutcome:
    """The outcome of a seed that cannot be evaluated."""
    k = len(start.u)
    peak = effort_peak(problem.groups, start.u)
    worst = np.full(k, WORST * problem.scale)
    return ControlOutcome(
        trajectory=start,
        feasible=False,
        robustness=-WORST * problem.scale,
        effort_peak=peak,
        fictitious=worst,
        excess=WORST,
        iterations=0,
        ending=Ending.NOT_FINITE,
        defect=WORST,
    )


def _simulated(problem: ControlProblem, trajectory: Trajectory) -> Trajectory:
    """The trajectory that the inputs produce from the same initial state."""
    first = _first(problem, trajectory)
    u = within_bounds(problem.groups, trajectory.u)
    states = problem.numeric.simulate(first, u, trajectory.theta, problem.dt, problem.substeps)
    return Trajectory(states, u, trajectory.theta)


def _first(problem: ControlProblem, trajectory: Trajectory) -> Array:
    """The initial state (N,), with the entries that the task fixes."""
    first: Array = trajectory.x[0].copy()
    if problem.limits.start_rates == 0.0:
        first[problem.numeric.n : 2 * problem.numeric.n] = 0.0
    if problem.limits.start_values is not None:
        first[: problem.numeric.n] = problem.limits.start_values
    first[2 * problem.numeric.n :] = problem.limits.own_start
    return first
