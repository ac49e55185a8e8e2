"""Refute one robot by a covering: found in floats, claimed only after its replay in balls."""

from __future__ import annotations

from collections.abc import Sequence
from contextlib import nullcontext
from dataclasses import dataclass

import numpy as np

from compiler.arrays import Array
from compiler.dynamics.equations_of_motion import RobotGraph
from compiler.encodings.pose_questions import PoseQuestion, pose_questions
from compiler.expressions.evaluators.balls import closed_ball, working_precision
from compiler.objectives.cheaper_robots import CheaperRobots
from compiler.robots.given_start import GivenStart, given_start
from compiler.robots.robot import RobotModel
from compiler.unreachability.box_tree import coordinate_sides, text
from compiler.unreachability.motion_conditions import MotionConditions, motion_conditions
from grammar_lang import ir
from solvers.impossibility.box_conditions import NEAR
from solvers.impossibility.box_search import CoveringBudget, Search, find_covering
from solvers.impossibility.pose_search import PoseWitness
from solvers.verifier.refutations.box_check import PRECISION, why_not

WITH_PROOF = CoveringBudget(6_000, 2_000, 150)
"""For robots that have another refutation."""
WITHOUT_PROOF = CoveringBudget(12_000, 1_500, 400)
"""For robots that have no other refutation."""
FOR_A_POSE = CoveringBudget(1_000, 1_000, 100)
"""For a given pose that seems to be impossible."""


@dataclass(frozen=True, slots=True)
class BoxRefutation:
    """The file of a covering that the verifier accepts, and its meaning in words."""

    boxes: str
    reason: str


def box_refutation(
    model: RobotModel,
    graph: RobotGraph,
    workspace: ir.Workspace,
    task: ir.Task,
    budget: CoveringBudget,
    cheaper: CheaperRobots | None = None,
) -> BoxRefutation | None:
    """A covering that refutes a robot; None if none was found.

    Args:
        model: the robot.
        graph: its graph, in the joints' own coordinates.
        workspace: the workspace, without maps.
        task: the task, without maps.
        budget: the limits of the search.
        cheaper: the parameters that have to be refuted; None: all of them.
    """
    demands = motion_conditions(model, workspace, task)
    # The ends of parameters are compared with amounts in the verifier's precision.
    with working_precision(PRECISION) if cheaper is not None else nullcontext():
        found = find_covering(demands, graph, budget, cheaper)
    if found is None:
        return None
    boxes = text(found.tree)
    if why_not(boxes, model, workspace, task, cheaper) is not None:
        return None
    question = pose_questions(workspace, task)[found.question]
    return BoxRefutation(boxes, _reason(demands, task, question))


def way_is_seen(
    model: RobotModel,
    graph: RobotGraph,
    workspace: ir.Workspace,
    task: ir.Task,
    witnesses: Sequence[PoseWitness | None],
    designs: Sequence[Array],
) -> bool:
    """Whether there seems to be a way for every question, so that no covering can be found.

    Args:
        model: the robot.
        graph: its graph.
        workspace: the workspace, without maps.
        task: the task, without maps.
        witnesses: poses that answer each question, or None.
        designs: parameters (p,) to try, in addition to those of the poses.
    """
    demands = motion_conditions(model, workspace, task)
    if coordinate_sides(model) is None:
        return True
    for passages, witness in zip(demands.passages, witnesses, strict=True):
        if not passages:
            return False
        try:
            search = Search(demands, passages, graph)
        except ValueError:
            return True
        if not _seen(search, witness, designs):
            return False
    return True


def _seen(search: Search, witness: PoseWitness | None, designs: Sequence[Array]) -> bool:
    if witness is not None:
        if search.straight(witness.start, witness.target, witness.theta):
            return True
        designs = [witness.theta, *designs]
    return any(search.way_at(theta) for theta in designs)


def start_is_excluded(
    model: RobotModel, graph: RobotGraph, workspace: ir.Workspace, task: ir.Task
) -> bool:
    """Whether a start pose given by the task seems to be impossible for all parameters."""
    if not isinstance(task.start, ir.StartAt):
        return False
    demands = motion_conditions(model, workspace, task)
    passages = next(iter(demands.passages), ())
    if not passages:
        return True
    try:
        return Search(demands, passages, graph).start_excluded()
    except ValueError:
        return False


def _reason(demands: MotionConditions, task: ir.Task, question: PoseQuestion) -> str:
    if isinstance(task.start, ir.StartAt):
        start = given_start(demands.model, task.start)
        if start.fault:
            return start.fault
        if _out_of_range(demands.model, start):
            return "the given start is out of the range of a joint"
        return f"no way from the given start to {question.goal} for any parameters"
    return f"no way between the start region and {question.goal} for any parameters"


def _out_of_range(model: RobotModel, start: GivenStart) -> bool:
    values = np.array([float(closed_ball(value).mid()) for value in start.values])
    for value, dof in zip(values, model.dofs, strict=True):
        if dof.range is None:
            continue
        low, high = (float(closed_ball(end).mid()) for end in (dof.range.lower, dof.range.upper))
        if not low - NEAR <= value <= high + NEAR:
            return True
    return False
