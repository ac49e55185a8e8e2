"""An initial motion: a way in joint space, with the inputs that produce it.

Poses where the task constrains points come from inverse kinematics, collision-free ways between
them from ``joint_seeds.py``, and inputs from the equations of motion, sample by sample.  For many
tasks this is already a feasible motion before any convex program is solved.  It is proved at once
and improved later.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from compiler.arrays import Array
from solvers.parameters.parameter_search import parameter_space
from solvers.search.evaluation import SolveRequest
from solvers.trajectory.control import as_it_is
from solvers.trajectory.control_problem import SURVEY, ControlOutcome
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.task_limits import resting_inputs
from solvers.trajectory.trajectory import Trajectory

DRAWN = 3
"""The number of parameter vectors drawn, in addition to the middle of the bounds."""
BROUGHT_BACK = 0.5
"""The share of a deviation from the way that is corrected within one step."""
CORRECTIONS = 4
SETTLED = 1e-3
"""Inputs are corrected until all rates are met up to this (rad/s or m/s)."""
PUSHED = 1e-6
"""Directions less controllable than this, relative to the most controllable one, are ignored."""


def first_motion(
    path_problem: PathProblem, seed: int, tick: Callable[[], None]
) -> ControlOutcome | None:
    """The first feasible motion that follows a straight way in joint space, or None.

    If no motion is feasible as it stands, the convex programs are run once from the nearest one.

    Args:
        path_problem: the robot in its task.
        seed: the random seed for parameters and poses.
        tick: called repeatedly; an exception from it ends the search.
    """
    space = parameter_space(path_problem.model)
    thetas = [space.from_cube(np.full(len(space.lower), 0.5))]
    if not space.is_point:
        thetas += list(space.uniform(np.random.default_rng(seed), DRAWN))
    entries = path_problem.waypoints()[1]
    problem, nearest = path_problem.problem(entries, released=True), None
    for theta in thetas:
        tick()
        ways = path_problem.joint_ways(theta, straight=True)
        if not ways:
            continue
        for motion in followed(path_problem, np.array(ways), theta, problem.loads):
            outcome = as_it_is(problem, motion)
            if outcome is None:
                continue
            if outcome.feasible:
                return outcome
            if nearest is None or outcome.robustness > nearest.robustness:
                nearest = outcome
    if nearest is None:
        return None
    found = SolveRequest(nearest.trajectory, entries, budget=SURVEY, released=True)
    outcome = found.outcome(path_problem)
    return outcome if outcome.feasible else None


def followed(
    path_problem: PathProblem, ways: Array, theta: Array, loads: Array
) -> list[Trajectory]:
    """Motions from rest along ways (s, k + 1, n), with the inputs that produce them.

    Inputs are chosen so that the rates at the next sample are those of the way, plus a correction
    of the position error.  The last inputs are the given ``loads`` (k, c).
    """
    numeric, dt = path_problem.numeric, float(path_problem.task.step)
    count, k, n = len(ways), ways.shape[1] - 1, numeric.n
    rates = np.gradient(ways, dt, axis=1)
    rates[:, -1] = 0.0
    own = np.tile(path_problem.limits.own_start, (count, 1))
    x = np.concatenate([ways[:, 0], np.zeros((count, n)), own], axis=1)
    resting = resting_inputs(path_problem.groups, 1, numeric.m)
    u = np.tile(resting, (count, 1))
    states, inputs = [x], list[Array]()
    with np.errstate(all="ignore"):
        for sample in range(1, k + 1):
            if loads.size:
                u = u.copy()
                u[:, numeric.m - loads.shape[1] :] = loads[sample - 1]
            at = numeric.step(x, u, theta, dt, path_problem.substeps)
            back = 0.0 if sample == k else BROUGHT_BACK / dt
            for _ in range(CORRECTIONS):
                wanted = rates[:, sample] - at.value[:, n : 2 * n]
                wanted += back * (ways[:, sample] - at.value[:, :n])
                if not np.max(np.abs(wanted)) > SETTLED:
                    break
                pushed = np.nan_to_num(at.input[:, n : 2 * n] + back * at.input[:, :n])
                u = u + np.einsum("smn,sn->sm", np.linalg.pinv(pushed, rcond=PUSHED), wanted)
                at = numeric.step(x, u, theta, dt, path_problem.substeps)
            x = at.value
            states.append(x)
            inputs.append(u)
    return [
        Trajectory(*each, theta)
        for each in zip(np.stack(states, axis=1), np.stack(inputs, axis=1), strict=True)
    ]
