"""The search of a structure in a task with objectives, or with an upper bound as its horizon.

First a motion is sought that takes the whole horizon; if the horizon is a bound, then motions that
take parts of it.  A proved design is improved, one objective after another: its way is traversed as
fast as its drives allow, its parameters are reduced, its efforts are lowered.  If no motion is
found for some number of steps, nothing follows: a shorter motion may exist, as may a longer one.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import chain
from math import ceil

import numpy as np

from compiler.arrays import Array
from compiler.objectives.least_values import amounts
from compiler.workspaces.abstraction import Abstraction
from solvers.search.lessened_parameters import Improved, LessenedParameters, kept_box, least_ends
from solvers.search.path_search import PathSearch, StructureTask
from solvers.search.path_task import Design
from solvers.search.round_task import round_tasks, tasks_by_length, tasks_of_other_lengths
from solvers.search.search_state import PathAttempt, StructureState
from solvers.search.shorter_motion import (
    faster_way,
    fastest_way,
    shorter_motion,
    steps_of_end,
)
from solvers.search.structure_search import StructureSearch
from solvers.trajectory.time_optimal import Timing

FEWEST = 0.5
"""The fewest steps tried, relative to the fastest timing of a known way."""
CALM = 0.0, 1.0, 10.0
"""Prices on rates for motions of less energy, relative to the price for calm motions."""
LENGTHS = 10
"""The search ends after this many numbers of steps that had paths but no motion."""
ATTEMPTS = 12
"""The number of step counts tried for a shorter motion of a structure."""


@dataclass(frozen=True, slots=True)
class ObjectiveSearch:
    """The search of a structure in a workspace divided into ``cells``."""

    given: StructureTask
    cells: Abstraction

    def states(self, effectors: Sequence[int]) -> Iterator[StructureState]:
        """Yield the state after each attempt; the last one says why no more are made.

        ``effectors`` (from 0) are those that may start and reach, the most promising first.
        """
        state, reason = StructureState(), ""
        lengths, asked = 0, self.given.task
        for task in chain(tasks_by_length(asked), tasks_of_other_lengths(asked)):
            before = state.attempts
            for found in StructureSearch(self.lasting(task.steps), self.cells).states(effectors):
                state = replace(found, attempts=(*before, *found.attempts), reason=None)
                reason = reason or found.reason or ""
                yield state
            lengths += len(state.attempts) > len(before)
            if state.design is not None or lengths == LENGTHS:
                break
        best = state.design
        for attempt in self.improved(best) if best is not None else ():
            state = replace(state, attempts=(*state.attempts, attempt))
            yield state
        yield replace(state, reason=reason or "no motion was found")

    def improved(self, best: Design) -> Iterator[PathAttempt]:
        """Attempts at designs with smaller objectives, one objective after another."""
        held, longest = np.full(len(best.model.parameters), np.nan), len(best.inputs)
        asked = amounts(self.given.program, self.given.task)
        for place, amount in enumerate(asked):
            kind = amount.objective.kind
            if kind == "time" and self.given.task.at_most:
                best = yield from self.shorter(best, held)
                longest = int(len(best.inputs) * (1 + amount.objective.within))
            elif kind in ("mass", "sum"):
                paths = self.paths(best, len(best.inputs))
                best = yield from LessenedParameters(paths, asked[place:], held).attempts(best)
                theta = best.configuration.outcome.trajectory.theta
                ends = least_ends(amount, best.model, theta)
                held = np.where(np.isnan(held), ends, held)
            elif kind in ("energy", "effort"):
                yield from self.gentler(best, held, longest, CALM if kind == "energy" else (0.0,))

    def gentler(
        self, best: Design, held: Array, longest: int, prices: Sequence[float]
    ) -> Iterator[PathAttempt]:
        """Attempts at motions of ``longest`` steps, with several prices on rates.

        Parameters get no farther from the ends of their ranges in ``held`` (p,).
        """
        steps = len(best.inputs)
        due = [price for price in prices if price or longest != steps]
        if not due:
            return
        paths, box, way = self.paths(best, longest), self.box(best, held), self.own_way(best)
        for price in due:
            self.given.context.check_time()
            yield shorter_motion(paths, self.cells, best, way, box, price)

    def box(self, best: Design, held: Array) -> tuple[Array, Array] | None:
        """Bounds (p,) for parameters that get no farther from the ends in ``held``."""
        if np.isnan(held).all():
            return None
        return kept_box(best.model, best.configuration.outcome.trajectory.theta, held)

    def lasting(self, steps: int) -> StructureTask:
        """The structure in the task of motions of this many steps."""
        if not self.given.task.at_most:
            return self.given
        task, name = self.given.task.lasting(steps), f"{self.given.number}@{steps}"
        return replace(self.given, task=task, name=name)

    def shorter(self, best: Design, held: Array) -> Improved:
        """Attempts at motions of fewer and fewer steps, along the fastest known way.

        This is the way of the best design so far, or another one between poses of the task.
        Parameters get no farther from the ends of their ranges in ``held`` (p,).
        """
        counts, own = _StepCounts(self.given.task.fewest_steps - 1), self.own_way(best)
        other = faster_way(self.paths(best, len(best.inputs)), best, own)
        stuck = False
        for _ in range(ATTEMPTS):
            most = len(best.inputs)
            way = own if other is None or (own and own.duration <= other.duration) else other
            steps = counts.following(most, most if way is None else self.fewest(way))
            if steps is None and not stuck and most - 1 > counts.hopeless:
                # The way of the newest design may succeed where another one failed.
                way, steps = own, most - 1
            if steps is None:
                break
            self.given.context.check_time()
            attempt = shorter_motion(
                self.paths(best, steps), self.cells, best, way, self.box(best, held)
            )
            yield attempt
            if attempt.design is None:
                counts.fail(steps)
                stuck = stuck or (way is own and steps == most - 1)
            else:
                best, stuck = attempt.design, False
                counts.failed, own = min(counts.failed, steps - 1), self.own_way(best)
        return best

    def own_way(self, best: Design) -> Timing | None:
        """The way of a design with its fastest timing; None if unknown."""
        return fastest_way(self.paths(best, len(best.inputs)), best)

    def fewest(self, way: Timing) -> int:
        """The steps that the fastest timing of a way takes, including the end of the motion."""
        task = self.given.task
        return max(1, ceil(way.duration / float(task.step))) + steps_of_end(task)

    def paths(self, best: Design, steps: int) -> PathSearch:
        """The search of paths for motions of this many steps, with the effector of a design."""
        given = self.lasting(steps)
        return PathSearch(given, round_tasks(given.task, best.effector)[0], best.effector)


@dataclass(slots=True)
class _StepCounts:
    """Which numbers of steps to try: the fewest of a way, then increasing ones, then bisection.

    ``hopeless`` is the largest number not worth trying, ``failed`` the largest for which no motion
    was found.
    """

    hopeless: int
    failed: int = 0
    stride: int = 1

    def following(self, most: int, fewest: int) -> int | None:
        """The number to try, given ``most`` of a motion and ``fewest`` of its way; None to stop."""
        self.hopeless = max(self.hopeless, min(most, int(FEWEST * fewest)))
        self.failed = max(self.failed, self.hopeless)
        if most - self.failed <= 1:
            return None
        if self.failed < fewest < most:
            return fewest
        return self.failed + min(self.stride, (most - self.failed) // 2)

    def fail(self, steps: int) -> None:
        """Record that no motion of this many steps was found."""
        self.failed, self.stride = steps, 2 * self.stride
