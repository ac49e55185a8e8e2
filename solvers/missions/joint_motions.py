"""Common parameter values for the robots of several tasks, chosen by one program for all motions.

It starts from the motions of the known designs.  Only the values are used: designs with these
values are then searched for and proved like any others.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from fractions import Fraction
from typing import TypeAlias

import numpy as np

from compiler.arrays import Array
from compiler.missions.parameter_boxes import Box
from compiler.missions.parameter_ranges import ranges_of
from compiler.robots.parameter_values import nearest_value
from grammar_lang import ir
from solvers.missions.task_robots import TaskRobots
from solvers.search.evaluation import free_parameters
from solvers.search.path_task import Design, robustness_share
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.shared_parameters import shared_motion

Group: TypeAlias = tuple[tuple[int, int], ...]


def joint_values(
    tasks: Sequence[TaskRobots],
    boxes: Sequence[Box],
    designs: Sequence[Design],
    groups: Sequence[Group],
    fixed: Mapping[Group, Fraction],
) -> dict[tuple[int, int], Fraction] | None:
    """Common values for which the least robust of all motions is locally as robust as possible.

    None if no value is to be chosen, if a task has unending motions or disturbances, which convex
    programs do not model sufficiently, or if no motions were found.

    Args:
        tasks: the tasks.
        boxes: for each task, the box of its robot's parameters.
        designs: for each task, its design.
        groups: the parameters that have one value, by indices of tasks and of parameters.
        fixed: the groups whose value is given.
    """
    chosen = [group for group in groups if group not in fixed and len(group) > 1]
    ranged = any(isinstance(boxes[k][p], ir.Interval) for group in chosen for k, p in group)
    if not ranged or any(each.task.repeat or each.task.robust for each in tasks):
        return None
    problems = [
        each.path_problem(own, box) for each, own, box in zip(tasks, designs, boxes, strict=True)
    ]
    known = [each for each in problems if each is not None]
    if len(known) < len(problems):
        return None
    given = {place: float(value) for group, value in fixed.items() for place in group}
    limits = [
        _limits(k, path_problem, design, box, given)
        for k, (path_problem, design, box) in enumerate(zip(known, designs, boxes, strict=True))
    ]
    starts = [design.configuration.outcome.trajectory for design in designs]
    found = shared_motion(known, starts, groups, boxes=limits)
    if found is None or not found.feasible:
        return None
    values: dict[tuple[int, int], Fraction] = {}
    for group in groups:
        task, number = group[0]
        # A design's parameter may have been pinned to one value, so use the domain of the box.
        parameter = replace(designs[task].model.parameters[number], domain=boxes[task][number])
        value = nearest_value(parameter, float(found.trajectories[task].theta[number]))
        if value is None:
            return None
        values |= dict.fromkeys(group, fixed.get(group, value.stated))
    return values


def _limits(
    task: int,
    path_problem: PathProblem,
    design: Design,
    box: Box,
    given: Mapping[tuple[int, int], float],
) -> tuple[Array, Array]:
    """Bounds (p,) on the parameters of a task, with given ones fixed to their values."""
    motion = design.configuration.outcome.trajectory
    free = free_parameters(path_problem, motion)
    low, high = (motion.theta.copy(), motion.theta.copy()) if free is None else map(np.copy, free)
    for number, domain in enumerate(box):
        if isinstance(domain, ir.Interval):
            (within,) = ranges_of(domain)
            low[number] = max(low[number], float(within.low))
            high[number] = min(high[number], float(within.high))
        if (task, number) in given:
            low[number] = high[number] = given[task, number]
    return low, high


def least_share(tasks: Sequence[TaskRobots], designs: Sequence[Design]) -> float:
    """The least share of their bounds that inputs leave free; 1 if no input has any range."""
    pairs = zip(designs, tasks, strict=True)
    shares = (
        robustness_share(design, each.task.lasting(len(design.inputs))) for design, each in pairs
    )
    return min((share for share in shares if share is not None), default=1.0)
