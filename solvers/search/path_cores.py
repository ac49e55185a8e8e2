"""Why a path cannot be followed: a minimal set of its cells, and whether their order matters.

Source: QuickXplain (Junker, *QuickXplain: preferred explanations and relaxations for
over-constrained problems*, AAAI 2004), on convex programs about the nearest motion, parameters
being unknowns of them.  First nothing binds but the start, the target and the limits: where no
motion is found then, none is expected along any path.  All of this is local optimisation: it
defers paths and proves nothing.
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
"""How hard is tried to find a motion through some of the cells."""
ROUNDS = 3
"""So often are the samples chosen at which cells are visited, where that decides."""
CLEAR = 0.1
"""What violates less than this, in units of the effort bound, has not failed clearly."""
FEW, GRID = 2, 6
"""Of so few cells a closer look tries visits at so many samples."""
WAYS = 2
"""So many straight ways in joint space are tried where nothing binds on the way."""
MOST_ORDERED = 3
"""Of more cells than this no other order is tried."""


@dataclass(frozen=True, slots=True)
class PathCore:
    """Places (from 0) on a path through whose cells, in turn, no motion was found.

    No place at all: none was found whatever the cells.  Where they are not ``ordered``, none was
    found in another order either.
    """

    places: tuple[int, ...]
    ordered: bool = True


Explanation: TypeAlias = PathCore | ControlOutcome | None
"""A core, a motion where there is one after all, or nothing that is known."""


@dataclass(frozen=True, slots=True)
class PathCores:
    """Explains paths of a robot that were not followed; ``name`` is that of it in the journal."""

    context: RunContext
    name: str

    def explained(self, path_problem: PathProblem, found: Configuration, label: str) -> Explanation:
        """Why there is no motion along a path.

        Args:
            path_problem: the path; nothing is known where a formula or a loop binds the motion.
            found: the nearest motion along it.
            label: names the path in the journal.
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
        # The sides on which the path passes what is to be avoided are those of its cells together.
        return PathCore(tuple(range(len(path_problem.cells))))

    def _free(self, path_problem: PathProblem, found: Configuration) -> ControlOutcome:
        """The motion to which nothing is bound on the way; it may be infeasible."""
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
    """Searches for motions through some of the cells of a path, each from the same ``starts``."""

    path_problem: PathProblem
    found: Configuration
    starts: tuple[Trajectory, ...]
    context: RunContext
    apart: bool

    def best(self, kept: Sequence[int], rounds: int) -> ControlOutcome:
        """The first motion through the cells at the places ``kept`` in turn; else the nearest.

        When they are visited is read off the motion that a search starts from, and is set anew for
        each of its ``rounds``.
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
        """Samples for visits of a few places, from all over the motion."""
        samples = np.linspace(0, self.path_problem.task.steps, GRID + 2).round().astype(int)[1:-1]
        for times in combinations(samples.tolist(), len(kept)):
            yield dict(zip(kept, times, strict=True))

    def motion(self, kept: Sequence[int]) -> ControlOutcome | None:
        """A motion through these cells."""
        found = self.best(kept, 1)
        return found if found.feasible else None

    def fails(self, kept: Sequence[int], rounds: int = 1) -> bool:
        """Whether none is found, by far."""
        found = self.best(kept, rounds)
        scale = effort_scale(self.path_problem.groups)
        return not found.feasible and found.robustness < -CLEAR * scale

    def core(self, places: Sequence[int]) -> PathCore | None:
        """A minimal set of places that fails; None where none does, also at a closer look."""
        if not self.fails(places):
            return None
        least = quick_explanation(places, self.fails)
        if not least or not self.fails(least, ROUNDS):
            return None
        return PathCore(least, ordered=not self._fail_in_any_order(least))

    def _fail_in_any_order(self, places: tuple[int, ...]) -> bool:
        """Whether few places fail in every other order, too; those at the ends have theirs."""
        if not 1 < len(places) <= MOST_ORDERED or not self._ends.isdisjoint(places):
            return False
        others = [order for order in permutations(places) if order != places]
        return all(map(self.fails, others))


def _facts(path_problem: PathProblem) -> tuple[int, ...]:
    """The places of a path but those at its ends whose cells are all of a region."""
    cells = [path_problem.abstraction.cells[cell] for cell in path_problem.cells]
    last = len(cells) - 1
    return tuple(
        place for place, cell in enumerate(cells) if 0 < place < last or cell.name != cell.region
    )


def quick_explanation(
    facts: Sequence[int], fails: Callable[[tuple[int, ...]], bool]
) -> tuple[int, ...]:
    """QuickXplain: a minimal set of ascending facts that fail, where all of them do.

    The facts before are preferred.  It is minimal where more facts never fail less.
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
    """What was found as a value of JSON."""
    match found:
        case PathCore(places, ordered):
            return {"places": list(places), "ordered": ordered}
        case None:
            return {}
        case motion:
            return {"motion": record_of(motion)}


def _recalled(record: Recorded) -> tuple[Explanation] | None:
    """What a record says; None where it is none of this version."""
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
