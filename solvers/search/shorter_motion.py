"""A motion of fewer steps than a proved one, along its way or a faster one between other poses.

That way is gone along as fast as the drives allow at first.
"""

from __future__ import annotations

from dataclasses import replace
from math import ceil

import numpy as np

from compiler.arrays import Array
from compiler.workspaces.abstraction import Abstraction
from grammar_lang import ir
from solvers.planner import EffectorPath
from solvers.search.calm_motion import calmer
from solvers.search.cell_timing import settled
from solvers.search.closed_loop import needs_feedback
from solvers.search.configuration_search import Configuration
from solvers.search.evaluation import Evaluator, SolveRequest, free_parameters
from solvers.search.first_motion import followed
from solvers.search.path_search import PathSearch, blocked_by
from solvers.search.path_task import Design, entered
from solvers.search.search_state import PathAttempt
from solvers.trajectory.control import as_it_is
from solvers.trajectory.control_problem import FULL, ControlOutcome
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.path_timing import Entries
from solvers.trajectory.time_optimal import Timing, fastest_timing
from solvers.trajectory.trajectory import Trajectory

WAYS = 8
"""Other ways that are timed, from poses where the task begins to poses where it ends."""


def fastest_way(paths: PathSearch, best: Design) -> Timing | None:
    """The way of a design in joint space, gone along as fast as the drives allow; None: unknown."""
    path_problem = problem_along(paths, best.abstraction, best, len(best.inputs))
    if path_problem is None:
        return None
    motion = best.configuration.outcome.trajectory
    return _timed(path_problem, motion.theta, motion.x[:, : path_problem.numeric.n])


def faster_way(paths: PathSearch, best: Design, than: Timing | None) -> Timing | None:
    """The fastest way between poses that a task asks for at its ends, with what a design has.

    Straight ones are timed or, where none is clear, ways around obstacles.  None where they are not
    faster ``than`` a known one, or a formula says what happens in between.
    """
    path_problem = problem_along(paths, best.abstraction, best, len(best.inputs))
    if path_problem is None or path_problem.formula is not None:
        return None
    theta = best.configuration.outcome.trajectory.theta
    many = replace(path_problem, branch_count=WAYS)
    ways = many.joint_ways(theta, straight=True, to_edges=True)
    if not ways and path_problem.binds_bodies:
        ways = many.joint_ways(theta, straight=False, to_edges=True)
    timed = [_timed(path_problem, theta, way) for way in ways]
    known = [each for each in (than, *timed) if each is not None]
    fastest = min(known, key=lambda each: each.duration, default=None)
    return None if fastest is than else fastest


def _timed(path_problem: PathProblem, theta: Array, motion: Array) -> Timing | None:
    """The fastest timing along the way of a motion (k + 1, n), None where none is known."""
    numeric, limits = path_problem.numeric, path_problem.limits
    return fastest_timing(numeric, limits, path_problem.groups, theta, motion)


def shorter_motion(
    paths: PathSearch,
    cells: Abstraction,
    best: Design,
    way: Timing | None,
    box: tuple[Array, Array] | None = None,
    price: float = 0.0,
) -> PathAttempt:
    """The attempt at a motion of as many steps as the task of ``paths`` has.

    Args:
        paths: the search of paths of such motions.
        cells: the cells of the workspace, where the design has no others.
        best: the design of which the way is followed.
        way: its way with the fastest timing; None: its own timing, stretched.
        box: bounds (p,) of the parameters; None: their ranges.
        price: that on rates, relative to that of calm motions; 0: what feedback asks for.
    """
    steps = paths.shape.task.steps
    cells = best.abstraction if best.abstraction.cuts else cells
    path_problem = problem_along(paths, cells, best, steps)
    if path_problem is None:
        return PathAttempt(blocked_by(best.configuration.outcome))
    if price:
        path_problem = calmer(path_problem)
        path_problem = replace(path_problem, rates=price * path_problem.rates)
    entries = path_problem.waypoints()[1]
    start = _seed(path_problem, best, way, entries)
    label = f"{paths.structure.label}|shorter{price or ''}"
    return _solved(paths, replace(path_problem, box=box), start, label)


def attempt_along(
    paths: PathSearch, best: Design, start: Trajectory, box: tuple[Array, Array], name: str
) -> PathAttempt:
    """The attempt at a motion of as many steps along the cells of a design, from another start.

    Args:
        paths: the search of paths of such motions.
        best: the design.
        start: the motion to begin with.
        box: bounds (p,) of the parameters.
        name: what it is for, as journals call it.
    """
    path_problem = problem_along(paths, best.abstraction, best, len(best.inputs))
    if path_problem is None:
        return PathAttempt(blocked_by(best.configuration.outcome))
    return _solved(paths, replace(path_problem, box=box), start, f"{paths.structure.label}|{name}")


def _solved(
    paths: PathSearch,
    path_problem: PathProblem,
    start: Trajectory,
    label: str,
) -> PathAttempt:
    """The attempt at a motion from a start."""
    context, entries = paths.structure.context, path_problem.waypoints()[1]
    evaluator = Evaluator(path_problem, context.workers, context.journal, label)
    box = free_parameters(path_problem, start)
    (outcome,) = evaluator.solutions([SolveRequest(start, entries, box, FULL, released=True)])
    at = settled(path_problem, outcome, entries, context) if outcome.feasible else None
    if at is None:
        return PathAttempt(blocked_by(outcome), outcome.robustness)
    found = Configuration(
        at.outcome, at.entries, at.path_problem.cells, bound=at.path_problem.bound
    )
    return paths.proved(path_problem, found, label)


def problem_along(
    paths: PathSearch, cells: Abstraction, best: Design, steps: int
) -> PathProblem | None:
    """The path problem along the cells of a design; None where its formula does not allow that."""
    leader = _route(cells, best)
    if paths.place.on_samples(best.effector) is None:
        leader = replace(leader, cells=_thinned(leader.cells, steps), entries=None)
    found = paths.place.path_problem(cells, best.effector, best.leader, leader.cells)
    if found.formula is not None:
        timed = _timed_for_formula(found, best, leader)
        if timed is None:
            return None
        found = timed
    return calmer(found) if best.controller is not None or needs_feedback(found) else found


def _route(cells: Abstraction, best: Design) -> EffectorPath:
    """The cells of the leader of a design; those that led to it where its samples pass some by."""
    known = entered(cells, best.leader, best.path[best.leader])
    own = best.configuration
    return EffectorPath(best.leader, own.cells, own.entries) if known is None else known


def _thinned(route: tuple[int, ...], steps: int) -> tuple[int, ...]:
    """As many cells of a route as a motion of so many steps may have, evenly, with both ends."""
    if len(route) <= max(2, steps):
        return route
    places = np.linspace(0, len(route) - 1, max(2, steps)).round().astype(int)
    return tuple(route[place] for place in places)


def _timed_for_formula(
    found: PathProblem, best: Design, leader: EffectorPath
) -> PathProblem | None:
    """The path problem entered as the design enters it, faster; None where that is not allowed."""
    old, steps = len(best.inputs), found.task.steps
    others = []
    for effector, names in enumerate(best.path):
        route = entered(found.abstraction, effector, names)
        if effector != best.leader:
            if route is None:
                return None
            others.append(route)
    timed = (
        replace(
            found,
            timing=shorten(leader.entries or (0,), old, steps),
            others=tuple(
                replace(route, entries=shorten(route.entries or (0,), old, steps))
                for route in others
            ),
        )
        for shorten in (_scaled, _with_the_end, _cut_short)
    )
    return next((each for each in timed if each.allows(each.timing or (0,))), None)


# --- Entries of a motion of fewer steps, each cell with a sample of its own -----------------------


def _scaled(entries: Entries, old: int, steps: int) -> Entries:
    """All of the motion goes on faster."""
    found = list[int]()
    for entry in entries:
        found.append(max(round(entry * steps / old), found[-1] + 1 if found else 0))
    return tuple(found)


def _with_the_end(entries: Entries, old: int, steps: int) -> Entries:
    """What comes before the last entry goes on faster, what comes after it takes as long."""
    rest = old - entries[-1]
    return _scaled(entries, max(1, entries[-1]), max(1, steps - rest))


def _cut_short(entries: Entries, old: int, steps: int) -> Entries:
    """Entries stay as they are as long as can be, and what comes after the last takes as long."""
    last = steps - (old - entries[-1]) - len(entries) + 1
    return tuple(min(entry, max(0, last) + index) for index, entry in enumerate(entries))


def _seed(
    path_problem: PathProblem, best: Design, way: Timing | None, entries: Entries
) -> Trajectory:
    """The motion along the way of a design, with the inputs that bring a robot along it."""
    motion, n = best.configuration.outcome.trajectory, path_problem.numeric.n
    steps = path_problem.task.steps
    if way is None:
        places = np.linspace(0.0, len(motion.u), steps + 1)
        samples = np.arange(len(motion.x))
        columns = [np.interp(places, samples, column) for column in motion.x[:, :n].T]
        q: Array = np.stack(columns, axis=1)
    else:
        there = steps - _still(path_problem, way, entries)
        q = way.sampled(max(1, there))
        q = np.concatenate([q, np.repeat(q[-1:], steps + 1 - len(q), axis=0)])
    problem = path_problem.problem(entries, released=True)
    (found,) = followed(path_problem, q[None], motion.theta, problem.loads)
    at: ControlOutcome | None = as_it_is(problem, found)
    return found if at is None else at.trajectory


def _still(path_problem: PathProblem, way: Timing, entries: Entries) -> int:
    """For how many steps the end of a motion lasts, as far as its way leaves time for that."""
    task = path_problem.task
    lasts = steps_of_end(task)
    if path_problem.formula is not None:
        spare = task.steps - ceil(way.duration / float(task.step))
        lasts = max(lasts, min(task.steps - entries[-1], spare))
    return lasts


def steps_of_end(task: ir.Task) -> int:
    """The steps for which the end of a motion is to last."""
    return ceil(task.stay / task.step)
