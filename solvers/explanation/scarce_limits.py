"""What a motion that was not found seems to lack: time, rates, accelerations or effort.

Poses that the task requires are found at random, so this is a cheap sign, not a proof.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from math import isfinite

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.encodings.pose_questions import PoseQuestion, pose_questions
from compiler.robots.robot import RobotModel
from grammar_lang import ir
from solvers.impossibility.drive_search import straight_strains
from solvers.impossibility.pose_search import PoseWitness, find_poses
from solvers.search.search_state import Cause
from solvers.search.synthesis import Synthesis
from solvers.trajectory.task_limits import MotionLimits, motion_limits

SEEDS = 6
"""How often poses are searched; those with the quickest motion count."""
LATE = 1.01
"""The factor by which the least time exceeds the horizon if it is said to."""
SHARE = 0.5
"""A kind of limits is named if a straight motion takes at least this share of the part that it
takes of the kind that it takes most of."""


@dataclass(frozen=True, slots=True)
class _Way:
    """Poses that answer a question, and the least ``times`` (n,) in s that joints take for it.

    ``by`` is the time (s) of the second pose; None is the end.
    """

    witness: PoseWitness
    times: Array
    by: Fraction | None


def with_remedy(result: Synthesis, workspace: ir.Workspace, task: ir.Task, seed: int) -> Synthesis:
    """A result whose nearest motion says what to try first, if poses of its robot show that.

    Args:
        result: the result of a synthesis.
        workspace: the workspace of the task, without maps.
        task: the task, without maps.
        seed: the seed of the poses.
    """
    nearest = result.nearest
    # Poses are searched for seconds: not after a time limit.
    if result.unfinished or nearest is None or nearest.cause is not Cause.NOT_FOLLOWED:
        return result
    said = remedy(nearest.model, workspace, task, seed)
    return replace(result, nearest=replace(nearest, remedy=said))


def remedy(model: RobotModel, workspace: ir.Workspace, task: ir.Task, seed: int) -> str:
    """What to try first for a robot without a motion, in words; empty if nothing shows it."""
    numeric = NumericRobot(robot_graph(model, task.gravity))
    if not numeric.n:
        return ""
    limits = motion_limits(model, task)
    ways = list[_Way]()
    for number, question in enumerate(pose_questions(workspace, task)):
        # The question about `reach` comes first.
        last = task.reach is not None and not number and not task.repeat
        way = _quickest(numeric, limits, question, _rests(limits, task, last=last), seed)
        if way is not None:
            ways.append(way)
    longest = max(ways, key=lambda way: way.times.max() / _given(way, task), default=None)
    if longest is not None and longest.times.max() > LATE * _given(longest, task):
        return _too_slow(model, limits, longest, task)
    return _most_used(numeric, task, ways)


def _given(way: _Way, task: ir.Task) -> float:
    """The time in s that there is for a way."""
    return float(task.steps * task.step if way.by is None else way.by)


# --- The least time -------------------------------------------------------------------------------


def _rests(limits: MotionLimits, task: ir.Task, *, last: bool) -> int:
    """At how many ends of a way joints are at rest; ``last``: it is the way to the very end."""
    final = task.final_rates
    return (not limits.start_rates) + (last and final is not None and final.bound <= ir.REST_RATE)


def _quickest(
    numeric: NumericRobot, limits: MotionLimits, question: PoseQuestion, rests: int, seed: int
) -> _Way | None:
    """Of some poses that answer a question, those with the least times."""
    found = list[_Way]()
    for each in range(seed, seed + SEEDS):
        witness = find_poses(numeric, question, each)
        if witness is None:
            continue
        start = limits.start_values if witness.start is None else witness.start
        if start is None:
            return None
        away = _shortest(numeric.graph.model, witness.target - start)
        times = np.array([least_time(limits, i, float(d), rests) for i, d in enumerate(away)])
        if np.isfinite(times).all():
            found.append(_Way(replace(witness, target=start + away), times, question.by))
    return min(found, key=lambda way: way.times.max(), default=None)


def _shortest(model: RobotModel, away: Array) -> Array:
    """The ways (n,) of the joints, without whole revolutions of joints without limits."""
    turns = [dof.kind == "revolute" and dof.range is None for dof in model.dofs]
    return np.where(turns, np.remainder(away + np.pi, 2 * np.pi) - np.pi, away)


def least_time(limits: MotionLimits, joint: int, away: float, rests: int) -> float:
    """The least time (s) that a joint takes for a way (rad or m) within its limits.

    It is at rest at ``rests`` of both ends: there it accelerates as hard as it may, and in between
    it moves as fast as it may. Infinite if it may not move that way.
    """
    way = abs(away)
    if not way:
        return 0.0
    rate = float(limits.rate_upper[joint] if away > 0 else -limits.rate_lower[joint])
    bounds = limits.accelerations
    hard = float(bounds[joint]) if bounds.size else np.inf
    if rate <= 0 or hard <= 0:
        return np.inf
    if not (rests and isfinite(hard)):
        return way / rate
    if way < rests * rate**2 / (2 * hard):
        return float(np.sqrt(2 * rests * way / hard))
    return way / rate + rests * rate / (2 * hard)


def _too_slow(model: RobotModel, limits: MotionLimits, way: _Way, task: ir.Task) -> str:
    """Words about a way that takes too long."""
    joint = int(np.argmax(way.times))
    rated = isfinite(limits.rate_upper[joint]) or isfinite(limits.rate_lower[joint])
    hard = limits.accelerations.size and isfinite(limits.accelerations[joint])
    kinds = [*(["rates"] if rated else []), *(["accelerations"] if hard else [])]
    called = model.dofs[joint].called
    return (
        f"a longer horizon or higher {' and '.join(kinds)}: to the nearest poses found, `{called}` "
        f"takes {way.times[joint]:.3g} s, and there are {_given(way, task):.4g} s"
    )


# --- What straight motions take of each kind of limits --------------------------------------------


def _most_used(numeric: NumericRobot, task: ir.Task, ways: Sequence[_Way]) -> str:
    """Words about the limits that straight motions use most; empty if it is the effort alone."""
    used = {"effort": 0.0, "rates": 0.0, "accelerations": 0.0}
    for way in ways:
        strains = straight_strains(numeric, numeric.graph.model, task, way.witness, way.by)
        if strains is None:
            return ""
        parts = zip(used, (strains.inputs, strains.rates, strains.accelerations), strict=True)
        for kind, values in parts:
            used[kind] = float(np.max(values, initial=used[kind]))
    most = max(used.values())
    if not all(map(isfinite, used.values())) or not most:
        return ""
    named = [kind for kind, part in used.items() if part >= SHARE * most]
    if named == ["effort"]:
        return ""
    more = [f"{'more' if kind == 'effort' else 'higher'} {kind}" for kind in named]
    return f"more steps, {', '.join(more)}, or larger budgets: `--paths`, `--evaluations`"
