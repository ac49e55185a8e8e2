"""When a motion enters the cells of its path, and how the cells constrain the motion.

The search of a configuration leaves the timing along a path free.  The cells that the resulting
motion visits, and when, then become the path along which it is improved.  They guide the motion
without binding it, except for tours, which have to close.
"""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, replace

import numpy as np

from solvers.run_context import RunContext
from solvers.search.evaluation import free_parameters
from solvers.trajectory.control_problem import FULL, ControlOutcome, IterationBudget
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.path_timing import (
    Entries,
    gentle_entries,
    polyline,
    rests_of,
    smooth_timing,
)
from solvers.trajectory.task_limits import effort_scale
from solvers.trajectory.visited_cells import depth_in_cells, visited_cells

BOUND_RADIUS = 0.1
"""The trust region for a motion that is almost feasible."""
RELEASES = 3
RELEASE_RADIUS = 0.3
SHIFTS = (4, 1, -1)
LONGEST_RUN = 6
GAIN = 1e-4
"""The least gain of robustness for which an entry is moved, relative to the effort bound."""
RETIMING = IterationBudget(8, 1e-4, 1e-7, 1)


def timed(path_problem: PathProblem, planned: tuple[int, ...] | None) -> PathProblem:
    """The path problem with entries that its formula allows, spread for the gentlest motion."""
    if path_problem.formula is None:
        return path_problem
    line, steps = polyline(path_problem.abstraction, path_problem.cells), path_problem.task.steps
    known = tuple(range(len(path_problem.cells))) if planned is None else planned
    stops = rests_of(path_problem.obligations(known), path_problem.effector)
    cells = [bisect_right(known, stop) - 1 for stop in stops]
    if planned is None:
        return replace(path_problem, timing=smooth_timing(line, steps, cells)[1])
    timing = gentle_entries(line, planned, steps, path_problem.allows, cells)
    return replace(path_problem, timing=timing)


@dataclass(frozen=True, slots=True)
class Timed:
    """A motion along the cells of a path problem, with the steps at which they are entered."""

    path_problem: PathProblem
    outcome: ControlOutcome
    entries: Entries

    @property
    def scale(self) -> float:
        """The unit of effort."""
        return self.path_problem.problem(self.entries).scale

    @property
    def worth(self) -> float:
        """The worth of the motion."""
        return worth(self.path_problem, self.outcome)

    def gains(self, before: Timed) -> bool:
        """Whether this motion is worth more than ``before`` by more than the minimum gain."""
        return self.worth > before.worth + GAIN * self.scale


def worth(path_problem: PathProblem, outcome: ControlOutcome) -> float:
    """The robustness of an outcome, less the prices of its parameters, in units of effort."""
    if not path_problem.prices:
        return outcome.robustness
    paid = float(np.dot(path_problem.prices, outcome.trajectory.theta))
    return outcome.robustness - effort_scale(path_problem.groups) * paid


def settled(
    path_problem: PathProblem, free: ControlOutcome, entries: Entries, context: RunContext
) -> Timed | None:
    """The best motion from one with free timing; None if it has to be bound to cells and cannot."""
    if path_problem.loop is not None:
        return bound_to_cells(path_problem, free, entries, context)
    best = Timed(replace(path_problem, bound=False), free, entries)
    for _ in range(RELEASES):
        visited = visited_cells(path_problem, best.outcome.trajectory)
        if visited is None:
            break
        along = Timed(replace(path_problem.along(*visited), bound=False), best.outcome, visited[1])
        if path_problem.prices:  # The timing matters little to what parameters cost.
            best = along
            break
        freed = replace(along, outcome=_freed(along, context))
        context.reporter.robustness(freed.outcome.robustness)
        if not freed.outcome.feasible or freed.outcome.robustness <= best.outcome.robustness:
            break
        before, best = best, freed
        if not best.gains(before):
            break
    return _off_facets(path_problem, best, context)


def _off_facets(path_problem: PathProblem, found: Timed, context: RunContext) -> Timed:
    """Bind the motion to its cells if a sample is too close to a facet to prove its side.

    It stays free if binding costs any robustness.
    """
    if depth_in_cells(path_problem, found.outcome.trajectory) >= path_problem.margin:
        return found
    own = replace(found.path_problem, bound=True)
    bound = _bound(own, found.outcome, found.entries, context)
    return found if bound is None or found.gains(bound) else bound


def bound_to_cells(
    path_problem: PathProblem, free: ControlOutcome, entries: Entries, context: RunContext
) -> Timed | None:
    """The motion bound to its cells near one with free timing; None if none is found.

    From the bound motion, the timing is freed again as long as that gains robustness.  Robustness
    that binding still costs is recovered by moving the entries.
    """
    best = _bound(path_problem, free, entries, context)
    for _ in range(RELEASES):
        if best is None:
            break
        freed = _freed(best, context)
        again = _bound(best.path_problem, freed, best.entries, context) if freed.feasible else None
        if again is None or not again.gains(best):
            break
        best, free = again, freed
    if best is None or best.outcome.robustness >= free.robustness - GAIN * best.scale:
        return best
    return _moved_on(best, context)


def _bound(
    path_problem: PathProblem, free: ControlOutcome, entries: Entries, context: RunContext
) -> Timed | None:
    """The motion bound to the cells that a free motion visits.

    The half-planes have kept the free motion on its side of every obstacle, so it visits the path's
    cells or neighbouring ones.  If the visited cells are not a path of the task, the planned path
    is used.
    """
    visited = visited_cells(path_problem, free.trajectory)
    paths = [(path_problem, entries)]
    if visited is not None:
        paths.insert(0, (path_problem.along(*visited), visited[1]))
    for along, steps in paths:
        context.check_time()
        outcome = _solved(along, free, steps, FULL)
        if outcome is not None:
            context.reporter.robustness(outcome.robustness)
            return Timed(along, outcome, steps)
    return None


def _freed(timed: Timed, context: RunContext) -> ControlOutcome:
    """The motion after its timing has been freed again."""
    context.check_time()
    start = timed.outcome.trajectory
    return timed.path_problem.released(
        start, timed.entries, free_parameters(timed.path_problem, start), FULL, RELEASE_RADIUS
    )


def _moved_on(timed: Timed, context: RunContext) -> Timed:
    """Move entry steps one at a time, each further in the same direction while robustness grows."""
    shifts = [(cell, shift) for shift in SHIFTS for cell in range(1, len(timed.entries))]
    for cell, shift in shifts:
        for _ in range(LONGEST_RUN):
            context.check_time()
            entries, path_problem = timed.entries, timed.path_problem
            moved = (*entries[:cell], entries[cell] + shift, *entries[cell + 1 :])
            if not path_problem.allows(moved):
                break
            outcome = _solved(path_problem, timed.outcome, moved, RETIMING)
            if outcome is None or not Timed(path_problem, outcome, moved).gains(timed):
                break
            timed = Timed(path_problem, outcome, moved)
            context.reporter.robustness(outcome.robustness)
    return timed


def _solved(
    path_problem: PathProblem, start: ControlOutcome, entries: Entries, budget: IterationBudget
) -> ControlOutcome | None:
    """The outcome with these entries; None if it is infeasible."""
    box = free_parameters(path_problem, start.trajectory)
    trial = path_problem.solve(start.trajectory, entries, box, budget, BOUND_RADIUS)
    return trial if trial.feasible else None
