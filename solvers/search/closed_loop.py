"""Whether a motion gets a controller, the controller itself, and the invariant set of its loop."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from compiler.arrays import Array
from compiler.expressions.exact_numbers import decimal
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import dry_friction, robot_inputs
from compiler.tasks.specification import measurement_radii
from grammar_lang import ir
from solvers.search.constraint_tightening import WIDEST
from solvers.trajectory.control_problem import ControlOutcome
from solvers.trajectory.disturbance_spread import disturbance_spread
from solvers.trajectory.feedback import reference_motion
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.round_set import whole_turns
from solvers.trajectory.rounding_allowance import rounding_allowance
from solvers.trajectory.task_limits import input_groups
from solvers.trajectory.trajectory import Trajectory
from solvers.verifier.claims.further_claims import ControllerClaim, LoopClaim


def needs_feedback(path_problem: PathProblem) -> bool:
    """Whether a motion gets feedback in any case.

    This is so if the task asks for it or names measurement errors.  It is also so for loops,
    because only feedback brings a motion back into the set of its loop.
    """
    task = path_problem.task
    measured = task.robust is not None and task.robust.measured != ir.Radii()
    asked = task.control == "feedback" or measured or path_problem.loop is not None
    return asked and task.control != "open loop"


def feedback_choices(path_problem: PathProblem, outcome: ControlOutcome) -> tuple[bool, ...]:
    """Whether the motion of an outcome gets feedback: the choices to try, in order.

    Open loop comes first, unless the motion is unstable or disturbances carry it away.
    """
    task = path_problem.task
    if needs_feedback(path_problem) or task.control == "open loop":
        return (task.control != "open loop",)
    if outcome.regulated:
        return (True,)
    if task.robust is None:
        # Friction compensation is wrong around the samples at which joints reverse.
        return (False, True) if dry_friction(path_problem.model) else (False,)
    spread = path_problem.spreading(outcome.trajectory, 1.0).spread
    fits = spread is not None and spread.widest < WIDEST
    return (False, True) if fits else (True,)


def unbearable_noise(path_problem: PathProblem, trajectory: Trajectory) -> str | None:
    """Why measurement errors alone are more than a motion tolerates, in words; else None.

    Either they command more than a bound allows, or they account for most of the clearance that was
    not found.  Both are computed with the gains about this motion.  This is no proof: other gains
    may tolerate more.
    """
    model, task = path_problem.model, path_problem.task
    noise = np.array([float(radius) for radius in measurement_radii(task, model)])
    if not path_problem.feedback or not noise.any():
        return None
    with np.errstate(all="ignore"):
        gains = path_problem.gains(trajectory)
    commanded = np.abs(gains[:, :, : len(noise)]) @ noise
    for sample, row in enumerate(commanded):
        for group in input_groups(model, task):
            place = max(group.inputs, key=lambda i: float(row[i]))
            if row[place] > group.widest_margin:
                unit, time = effort_unit(model, place), float(sample * task.step)
                return (
                    f"errors of measurements alone make feedback command {row[place]:.3g}{unit} "
                    f"at sample {sample} ({time:.4g} s), and the bound leaves "
                    f"{group.widest_margin:.3g}{unit}"
                )
    return (
        None if path_problem.spread is None else _noisy_clearance(path_problem, trajectory, gains)
    )


def _noisy_clearance(path_problem: PathProblem, trajectory: Trajectory, gains: Array) -> str | None:
    """How far measurement errors alone deviate points, in words, if that is most of the spread."""
    task, numeric = path_problem.task, path_problem.numeric
    if task.robust is None:
        return None
    only = replace(task, robust=ir.Robust(measured=task.robust.measured))
    with np.errstate(all="ignore"):
        dt, x = float(task.step), trajectory.x[:-1]
        steps = numeric.step(x, trajectory.u, trajectory.theta, dt, path_problem.substeps)
        whole, noise = (
            disturbance_spread(numeric, each, trajectory, steps, gains) for each in (task, only)
        )
    if not (np.isfinite(whole.widest) and 2 * noise.widest > whole.widest):
        return None
    sample = int(np.argmax(noise.points.max(axis=1)))
    return (
        f"errors of measurements alone carry motions up to {noise.widest:.2g} m off at sample "
        f"{sample} ({float(sample * task.step):.4g} s), and none was found with that clearance"
    )


def effort_unit(model: RobotModel, place: int) -> str:
    """The unit of an input, preceded by a space; empty for an input that a module declares."""
    dof = robot_inputs(model)[place].dof
    if dof is None:
        return ""
    return " N*m" if model.dofs[dof].kind == "revolute" else " N"


def controlled(
    path_problem: PathProblem, trajectory: Trajectory
) -> tuple[Trajectory, Array, ControllerClaim] | None:
    """The closed-loop motion of a trajectory, its gains (k, m, N), and the controller.

    None if the motion diverges.
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
    turning = None
    if path_problem.loop is not None:
        turning = whole_turns(path_problem.model, motion, path_problem.loop) != 0
    allowed = rounding_allowance(motion, gains[:, :, :size], path_problem.model, task, turning)
    rounding = tuple(decimal(float(f"{value:.1e}")) for value in allowed.tolist())
    reference = tuple(tuple(decimal(value) for value in row[:size]) for row in motion.x[:-1])
    stated = tuple(tuple(tuple(decimal(x) for x in row[:size]) for row in gain) for gain in gains)
    return motion, gains, ControllerClaim(reference, stated, rounding)


DIGITS = 8
"""Significant digits in the generators of a set."""


def loop_claim(
    path_problem: PathProblem, motion: Trajectory, gains: Array | None
) -> LoopClaim | None:
    """The claim about a motion whose first and last states agree up to a drift and whole turns.

    ``gains`` (k, m, N) are those of its feedback.  None if no set of states is found into which
    every round returns.
    """
    found = path_problem.round_set(motion, gains)
    if path_problem.loop is None or found is None:
        return None
    generators = tuple(
        tuple(decimal(float(f"{value:.{DIGITS}g}")) for value in row)
        for row in found.generators.tolist()
    )
    turns = [int(turn) for turn in whole_turns(path_problem.model, motion, path_problem.loop)]
    return LoopClaim(
        path_problem.loop,
        tuple(map(decimal, found.centre.tolist())),
        generators,
        tuple(turns) if any(turns) else None,
    )
