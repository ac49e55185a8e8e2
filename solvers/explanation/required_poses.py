"""The search for all poses that a task requires: a cheap sign that the task may be possible.

Here a lack of poses proves nothing, and poses do not prove that there is a motion.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import islice

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.encodings.body_smt import body_scripts
from compiler.encodings.pose_questions import body_conditions, pose_questions
from compiler.robots.attributes import SemanticsError
from compiler.robots.candidate import robot_in_task
from compiler.robots.normal_form import family_of
from compiler.robots.robot_key import robot_key_in_task
from compiler.words.derivation import Derivation
from solvers.explanation.conflict import is_cut_off
from solvers.explanation.posed_task import PosedTask
from solvers.impossibility.pose_search import clear_poses, find_poses

MOST_ROBOTS = 6
"""The most robots that are followed when a value is searched."""


def with_poses(
    posed: PosedTask, derivations: Iterable[Derivation], seed: int, robots: int = MOST_ROBOTS
) -> tuple[Derivation, ...]:
    """The first few different robots for which all poses that the task requires are found."""
    if is_cut_off(posed):
        return ()
    return tuple(islice(_posable(posed.expanded(), derivations, seed), robots))


def _posable(
    posed: PosedTask, derivations: Iterable[Derivation], seed: int
) -> Iterator[Derivation]:
    family = family_of(posed.program, posed.task)
    seen = set[str]()
    for derivation in derivations:
        try:
            model = robot_in_task(family, posed.task.origin, derivation)
        except SemanticsError:
            continue
        key = robot_key_in_task(model, posed.task)
        if key in seen:
            continue
        seen.add(key)
        if _answered(NumericRobot(robot_graph(model, posed.task.gravity)), posed, seed):
            yield derivation


def _answered(numeric: NumericRobot, posed: PosedTask, seed: int) -> bool:
    """Whether poses are found for every question."""
    workspace, task = posed.workspace, posed.task
    demands = body_conditions(workspace, task)
    for question in pose_questions(workspace, task):
        if find_poses(numeric, question, seed) is None:
            return False
        if demands is None:
            continue
        known = clear_poses(numeric, workspace, task, question, seed)
        if any(poses not in known for poses in body_scripts(question)):
            return False
    return True


def first_with_poses(
    posed_at: Sequence[PosedTask],
    derivations: Sequence[Derivation],
    seed: int,
    tick: Callable[[], None] = lambda: None,
) -> int | None:
    """The index of the first of weaker and weaker tasks for which poses are found, by bisection.

    The search may miss poses in a range that is far too wide, so if the last task seems to have
    none, earlier ones are tried.  None if these have none either.  ``tick`` is called repeatedly.
    """
    high = len(posed_at) - 1
    while not (hopeful := with_poses(posed_at[high], derivations, seed)):
        tick()
        if not high:
            return None
        high //= 2
    low = 0
    while low < high:
        tick()
        middle = (low + high) // 2
        if with_poses(posed_at[middle], hopeful, seed, robots=1):
            high = middle
        else:
            low = middle + 1
    return low
