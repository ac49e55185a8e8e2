"""Motions that feedback can follow: the prices put on them, and how parameters are compared."""

from __future__ import annotations

from dataclasses import replace

from solvers.trajectory.fine_motion import growth
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.trajectory import Trajectory

TURN = 12.0
"""rad: the largest rate of a minimum-jerk turn from rest to rest by 2 pi, times its duration."""
CALM = 0.1
"""The price of moving at that rate throughout, in units of the effort bound."""
MANY = 5
"""With this many joints or more, an arm has poses in which almost nothing resists one of them."""
CALMEST = 3.0
"""The price for these arms: at a lower one motions whirl, and proofs take ten times as long."""
PUSHED = 1e3
"""The price of mobility: errors that push a joint by 0.016 rad in a step cost one effort bound."""

GROWTH = 1e5
"""If deviations grow by a larger factor, a proof in double precision has no room left."""


def calmer(path_problem: PathProblem) -> PathProblem:
    """The same task with a price on rates and, if disturbances are named, on mobility.

    The motion of least effort under gravity is often that of an arm that falls and whirls.  Samples
    say little about such a motion, feedback can do little within a step, and a tube around it grows
    fast.  Nor can feedback correct, within a step, input errors that throw a light link.
    """
    duration = float(path_problem.task.steps * path_problem.task.step)
    disturbed = path_problem.task.robust is not None and path_problem.loop is None
    return replace(
        path_problem,
        rates=(CALM if path_problem.numeric.n < MANY else CALMEST) * (duration / TURN) ** 2,
        mobility=PUSHED if disturbed else 0.0,
    )


def feedback_before_digits(path_problem: PathProblem) -> bool:
    """Whether feedback is tried before multiple-precision proofs, which take minutes."""
    return not path_problem.task.control and path_problem.numeric.n >= MANY


def outgrows(path_problem: PathProblem, trajectory: Trajectory) -> bool:
    """Whether an open-loop motion is too unstable for doubles, so that feedback is tried first."""
    hasty = feedback_before_digits(path_problem)
    return hasty and not growth(path_problem, trajectory) < GROWTH


def chosen_by_spread(path_problem: PathProblem) -> bool:
    """Whether parameters are also compared by how far disturbed motions deviate."""
    robust = path_problem.task.robust is not None
    return path_problem.rates > 0 and robust and path_problem.loop is None
