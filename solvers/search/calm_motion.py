"""Motions that feedback can keep: what has a price in them, and what parameters are chosen by."""

from __future__ import annotations

from dataclasses import replace

from solvers.trajectory.fine_motion import growth
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.trajectory import Trajectory

TURN = 12.0
"""rad: the largest rate of a minimum-jerk turn from rest to rest by 2 pi, times its duration."""
CALM = 0.1
"""The price of motions at that rate all the time, in units of the effort bound."""
MANY = 5
"""Arms of so many joints have poses in which next to nothing resists one of them."""
CALMEST = 3.0
"""The price for these: their motions whirl at a lower one, and proofs take ten times as long."""
PUSHED = 1e3
"""The price of mobility: errors that push a joint by 0.016 rad in a step cost an effort bound."""

GROWTH = 1e5
"""Deviations that grow by more leave no room in proofs with doubles."""


def calmer(path_problem: PathProblem) -> PathProblem:
    """The same task with a price on rates and, where disturbances are named, on mobility.

    The least effort under gravity is often that of an arm which falls and whirls.  Samples say
    little of such a motion, feedback can do little within a step, and a tube about it grows fast.
    Nor can feedback do anything within a step about errors of inputs that throw a light link.
    """
    duration = float(path_problem.task.steps * path_problem.task.step)
    disturbed = path_problem.task.robust is not None and path_problem.loop is None
    return replace(
        path_problem,
        rates=(CALM if path_problem.numeric.n < MANY else CALMEST) * (duration / TURN) ** 2,
        mobility=PUSHED if disturbed else 0.0,
    )


def feedback_before_digits(path_problem: PathProblem) -> bool:
    """Whether feedback is tried before more digits than doubles have: these take minutes."""
    return not path_problem.task.control and path_problem.numeric.n >= MANY


def outgrows(path_problem: PathProblem, trajectory: Trajectory) -> bool:
    """Whether doubles lose a motion in an open loop, and feedback is tried before more digits."""
    hasty = feedback_before_digits(path_problem)
    return hasty and not growth(path_problem, trajectory) < GROWTH


def chosen_by_spread(path_problem: PathProblem) -> bool:
    """Whether parameters are compared by how far disturbed motions get, besides."""
    robust = path_problem.task.robust is not None
    return path_problem.rates > 0 and robust and path_problem.loop is None
