"""The cells of a motion with free timing, and when it enters them, made the path that binds."""

from __future__ import annotations

from dataclasses import dataclass

from solvers.motions.control_problem import FULL, ControlOutcome, Effort
from solvers.motions.path_following import Follower
from solvers.motions.path_timing import Entries
from solvers.parameters.parameter_space import parameter_space
from solvers.progress import Conduct

RADIUS = 0.1
"""The trust region of a motion that is nearly there."""
SHIFTS = (4, -4, 1, -1)
LONGEST_RUN = 6
GAIN = 1e-4
"""A gain of robustness that is worth moving an entry for, relative to the effort bound."""
RETIMING = Effort(8, 1e-4, 1e-7, 1)


@dataclass(frozen=True, slots=True)
class Timed:
    """A motion along the cells of a follower, entered at some steps."""

    follower: Follower
    outcome: ControlOutcome
    entries: Entries


def bound_to_cells(
    follower: Follower, free: ControlOutcome, entries: Entries, conduct: Conduct
) -> Timed | None:
    """The motion that keeps to its cells next to one whose timing was free; None if none is found.

    The half-planes have kept the free motion on its side of every obstacle, so it visits the path's
    cells or others next to them.  Where that is no path of the task, the planned one binds.  What
    the cells cost is won back by moving their entries.
    """
    visited = follower.visited(free.trajectory)
    for along, timing in (visited, None), (None, entries):
        if along is None and timing is None:
            continue
        other = follower if along is None else follower.along(*along)
        steps = entries if along is None else along[1]
        conduct.check_time()
        outcome = _solved(other, free, steps, FULL)
        if outcome is None:
            continue
        conduct.reporter.robustness(outcome.robustness)
        timed = Timed(other, outcome, steps)
        scale = other.problem(steps).scale
        if outcome.robustness >= free.robustness - GAIN * scale:
            return timed
        return _moved_on(timed, GAIN * scale, conduct)
    return None


def _moved_on(timed: Timed, gain: float, conduct: Conduct) -> Timed:
    """Move entry steps, one at a time and on in the same direction, while the robustness grows."""
    follower, outcome, entries = timed.follower, timed.outcome, timed.entries
    for cell, shift in [(cell, shift) for shift in SHIFTS for cell in range(1, len(entries))]:
        for _ in range(LONGEST_RUN):
            conduct.check_time()
            moved = (*entries[:cell], entries[cell] + shift, *entries[cell + 1 :])
            trial = _solved(follower, outcome, moved, RETIMING) if follower.allows(moved) else None
            if trial is None or trial.robustness <= outcome.robustness + gain:
                break
            outcome, entries = trial, moved
            conduct.reporter.robustness(outcome.robustness)
    return Timed(follower, outcome, entries)


def _solved(
    follower: Follower, start: ControlOutcome, entries: Entries, effort: Effort
) -> ControlOutcome | None:
    """The outcome with these entries, where that is feasible."""
    space = parameter_space(follower.model)
    box = None if space.is_point else space.free_box(start.trajectory.theta)
    trial = follower.solve(start.trajectory, entries, box, effort, RADIUS)
    return trial if trial.feasible else None
