r"""Shared parameters by decomposition: every motion alone, at common values that improve in turn.

At common values z each motion is solved for alone.  Its convex step about what it came to, with the
parameters moved by a little either way, says by how much its share of robustness changes,

.. math:: s_k(z + d) \approx s_k + g_k \cdot d ,

and a linear program moves z so that the least of these grows most, within a radius that is halved
where the motions do not confirm it.  It is what remains of the program of ``shared_step.py`` where
motions can only be solved for one by one (primal decomposition; Boyd, Xiao, Mutapcic & Mattingley,
*Notes on decomposition methods*, 2008, section 3).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from scipy.optimize import linprog

from compiler.arrays import Array
from solvers.trajectory.control import synthesise_control
from solvers.trajectory.control_problem import FULL, ControlOutcome, IterationBudget, measured
from solvers.trajectory.convex_step import ConvexStep
from solvers.trajectory.shared_control import (
    SharedOutcome,
    SharedTask,
    in_common,
    merged,
    share_of,
)
from solvers.trajectory.shared_step import Link, tied
from solvers.trajectory.subproblem import (
    LEAST,
    StepResult,
    SubproblemSpec,
    TrustRegion,
    Weights,
)

ROUNDS = 40
RADIUS, LEAST_RADIUS = 0.1, 1e-4
"""Of z, relative."""
MOVED = 1e-3
"""By this part parameters are moved for a slope."""
PROXIMAL = 1e-5


def by_consensus(
    tasks: Sequence[SharedTask],
    links: Sequence[Sequence[tuple[int, int]]],
    budget: IterationBudget = FULL,
) -> SharedOutcome | None:
    """As ``shared_control``, where links leave no parameter of a task free."""
    groups = merged(links)
    common = in_common(tasks, groups)
    if common is None:
        return None
    at, radius = _solved(common, budget), RADIUS
    for _ in range(ROUNDS):
        if radius < LEAST_RADIUS:
            break
        moves = _master(common, groups, at, radius)
        moved = [
            replace(task, start=replace(each.trajectory, theta=each.trajectory.theta + own))
            for task, each, own in zip(common, at.outcomes, moves, strict=True)
        ]
        motions = tied([task.start for task in moved], groups)
        trial = _solved(
            [replace(task, start=start) for task, start in zip(moved, motions, strict=True)], budget
        )
        if trial.share > at.share + budget.tolerance:
            at, radius = trial, 1.5 * radius
        else:
            radius /= 4
    return at


def _solved(tasks: Sequence[SharedTask], budget: IterationBudget) -> SharedOutcome:
    """Every motion alone, from where it starts, its parameters given."""
    found = [synthesise_control(task.problem, task.start, None, budget) for task in tasks]
    shares = [share_of(task.problem, each) for task, each in zip(tasks, found, strict=True)]
    return SharedOutcome(tuple(found), tuple(shares))


def _master(
    tasks: Sequence[SharedTask], groups: Sequence[Link], at: SharedOutcome, radius: float
) -> list[Array]:
    """The moves (p,) of every task's parameters that promise the greatest least share."""
    slopes = [_slopes(task, outcome) for task, outcome in zip(tasks, at.outcomes, strict=True)]
    by_group = np.zeros((len(tasks), len(groups)))
    bounds = list[tuple[float | None, float | None]]()
    for place, group in enumerate(groups):
        for k, i in group:
            by_group[k, place] += slopes[k][i]
        k, i = group[0]
        value = at.trajectories[k].theta[i]
        reach = radius * max(abs(value), LEAST)
        low, high = tasks[k].box[0][i] - value, tasks[k].box[1][i] - value
        bounds.append((max(low, -reach), min(high, reach)))
    answer = linprog(
        np.append(np.zeros(len(groups)), -1.0),
        A_ub=np.hstack([-by_group, np.ones((len(tasks), 1))]), b_ub=at.shares,
        bounds=[*bounds, (None, None)],
    )  # fmt: skip
    moves = [np.zeros_like(task.start.theta) for task in tasks]
    for group, move in zip(groups, answer.x[:-1] if answer.x is not None else (), strict=False):
        for k, i in group:
            moves[k][i] = move
    return moves


def _slopes(task: SharedTask, outcome: ControlOutcome) -> Array:
    """By how much the worth of the convex step changes with each parameter (p,)."""
    problem, theta = task.problem, outcome.trajectory.theta
    found = np.zeros_like(theta)
    at = measured(problem, outcome.trajectory)
    if at is None:
        return found
    weights = Weights(rates=problem.rates, mobility=problem.mobility)
    weights = replace(weights, position=weights.position / problem.unit)
    question = SubproblemSpec(
        problem.limits, problem.groups, (theta, theta), weights, unit=problem.unit
    )
    for i in range(len(theta)):
        values = list[float]()
        size = MOVED * max(abs(theta[i]), LEAST)
        for sign in (1, -1):
            moved = theta.copy()
            moved[i] += sign * size
            step = ConvexStep(replace(question, theta_box=(moved, moved)))
            result = step.solve(at.model, at.rows, TrustRegion(0.5, PROXIMAL))
            if isinstance(result, StepResult):
                paid = weights.fictitious * result.largest_fictitious / problem.scale
                paid += weights.position * result.position_slack
                values.append(result.margin / problem.scale - paid)
        if len(values) == 2:
            found[i] = (values[0] - values[1]) / (2 * size)
    return found
