"""When a motion enters the cells of its path, and what these cells do to it.

The search of a configuration leaves the timing along a path free.  Then the cells that such a
motion visits, and when, become the path by which it is improved.  They guide it and do not bind;
only those of tours do, which have to close.
"""

from __future__ import annotations

from bisect import bisect_right
from dataclasses import dataclass, replace

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
from solvers.trajectory.visited_cells import depth_in_cells, visited_cells

BOUND_RADIUS = 0.1
"""The trust region of a motion that is nearly there."""
RELEASES = 3
RELEASE_RADIUS = 0.3
SHIFTS = (4, 1, -1)
LONGEST_RUN = 6
GAIN = 1e-4
"""A gain of robustness that is worth moving an entry for, relative to the effort bound."""
RETIMING = IterationBudget(8, 1e-4, 1e-7, 1)


def timed(path_problem: PathProblem, planned: tuple[int, ...] | None) -> PathProblem:
    """The path problem with entries that its formula allows, as gentle as can be."""
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
    """A motion along the cells of a path problem, entered at some steps."""

    path_problem: PathProblem
    outcome: ControlOutcome
    entries: Entries

    @property
    def scale(self) -> float:
        """The unit of effort."""
        return self.path_problem.problem(self.entries).scale

    def gains(self, before: Timed) -> bool:
        """Whether it is more robust than another one, by more than is worth its time."""
        return self.outcome.robustness > before.outcome.robustness + GAIN * self.scale


def settled(
    path_problem: PathProblem, free: ControlOutcome, entries: Entries, context: RunContext
) -> Timed | None:
    """The best motion from one whose timing was free; None: it cannot be bound where it has to."""
    if path_problem.loop is not None:
        return bound_to_cells(path_problem, free, entries, context)
    best = Timed(replace(path_problem, bound=False), free, entries)
    for _ in range(RELEASES):
        visited = visited_cells(path_problem, best.outcome.trajectory)
        if visited is None:
            break
        along = Timed(replace(path_problem.along(*visited), bound=False), best.outcome, visited[1])
        freed = replace(along, outcome=_freed(along, context))
        context.reporter.robustness(freed.outcome.robustness)
        if not freed.outcome.feasible or freed.outcome.robustness <= best.outcome.robustness:
            break
        before, best = best, freed
        if not best.gains(before):
            break
    return _off_facets(path_problem, best, context)


def _off_facets(path_problem: PathProblem, found: Timed, context: RunContext) -> Timed:
    """The motion, bound to its cells where a sample is so near a facet that no proof sees its side.

    It stays free where that costs it anything.
    """
    if depth_in_cells(path_problem, found.outcome.trajectory) >= path_problem.margin:
        return found
    own = replace(found.path_problem, bound=True)
    bound = _bound(own, found.outcome, found.entries, context)
    return found if bound is None or found.gains(bound) else bound


def bound_to_cells(
    path_problem: PathProblem, free: ControlOutcome, entries: Entries, context: RunContext
) -> Timed | None:
    """The motion that keeps to its cells next to one whose timing was free; None if none is found.

    From the motion that they bind, timing is freed again as long as that gains; what the cells cost
    in the end is won back by moving their entries.
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
    """The cells that a free motion visits made to bind.

    The half-planes have kept it on its side of every obstacle, so it visits the path's cells or
    others next to them.  Where that is no path of the task, the planned one binds.
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
    """The motion with its timing free again."""
    context.check_time()
    start = timed.outcome.trajectory
    return timed.path_problem.released(
        start, timed.entries, free_parameters(timed.path_problem, start), FULL, RELEASE_RADIUS
    )


def _moved_on(timed: Timed, context: RunContext) -> Timed:
    """Move entry steps, one at a time and on in the same direction, while the robustness grows."""
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
    """The outcome with these entries, where that is feasible."""
    box = free_parameters(path_problem, start.trajectory)
    trial = path_problem.solve(start.trajectory, entries, box, budget, BOUND_RADIUS)
    return trial if trial.feasible else None
