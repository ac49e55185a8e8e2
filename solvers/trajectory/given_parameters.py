"""Control synthesis with some parameters given and the others unknown."""

from __future__ import annotations

from collections.abc import Set as AbstractSet
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array
from solvers.backends.conic import NotSolved
from solvers.trajectory.control import WORST, begun, judged, synthesise_control
from solvers.trajectory.control_problem import ControlOutcome, ControlProblem, IterationBudget
from solvers.trajectory.convex_step import StepMaker, StepSolver
from solvers.trajectory.linear_model import Model, PositionRows
from solvers.trajectory.subproblem import StepResult, SubproblemSpec, TrustRegion
from solvers.trajectory.trajectory import Trajectory

POLISH_STEPS = 20
"""The number of polishing steps that remove small defects near a start."""


def with_given(
    problem: ControlProblem,
    start: Trajectory,
    box: tuple[Array, Array],
    given: AbstractSet[int],
    budget: IterationBudget,
) -> ControlOutcome:
    """The outcome with the ``given`` parameters, by number, fixed to their values at the start.

    The others vary within ``box``, bounds (p,).  Without given parameters the result is that of
    ``synthesise_control``.  With them, the start is assumed to be a motion up to small defects.
    The outcome is then the better one of a motion near it and of the result of the iteration, which
    may be far away.
    """
    lower, upper = box
    kept = np.array([i in given for i in range(len(start.theta))], dtype=bool)
    free = None
    if not np.all(kept | (lower == upper)):
        free = np.where(kept, start.theta, lower), np.where(kept, start.theta, upper)
        if given:
            problem = replace(problem, steps=partial(_pinned, problem.steps, kept))
    outcome = _finite(problem, synthesise_control(problem, start, free, budget), start)
    near = begun(problem, start, free, budget) if given else None
    if near is None:
        return outcome
    near.budget = replace(budget, polish_steps=POLISH_STEPS)
    near.polish()
    here = _finite(problem, judged(problem, near), start)
    return max(here, outcome, key=lambda each: (each.feasible, each.robustness))


def _finite(problem: ControlProblem, outcome: ControlOutcome, start: Trajectory) -> ControlOutcome:
    """The outcome, or an infeasible one if the motion diverged."""
    if np.isfinite(outcome.robustness):
        return outcome
    worst = -WORST * problem.scale
    return replace(outcome, feasible=False, robustness=worst, trajectory=start)


@dataclass(frozen=True, slots=True)
class _Pinned:
    """Convex steps that keep some parameters exactly as they are."""

    step: StepSolver
    kept: NDArray[np.bool_]

    def solve(
        self,
        model: Model,
        rows: PositionRows,
        region: TrustRegion,
        accuracy: float = 1e-8,
        *,
        fictitious: bool = True,
    ) -> StepResult | NotSolved:
        """The optimum; solvers respect coinciding bounds only up to their accuracy."""
        found = self.step.solve(model, rows, region, accuracy, fictitious=fictitious)
        if isinstance(found, NotSolved):
            return found
        theta = np.where(self.kept, model.about.theta, found.trajectory.theta)
        return replace(found, trajectory=replace(found.trajectory, theta=theta))


def _pinned(steps: StepMaker, kept: NDArray[np.bool_], question: SubproblemSpec) -> StepSolver:
    return _Pinned(steps(question), kept)
