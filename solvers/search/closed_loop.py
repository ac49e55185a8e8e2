"""Whether a motion gets a controller, the controller that it gets, and the set of its loop."""

from __future__ import annotations

import numpy as np

from compiler.arrays import Array
from compiler.expressions.exact_numbers import decimal
from grammar_lang import ir
from solvers.search.path_task import WIDEST
from solvers.trajectory.control_problem import ControlOutcome
from solvers.trajectory.feedback import reference_motion
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.task_limits import input_groups
from solvers.trajectory.trajectory import Trajectory
from solvers.verifier.claims.further_claims import ControllerClaim, LoopClaim


def feedback_choices(path_problem: PathProblem, outcome: ControlOutcome) -> tuple[bool, ...]:
    """Whether the motion of an outcome gets feedback: what is tried, in turn.

    Open loop first, if neither the motion is unstable nor disturbances carry it away.
    """
    task = path_problem.task
    if path_problem.loop is not None:
        # Nothing else brings a motion back into the set of its loop.
        return (task.control != "open loop",)
    robust = task.robust or ir.Robust()
    if task.control is not None or robust.measured != ir.Radii():
        return (task.control != "open loop",)
    if outcome.regulated:
        return (True,)
    if task.robust is None:
        return (False,)
    spread = path_problem.spreading(outcome.trajectory, 1.0).spread
    fits = spread is not None and spread.widest < WIDEST
    return (False, True) if fits else (True,)


def controlled(
    path_problem: PathProblem, trajectory: Trajectory
) -> tuple[Trajectory, Array, ControllerClaim] | None:
    """The motion that a controller makes of a trajectory, its gains (k, m, N), the controller.

    None where the motion diverges.
    """
    numeric, task = path_problem.numeric, path_problem.task
    gains = path_problem.gains(trajectory)
    groups = input_groups(path_problem.model, task)
    with np.errstate(all="ignore"):
        motion = reference_motion(
            numeric, trajectory, gains, groups, float(task.step), path_problem.substeps
        )
    if not np.isfinite(motion.x).all():
        return None
    size = 2 * numeric.n
    reference = tuple(tuple(decimal(value) for value in row[:size]) for row in motion.x[:-1])
    stated = tuple(tuple(tuple(decimal(x) for x in row[:size]) for row in gain) for gain in gains)
    return motion, gains, ControllerClaim(reference, stated)


DIGITS = 8
"""Significant digits of the generators of a set."""


def loop_claim(
    path_problem: PathProblem, motion: Trajectory, gains: Array | None
) -> LoopClaim | None:
    """The loop of a motion, which begins and ends with the same state but for a drift.

    ``gains`` (k, m, N) are those of its feedback.  None where no set of states is found that every
    round returns into.
    """
    found = path_problem.round_set(motion, gains)
    if path_problem.loop is None or found is None:
        return None
    generators = tuple(
        tuple(decimal(float(f"{value:.{DIGITS}g}")) for value in row)
        for row in found.generators.tolist()
    )
    return LoopClaim(path_problem.loop, tuple(map(decimal, found.centre.tolist())), generators)
