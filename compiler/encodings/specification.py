"""What a task asks of paths through the cells.

Source: Section 4.2 (the set of runs from the initial region to the target that avoid obstacles),
with correction 4.18: ``reach`` is about the last instant only, the target may be entered early.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import assert_never

from compiler.geometry.abstraction import Abstraction
from grammar_lang.ir import StartAt, StartIn, Task


@dataclass(frozen=True, slots=True)
class PathProblem:
    """Find a path of adjacent cells from ``start`` to ``target`` without ``forbidden``.

    All three are ascending indices of cells; start and target may contain forbidden cells.
    """

    start: tuple[int, ...]
    target: tuple[int, ...]
    forbidden: tuple[int, ...]


def path_problem(
    abstraction: Abstraction, task: Task, start_cells: Sequence[int] | None = None
) -> PathProblem:
    """The path problem of an effector.

    Cells inside a region that ``avoid ... with effector`` names are forbidden.  ``with body`` does
    not bind the effector's own point, and a margin does not either: they are left to the control
    synthesis and the proof, so that the path problem has every path a robot can follow.

    Args:
        abstraction: the cells of the task's workspace.
        task: the task.
        start_cells: the cells to start in, for ``start at (...)``, where they depend on the robot.

    Raises:
        ValueError: ``start at (...)`` without ``start_cells``.
    """
    match task.start:
        case StartIn(region=region):
            start = abstraction.within([region])
        case StartAt():
            if start_cells is None:
                raise ValueError("the cell of a start pose depends on the robot: give start_cells")
            start = tuple(sorted(set(start_cells)))
        case _:
            assert_never(task.start)
    avoided = [
        name for avoid in task.avoid if avoid.subject == "effector" for name in avoid.regions
    ]
    return PathProblem(
        start=start,
        target=abstraction.within([task.goal.region]),
        forbidden=abstraction.within(avoided),
    )
