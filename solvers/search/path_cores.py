"""Why a path cannot be followed: a minimal set of its cells, and whether their order matters.

Source: QuickXplain (Junker, *QuickXplain: preferred explanations and relaxations for
over-constrained problems*, AAAI 2004), applied to convex programs around the nearest motion with
the parameters as unknowns.  The first trial keeps only the start, the target and the limits: if no
motion is found then, none is expected along any path.  All of this is local optimisation: it defers
paths and proves nothing.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import combinations, permutations
from typing import TypeAlias

import numpy as np

from solvers.run_context import Recorded, RunContext
from solvers.search.configuration_search import Configuration
from solvers.search.evaluation import free_parameters, outcome_of, record_of
from solvers.search.first_motion import followed
from solvers.trajectory.control_problem import FULL, ControlOutcome, IterationBudget
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.path_relaxation import (
    PathRelaxation,
    nearest_visits,
    straight_visits,
)
from solvers.trajectory.task_limits import effort_scale
from solvers.trajectory.trajectory import Trajectory

TRIAL = IterationBudget(20, 2e-3, 1e-6, 2)
"""The budget for finding a motion through some of the cells."""
ROUNDS = 3
"""The number of times that the samples of visits are chosen in a decisive trial."""
CLEAR = 0.1
"""A violation smaller than this, in units of the effort bound, is no clear failure."""
FEW, GRID = 2, 6
"""For at most ``FEW`` cells, a decisive trial also tries visits at ``GRID`` samples."""
WAYS = 2
"""The number of straight ways in joint space tried when nothing binds in between."""
MOST_ORDERED = 3
"""Other orders are tried for at most this many cells."""


@dataclass(frozen=True, slots=True)
class PathCore:
    """Places (from 0) on a path through whose cells, in this order, no motion was found.

    An empty tuple means that no motion was found even without cells.  If not ``ordered``, no motion
    was found in any other order either.
    """

    places: tuple[int, ...]
    ordered: bool = True


Explanation: TypeAlias = PathCore | ControlOutcome | None
"""A core, or a motion if there is one after all, or None if nothing is known."""


@dataclass(frozen=True, slots=True)
class PathCores:
    """Explains why paths of a robot were not followed; ``name`` is the robot's in the journal."""

    context: RunContext
    name: str

    def explained(self, path_problem: PathProblem, found: Configuration, label: str) -> Explanation:
        """Why there is no motion along a path.

        Args:
            path_problem: the path; the answer is None if a formula or a loop binds the motion.
            found: the nearest motion along it.
            label: the name of the path in the journal.
        """
        if path_problem.formula is not None or path_problem.loop is not None:
            return None
        key, journal = f"{label}|core", self.context.journal
        known = _recalled(journal.recall(key))
        if known is None:
            known = (self._explained(path_problem, found),)
            journal.record(key, _recorded(*known))
        return known[0]

    def _explained(self, path_problem: PathProblem, found: Configuration) -> Explanation:
        free = self._free(path_problem, found)
        if not free.feasible:
            return PathCore(())
        facts = _facts(path_problem)
        starts = free.trajectory, found.outcome.trajectory
        alone = _Trials(path_problem, found, starts, self.context, apart=False)
        core = alone.core(facts)
        if core is not None:
            return core
        apart = replace(alone, apart=True)
        motion = apart.motion(()) or apart.motion(facts)
        if motion is not None:
            return motion
        # All cells together determine on which sides the path passes the avoided regions.
        return PathCore(tuple(range(len(path_problem.cells))))

    def _free(self, path_problem: PathProblem, found: Configuration) -> ControlOutcome:
        """The motion that is not constrained between start and target; it may be infeasible."""
        key, journal = f"{self.name}|free", self.context.journal
        known = journal.recall(key)
        outcome = outcome_of(known)
        if outcome is None:
            outcome = self._searched_free(path_problem, found)
            journal.record(key, record_of(outcome))
        return outcome

    def _searched_free(self, path_problem: PathProblem, found: Configuration) -> ControlOutcome:
        relaxation = PathRelaxation(path_problem, {}, apart=False)
        problem, theta = relaxation.problem(found.entries), found.outcome.trajectory.theta
        ways = path_problem.joint_ways(theta, straight=True)[:WAYS]
        starts = [found.outcome.trajectory]
        if ways:
            starts += followed(path_problem, np.array(ways), theta, problem.loads)
        best = found.outcome
        for start in starts:
            self.context.check_time()
            box = free_parameters(path_problem, start)
            outcome = relaxation.outcome(start, found.entries, box, FULL)
            if outcome.feasible:
                return outcome
            best = max(best, outcome, key=lambda each: each.robustness)
        return best


@dataclass(frozen=True, slots=True)
class _Trials:
    """Searches for motions through some cells of a path, each from the same ``starts``."""

    path_problem: PathProblem
    found: Configuration
    starts: tuple[Trajectory, ...]
    context: RunContext
    apart: bool

    def best(self, kept: Sequence[int], rounds: int) -> ControlOutcome:
        """The first motion through the cells at the places ``kept``, in order; else the nearest.

        The samples of the visits are read off the motion from which a search starts, and are chosen
        anew in each of the ``rounds``.
        """
        path_problem, outcomes = self.path_problem, list[ControlOutcome]()
        begun = [(start, nearest_visits(path_problem, kept, start)) for start in self.starts]
        straight = straight_visits(path_problem, kept)
        if straight != begun[0][1]:
            begun.append((self.starts[0], straight))
        if rounds > 1 and 0 < len(kept) <= FEW and self._ends.isdisjoint(kept):
            begun += [(self.starts[0], times) for times in self._grid(kept)]
        for first, planned in begun:
            start, times, tried = first, planned, list[dict[int, int]]()
            while len(tried) < rounds and times not in tried:
                tried.append(times)
                self.context.check_time()
                relaxation = PathRelaxation(path_problem, times, self.apart)
                box = free_parameters(path_problem, start)
                outcome = relaxation.outcome(start, self.found.entries, box, TRIAL)
                if outcome.feasible:
                    return outcome
                outcomes.append(outcome)
                start = outcome.trajectory
                times = nearest_visits(path_problem, kept, start)
        return max(outcomes, key=lambda each: each.robustness)

    @property
    def _ends(self) -> set[int]:
        """The first and the last place, visited at the first and the last sample."""
        return {0, len(self.path_problem.cells) - 1}

    def _grid(self, kept: Sequence[int]) -> Iterator[dict[int, int]]:
        """Sample times for visits of a few places, spread over the motion."""
        samples = np.linspace(0, self.path_problem.task.steps, GRID + 2).round().astype(int)[1:-1]
        for times in combinations(samples.tolist(), len(kept)):
            yield dict(zip(kept, times, strict=True))

    def motion(self, kept: Sequence[int]) -> ControlOutcome | None:
        """A motion through these cells, or None."""
        found = self.best(kept, 1)
        return found if found.feasible else None

    def fails(self, kept: Sequence[int], rounds: int = 1) -> bool:
        """Whether no motion is found, by a clear margin."""
        found = self.best(kept, rounds)
        scale = effort_scale(self.path_problem.groups)
        return not found.feasible and found.robustness < -CLEAR * scale

    def core(self, places: Sequence[int]) -> PathCore | None:
        """A minimal set of places that fails, also in a decisive trial; None if there is none."""
        if not self.fails(places):
            return None
        least = quick_explanation(places, self.fails)
        if not least or not self.fails(least, ROUNDS):
            return None
        return PathCore(least, ordered=not self._fail_in_any_order(least))

    def _fail_in_any_order(self, places: tuple[int, ...]) -> bool:
        """Whether a few places also fail in every other order; False if an end is among them."""
        if not 1 < len(places) <= MOST_ORDERED or not self._ends.isdisjoint(places):
            return False
        others = [order for order in permutations(places) if order != places]
        return all(map(self.fails, others))


def _facts(path_problem: PathProblem) -> tuple[int, ...]:
    """The places of a path except ends whose cell is a whole region."""
    cells = [path_problem.abstraction.cells[cell] for cell in path_problem.cells]
    last = len(cells) - 1
    return tuple(
        place for place, cell in enumerate(cells) if 0 < place < last or cell.name != cell.region
    )


def quick_explanation(
    facts: Sequence[int], fails: Callable[[tuple[int, ...]], bool]
) -> tuple[int, ...]:
    """QuickXplain: a minimal set of ascending facts that fail, given that all of them do.

    Earlier facts are preferred.  The set is minimal if adding facts never turns a failure into
    success.
    """

    def least(background: tuple[int, ...], left: Sequence[int], *, grown: bool) -> tuple[int, ...]:
        if grown and fails(tuple(sorted(background))):
            return ()
        if len(left) == 1:
            return tuple(left)
        half = len(left) // 2
        first, second = tuple(left[:half]), tuple(left[half:])
        of_second = least((*background, *first), second, grown=True)
        of_first = least((*background, *of_second), first, grown=bool(of_second))
        return (*of_first, *of_second)

    return tuple(sorted(least((), tuple(facts), grown=True))) if facts else ()


# --- the journal ----------------------------------------------------------------------------------


def _recorded(found: Explanation) -> Recorded:
    """An explanation as a JSON value."""
    match found:
        case PathCore(places, ordered):
            return {"places": list(places), "ordered": ordered}
        case None:
            return {}
        case motion:
            return {"motion": record_of(motion)}


def _recalled(record: Recorded) -> tuple[Explanation] | None:
    """The explanation in a record; None if the record is not of this version."""
    match record:
        case {"places": list(places), "ordered": bool(ordered)}:
            return (PathCore(tuple(int(str(place)) for place in places), ordered),)
        case {"motion": motion}:
            outcome = outcome_of(motion)
            return None if outcome is None else (outcome,)
        case dict() if not record:
            return (None,)
        case _:
            return None
