"""The first feasible motion, proved before anything is improved."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from compiler.words.derivation import Derivation
from grammar_lang import ir
from solvers.search.certified_design import certified_design
from solvers.search.closed_loop import feedback_choices
from solvers.search.configuration_search import Configuration
from solvers.search.path_task import Design
from solvers.trajectory.control_problem import ControlOutcome
from solvers.trajectory.fine_motion import unstable
from solvers.trajectory.path_following import PathProblem


def early_design(
    program: ir.Program,
    task: ir.Task,
    derivation: Derivation,
    path_problem: PathProblem,
    outcome: ControlOutcome,
    tick: Callable[[], None],
) -> Design | None:
    """The design of a motion as it was found, if it is proved to do the task.

    None, and no proof is tried, where motions go on for ever, where the task names disturbances or
    where inputs alone do not cause the motion: such ones take preparation.
    """
    if (
        task.repeat
        or task.robust is not None
        or False not in feedback_choices(path_problem, outcome)
    ):
        return None
    found = replace(path_problem, bound=False)
    if unstable(found, outcome.trajectory):
        return None
    entries = path_problem.waypoints()[1]
    configuration = Configuration(outcome, entries, path_problem.cells, bound=False)
    answer = certified_design(program, task, derivation, found, configuration, tick, last=False)
    return answer if isinstance(answer, Design) else None
