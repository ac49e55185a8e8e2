"""A motion to begin with: ways in joint space with the inputs that cause them, as they are.

Poses where the task binds points come from inverse kinematics, clear ways between them from
``joint_seeds.py``, and inputs from the equations of motion, sample by sample.  For many tasks that
is a motion already, before any convex program is solved; it is proved at once, and improved later.
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
"""Parameters that are drawn, besides those in the middle of their bounds."""
BROUGHT_BACK = 0.5
"""The part of a deviation from the way that is made up for within a step."""
CORRECTIONS = 4
SETTLED = 1e-3
"""Inputs are corrected until no rate is missed by more (rad/s or m/s), so many times at most."""
PUSHED = 1e-6
"""Directions that no input moves, relative to the one that is moved most."""


def first_motion(
    path_problem: PathProblem, seed: int, tick: Callable[[], None]
) -> ControlOutcome | None:
    """The first feasible motion that follows a straight way in joint space, None if none does.

    Where none does as it is, the convex programs are asked once about the one that lacks least.

    Args:
        path_problem: the robot in its task.
        seed: of the parameters and poses that are drawn.
        tick: called again and again; what it raises ends the search.
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
    """Motions along ways (s, k + 1, n), from rest, with the inputs that bring them along.

    Rates at the next sample are those of the way, and what was missed of it is made up for.  The
    last inputs are ``loads`` (k, c), which are given.
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
