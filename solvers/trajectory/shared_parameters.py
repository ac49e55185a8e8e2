"""Motions along paths by robots with common parameters: maximise the least robustness.

One robot does several tasks, or robots are rebuilt between tasks and kept modules keep their
values.  The method is in ``shared_control.py``.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from compiler.arrays import Array
from solvers.parameters.parameter_search import parameter_space
from solvers.trajectory.control_problem import FULL, IterationBudget
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.path_timing import Entries
from solvers.trajectory.round_set import turning
from solvers.trajectory.shared_control import (
    Box,
    SharedOutcome,
    SharedTask,
    shared_control,
)
from solvers.trajectory.trajectory import Trajectory


def shared_motion(
    problems: Sequence[PathProblem],
    starts: Sequence[Trajectory],
    links: Iterable[Iterable[tuple[int, int]]],
    budget: IterationBudget = FULL,
    *,
    entries: Sequence[Entries] | None = None,
    boxes: Sequence[Box] | None = None,
) -> SharedOutcome | None:
    """Motions with linked parameters equal; the least of their shares of robustness is maximised.

    Arguments are those of ``shared_control``.  ``entries`` are the samples at which each path
    enters its cells, None for its own timing.  ``boxes`` (p,) bound the parameters of each problem,
    None for their ranges.  None is returned if linked parameters have no common value: discrete
    values stay fixed.

    Raises:
        ValueError: if a link names a parameter that does not exist.
    """
    timing = [each.waypoints()[1] for each in problems] if entries is None else entries
    given = [None] * len(problems) if boxes is None else boxes
    tasks = [
        SharedTask(
            turning(each.problem(times), start), start,
            parameter_box(each, start.theta) if box is None else box,
        )
        for each, times, start, box in zip(problems, timing, starts, given, strict=True)
    ]  # fmt: skip
    return shared_control(tasks, links, budget)


def parameter_box(path_problem: PathProblem, theta: Array) -> Box:
    """The ranges (p,) of parameters about theta (p,); discrete ones stay fixed."""
    ranges = parameter_space(path_problem.model).free_box(theta)
    if ranges is None:
        return theta, theta
    if path_problem.box is None:
        return ranges
    low, high = path_problem.box
    return np.maximum(ranges[0], low), np.minimum(ranges[1], high)
