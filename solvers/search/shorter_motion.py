"""A motion with fewer steps than a proved one, along its way or a faster one.

Initially the way is traversed as fast as the drives allow.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from math import ceil

import numpy as np

from compiler.arrays import Array
from compiler.workspaces.abstraction import Abstraction
from grammar_lang import ir
from solvers.planner import EffectorPath
from solvers.search.calm_motion import calmer
from solvers.search.cell_timing import settled, worth
from solvers.search.closed_loop import needs_feedback
from solvers.search.configuration_search import Configuration
from solvers.search.evaluation import Evaluator, SolveRequest, free_parameters
from solvers.search.first_motion import followed
from solvers.search.path_search import PathSearch, blocked_by
from solvers.search.path_task import Design, entered
from solvers.search.search_state import PathAttempt
from solvers.trajectory.control import as_it_is
from solvers.trajectory.control_problem import FULL, ControlOutcome, IterationBudget
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.path_timing import Entries
from solvers.trajectory.time_optimal import Timing, fastest_timing
from solvers.trajectory.trajectory import Trajectory

LESS = IterationBudget(40, 1e-3, 1e-9, 6, 2, 2e-3)
"""The effort for a motion whose parameters have prices, which outweigh its robustness by far."""
WAYS = 8
"""Other ways that are timed, from start poses of the task to end poses."""


def fastest_way(paths: PathSearch, best: Design) -> Timing | None:
    """The joint-space way of a design with its fastest timing; None if unknown."""
    path_problem = problem_along(paths, best.abstraction, best, len(best.inputs))
    if path_problem is None:
        return None
    motion = best.configuration.outcome.trajectory
    return _timed(path_problem, motion.theta, motion.x[:, : path_problem.numeric.n])


def faster_way(paths: PathSearch, best: Design, than: Timing | None) -> Timing | None:
    """The fastest way between start and end poses of the task, with the design's parameters.

    Straight ways are timed or, if none is collision-free, ways around obstacles.  None if no way is
    faster than ``than``, or if a formula constrains the motion in between.
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
    """The fastest timing along the way of a motion (k + 1, n), or None if none is known."""
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
    """The attempt at a motion with the number of steps of the task of ``paths``.

    Args:
        paths: the search of paths of such motions.
        cells: the cells of the workspace, used if the design has no refined ones.
        best: the design whose way is followed.
        way: its way with the fastest timing; None to stretch its own timing.
        box: bounds (p,) on the parameters; None for their ranges.
        price: the price on rates relative to calm motions; 0 for the price that feedback needs.
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
    return _solved(paths, replace(path_problem, box=box), [start], label)


def attempt_along(
    paths: PathSearch,
    best: Design,
    starts: Sequence[Trajectory],
    box: tuple[Array, Array],
    name: str,
    prices: tuple[float, ...] = (),
) -> PathAttempt:
    """The attempt at a motion between the ends of a design, with as many steps, from other starts.

    Args:
        paths: the search of paths of such motions.
        best: the design.
        starts: the initial motions; the best motion that one of them leads to is proved.
        box: bounds (p,) on the parameters.
        name: the name of its purpose in journals.
        prices: the prices (p,) of the parameters; empty for the most robust motion.
    """
    path_problem = problem_along(paths, best.abstraction, best, len(best.inputs))
    if path_problem is None:
        return PathAttempt(blocked_by(best.configuration.outcome))
    path_problem = replace(path_problem, box=box, prices=prices)
    return _solved(paths, path_problem, starts, f"{paths.structure.label}|{name}")


def _solved(
    paths: PathSearch,
    path_problem: PathProblem,
    starts: Sequence[Trajectory],
    label: str,
) -> PathAttempt:
    """The attempt at the best motion that one of ``starts`` leads to; there is at least one."""
    context, entries = paths.structure.context, path_problem.waypoints()[1]
    evaluator = Evaluator(path_problem, context.workers, context.journal, label)
    budget = LESS if path_problem.prices else FULL
    requests = [
        SolveRequest(start, entries, free_parameters(path_problem, start), budget, released=True)
        for start in starts
    ]
    outcomes = evaluator.solutions(requests)
    outcome = max(outcomes, key=lambda each: (each.feasible, worth(path_problem, each)))
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
    """The path problem along the cells of a design; None if its formula does not allow it."""
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
    """The cells of the leader of a design, from its samples or else from its search."""
    known = entered(cells, best.leader, best.path[best.leader])
    own = best.configuration
    return EffectorPath(best.leader, own.cells, own.entries) if known is None else known


def _thinned(route: tuple[int, ...], steps: int) -> tuple[int, ...]:
    """As many cells of a route as ``steps`` allow, evenly spaced, including both ends."""
    if len(route) <= max(2, steps):
        return route
    places = np.linspace(0, len(route) - 1, max(2, steps)).round().astype(int)
    return tuple(route[place] for place in places)


def _timed_for_formula(
    found: PathProblem, best: Design, leader: EffectorPath
) -> PathProblem | None:
    """The path problem with the entries of the design, compressed; None if not allowed."""
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


# --- Entries of a motion with fewer steps; each cell keeps a sample of its own --------------------


def _scaled(entries: Entries, old: int, steps: int) -> Entries:
    """Speed up the whole motion."""
    found = list[int]()
    for entry in entries:
        found.append(max(round(entry * steps / old), found[-1] + 1 if found else 0))
    return tuple(found)


def _with_the_end(entries: Entries, old: int, steps: int) -> Entries:
    """Speed up the motion before the last entry; what follows takes as long as before."""
    rest = old - entries[-1]
    return _scaled(entries, max(1, entries[-1]), max(1, steps - rest))


def _cut_short(entries: Entries, old: int, steps: int) -> Entries:
    """Keep the entries as long as possible; what follows the last one takes as long as before."""
    last = steps - (old - entries[-1]) - len(entries) + 1
    return tuple(min(entry, max(0, last) + index) for index, entry in enumerate(entries))


def _seed(
    path_problem: PathProblem, best: Design, way: Timing | None, entries: Entries
) -> Trajectory:
    """The motion along the way of a design, with the inputs that produce it."""
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
    """The number of steps for the end of a motion, as far as its way leaves time for them."""
    task = path_problem.task
    lasts = steps_of_end(task)
    if path_problem.formula is not None:
        spare = task.steps - ceil(way.duration / float(task.step))
        lasts = max(lasts, min(task.steps - entries[-1], spare))
    return lasts


def steps_of_end(task: ir.Task) -> int:
    """The number of steps that the end of a motion has to last."""
    return ceil(task.stay / task.step)
