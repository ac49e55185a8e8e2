"""Random starts for a robot with unknown parameters: their values, and a motion along a path."""

from __future__ import annotations

import numpy as np

from compiler.arrays import Array
from solvers.parameters.parameter_search import parameter_space
from solvers.trajectory.convex_step import Trajectory
from solvers.trajectory.inverse_kinematics import branches
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.task_limits import input_groups, resting_inputs

REACHED = 1e-3
"""Metres up to which a pose counts as one at its place."""


def random_starts(path_problem: PathProblem, count: int, seed: int) -> list[Trajectory]:
    """Parameters uniform in their box, with motions along the way points of the path.

    The motion is the inverse kinematics' from one of the branches at the start, drawn at random
    from those that keep to all way points; where none does, that of the arm stretched to them.
    """
    rng = np.random.default_rng(seed)
    space = parameter_space(path_problem.model)
    draws = rng.uniform(size=(count, len(space.lower)))
    return [_start(path_problem, space.from_cube(point), rng) for point in draws]


def _start(path_problem: PathProblem, theta: Array, rng: np.random.Generator) -> Trajectory:
    numeric, limits, point = path_problem.numeric, path_problem.limits, path_problem.effector
    place, _ = path_problem.waypoints()
    box = limits.lower, limits.upper
    first = branches(
        numeric, theta, point, place[0], box, path_problem.seed, path_problem.branch_count
    )
    motions = [numeric.track(start, theta, point, place, box) for start in first]
    good = [q for q in motions if _gap(numeric.points(q, theta).value[:, point], place) <= REACHED]
    q = np.zeros_like(motions[0])
    q[:, 0] = np.unwrap(np.arctan2(place[:, 1], place[:, 0]))
    if good:
        q = good[rng.integers(len(good))]
    rates = np.gradient(q, float(path_problem.task.step), axis=0)
    rates[0] = 0.0
    u = resting_inputs(input_groups(path_problem.model, path_problem.task), len(q) - 1, numeric.m)
    return Trajectory(np.concatenate([q, rates], axis=1), u, theta)


def _gap(at: Array, place: Array) -> float:
    return float(np.max(np.linalg.norm(at - place, axis=1)))
