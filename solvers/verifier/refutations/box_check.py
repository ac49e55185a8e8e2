"""Replay a covering by boxes in ball arithmetic: no robot of a structure can do the task.

A motion that does the task has fixed parameters and a path of poses, none of them blocked, from a
pose in which it may start to one that the task asks for. All poses of the path are in boxes that
touch one after the other. No solver and no float is trusted.
"""

from __future__ import annotations

from compiler.expressions.evaluators.balls import working_precision
from compiler.objectives.cheaper_robots import CheaperRobots
from compiler.robots.robot import RobotModel
from compiler.unreachability.actuation_reach import DriveReach, drive_reach, out_of_reach
from compiler.unreachability.box_tree import (
    MOST_VARIABLES,
    BoxTreeError,
    ParameterLeaf,
    parameter_boxes,
    parse,
)
from compiler.unreachability.covered_poses import Cover, CoveredPoses
from compiler.unreachability.motion_conditions import Passage, motion_conditions
from grammar_lang import ir

PRECISION = 64


def why_not(
    covering: str,
    model: RobotModel,
    workspace: ir.Workspace,
    task: ir.Task,
    cheaper: CheaperRobots | None = None,
) -> str | None:
    """Why a covering does not prove that the robot cannot do the task; None if it does.

    Args:
        covering: the text of a file, ``boxes 1`` and the code of a tree.
        model: the robot.
        workspace: the workspace of the task, without maps.
        task: the task, without maps.
        cheaper: the parameters that the proof has to cover; None: all of them.
    """
    with working_precision(PRECISION):
        try:
            return _why_not(covering, model, workspace, task, cheaper)
        except BoxTreeError as error:
            return f"it is not a covering of this robot: {error}"


def _why_not(
    covering: str,
    model: RobotModel,
    workspace: ir.Workspace,
    task: ir.Task,
    cheaper: CheaperRobots | None,
) -> str | None:
    if max(len(model.dofs), len(model.parameters)) > MOST_VARIABLES:
        return f"a covering is of at most {MOST_VARIABLES} coordinates and parameters"
    tree = parse(covering)
    by_drives = any(isinstance(node, ParameterLeaf) and node.reason == "!" for node in tree)
    if by_drives and task.repeat:
        return "what drives cannot do within the horizon, they may do in a later round"
    try:
        poses = CoveredPoses(motion_conditions(model, workspace, task))
        drive = drive_reach(model, workspace, task) if by_drives else None
    except BoxTreeError:
        raise
    except ValueError as error:
        return f"the equations of the robot have no exact value: {error}"
    for number, (box, leaf) in enumerate(parameter_boxes(tree, len(model.parameters)), 1):
        sides = poses.parameters_of(box)
        if leaf.reason == "$":
            proved = cheaper is not None and cheaper.none_in(sides)
        else:
            due = sides if cheaper is None else cheaper.narrowed(sides)
            cover = poses.cover(due, leaf.coordinates)
            proved = _refuted(cover, drive if leaf.reason == "!" else None)
        if not proved:
            return f"box {number} of the parameters: {_OPEN[leaf.reason]}"
    return None


_OPEN = {
    "|": "there may be a way from the start to where an effector has to be",
    "!": "it is not shown that the drives are too weak",
    "$": "its robots may have too little of an objective to be left out",
}


def _refuted(cover: Cover, drive: DriveReach | None) -> bool:
    """Whether some question is refuted: none of its choices of effectors is possible."""
    passages = cover.poses.demands.passages
    return any(all(_impassable(cover, drive, one) for one in choices) for choices in passages)


def _impassable(cover: Cover, drive: DriveReach | None, passage: Passage) -> bool:
    """Whether no way leads through a passage, or no way that the drives can follow."""
    if not cover.way(passage):
        return True
    if drive is None:
        return False
    leaves = cover.leaves(passage)
    return out_of_reach(drive, passage, cover.parameters, leaves) is not None
