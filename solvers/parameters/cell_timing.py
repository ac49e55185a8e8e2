"""The cells of a motion with free timing, and when it enters them, made the path that binds."""

from __future__ import annotations

from dataclasses import dataclass

from compiler.arrays import Array
from solvers.motions.control_problem import FULL, ControlOutcome, Effort
from solvers.motions.path_following import Follower
from solvers.motions.path_timing import Entries
from solvers.motions.trajectory import Trajectory
from solvers.parameters.parameter_space import parameter_space
from solvers.progress import Conduct

RADIUS = 0.1
"""The trust region of a motion that is nearly there."""
RELEASES = 3
RELEASE_RADIUS = 0.3
SHIFTS = (4, 1, -1)
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

    @property
    def scale(self) -> float:
        """The unit of effort."""
        return self.follower.problem(self.entries).scale

    def gains(self, before: Timed) -> bool:
        """Whether it is more robust than another one, by more than is worth its time."""
        return self.outcome.robustness > before.outcome.robustness + GAIN * self.scale


def bound_to_cells(
    follower: Follower, free: ControlOutcome, entries: Entries, conduct: Conduct
) -> Timed | None:
    """The motion that keeps to its cells next to one whose timing was free; None if none is found.

    From the motion that they bind, timing is freed again as long as that gains; what the cells cost
    in the end is won back by moving their entries.
    """
    best = _bound(follower, free, entries, conduct)
    for _ in range(RELEASES):
        if best is None:
            break
        freed = _freed(best, conduct)
        again = _bound(best.follower, freed, best.entries, conduct) if freed.feasible else None
        if again is None or not again.gains(best):
            break
        best, free = again, freed
    if best is None or best.outcome.robustness >= free.robustness - GAIN * best.scale:
        return best
    return _moved_on(best, conduct)


def _bound(
    follower: Follower, free: ControlOutcome, entries: Entries, conduct: Conduct
) -> Timed | None:
    """The cells that a free motion visits made to bind.

    The half-planes have kept it on its side of every obstacle, so it visits the path's cells or
    others next to them.  Where that is no path of the task, the planned one binds.
    """
    visited = follower.visited(free.trajectory)
    paths = [(follower, entries)]
    if visited is not None:
        paths.insert(0, (follower.along(*visited), visited[1]))
    for along, steps in paths:
        conduct.check_time()
        outcome = _solved(along, free, steps, FULL)
        if outcome is not None:
            conduct.reporter.robustness(outcome.robustness)
            return Timed(along, outcome, steps)
    return None


def _freed(timed: Timed, conduct: Conduct) -> ControlOutcome:
    """The motion with its timing free again."""
    conduct.check_time()
    start = timed.outcome.trajectory
    return timed.follower.released(
        start, timed.entries, free_parameters(timed.follower, start), FULL, RELEASE_RADIUS
    )


def _moved_on(timed: Timed, conduct: Conduct) -> Timed:
    """Move entry steps, one at a time and on in the same direction, while the robustness grows."""
    shifts = [(cell, shift) for shift in SHIFTS for cell in range(1, len(timed.entries))]
    for cell, shift in shifts:
        for _ in range(LONGEST_RUN):
            conduct.check_time()
            entries, follower = timed.entries, timed.follower
            moved = (*entries[:cell], entries[cell] + shift, *entries[cell + 1 :])
            if not follower.allows(moved):
                break
            outcome = _solved(follower, timed.outcome, moved, RETIMING)
            if outcome is None or not Timed(follower, outcome, moved).gains(timed):
                break
            timed = Timed(follower, outcome, moved)
            conduct.reporter.robustness(outcome.robustness)
    return timed


def _solved(
    follower: Follower, start: ControlOutcome, entries: Entries, effort: Effort
) -> ControlOutcome | None:
    """The outcome with these entries, where that is feasible."""
    box = free_parameters(follower, start.trajectory)
    trial = follower.solve(start.trajectory, entries, box, effort, RADIUS)
    return trial if trial.feasible else None


def free_parameters(follower: Follower, about: Trajectory) -> tuple[Array, Array] | None:
    """The box in which parameters are unknowns next to a motion; None where none may vary."""
    space = parameter_space(follower.model)
    return None if space.is_point else space.free_box(about.theta)
