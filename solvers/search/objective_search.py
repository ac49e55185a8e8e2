"""The search of a structure in a task with objectives, or with a horizon that is a bound.

A motion is looked for that takes all of the horizon, then, where that is a bound, parts of it.  A
proved design is then improved, one objective after another: the way of its motion is gone along as
fast as its drives allow, its parameters are lessened, its efforts made smaller.  Of a number of
steps for which no motion was found nothing is concluded: a shorter one may exist, as well as a
longer one.
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
"""The fewest steps that are tried, relative to what the fastest timing of a known way takes."""
CALM = 0.0, 1.0, 10.0
"""Prices on rates of motions that may take less energy, relative to that of calm ones."""
LENGTHS = 10
"""After so many numbers of steps for which there were paths, but no motion, none are tried."""
ATTEMPTS = 12
"""So many numbers of steps are tried for a shorter motion of a structure."""


@dataclass(frozen=True, slots=True)
class ObjectiveSearch:
    """The search of a structure in a workspace that is divided into ``cells``."""

    given: StructureTask
    cells: Abstraction

    def states(self, effectors: Sequence[int]) -> Iterator[StructureState]:
        """What is known after each attempt; the last one says why no more are made.

        ``effectors`` (from 0) are those that may start and reach, the most hopeful first.
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
        """Attempts at designs with less of what is to be least, one objective after another."""
        held, longest = np.full(len(best.model.parameters), np.nan), len(best.inputs)
        for amount in amounts(self.given.program, self.given.task):
            kind = amount.objective.kind
            if kind == "time" and self.given.task.at_most:
                best = yield from self.shorter(best, held)
                longest = int(len(best.inputs) * (1 + amount.objective.within))
            elif kind in ("mass", "sum"):
                paths = self.paths(best, len(best.inputs))
                best = yield from LessenedParameters(paths, amount, held).attempts(best)
                theta = best.configuration.outcome.trajectory.theta
                ends = least_ends(amount, best.model, theta)
                held = np.where(np.isnan(held), ends, held)
            elif kind in ("energy", "effort"):
                yield from self.gentler(best, held, longest, CALM if kind == "energy" else (0.0,))

    def gentler(
        self, best: Design, held: Array, longest: int, prices: Sequence[float]
    ) -> Iterator[PathAttempt]:
        """Attempts at motions of as many steps as are left, with some prices on rates.

        Parameters get no farther from the ends of their ranges that are ``held``, (p,).
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
        """Bounds (p,) of parameters that get no farther from the ends that are ``held``."""
        if np.isnan(held).all():
            return None
        return kept_box(best.model, best.configuration.outcome.trajectory.theta, held)

    def lasting(self, steps: int) -> StructureTask:
        """The structure in the task of motions of so many steps."""
        if not self.given.task.at_most:
            return self.given
        task, name = self.given.task.lasting(steps), f"{self.given.number}@{steps}"
        return replace(self.given, task=task, name=name)

    def shorter(self, best: Design, held: Array) -> Improved:
        """Attempts at motions of ever fewer steps, along the fastest way that is known.

        That is the way of the best design so far, or another one between poses of the task.

        Parameters get no farther from the ends of their ranges that are ``held``, (p,).
        """
        counts, own = _StepCounts(self.given.task.fewest_steps - 1), self.own_way(best)
        other = faster_way(self.paths(best, len(best.inputs)), best, own)
        stuck = False
        for _ in range(ATTEMPTS):
            most = len(best.inputs)
            way = own if other is None or (own and own.duration <= other.duration) else other
            steps = counts.following(most, most if way is None else self.fewest(way))
            if steps is None and not stuck and most - 1 > counts.hopeless:
                # What one way did not lead to, that of the newest design may.
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
        """The way of a design with its fastest timing; None: unknown."""
        return fastest_way(self.paths(best, len(best.inputs)), best)

    def fewest(self, way: Timing) -> int:
        """The steps that the fastest timing of a way takes, with those of the end of a motion."""
        task = self.given.task
        return max(1, ceil(way.duration / float(task.step))) + steps_of_end(task)

    def paths(self, best: Design, steps: int) -> PathSearch:
        """The search of paths of motions of so many steps, which the effector of a design ends."""
        given = self.lasting(steps)
        return PathSearch(given, round_tasks(given.task, best.effector)[0], best.effector)


@dataclass(slots=True)
class _StepCounts:
    """Which numbers of steps to try: the fewest of a way, then a few more each time, then between.

    ``hopeless`` is the largest number that is not worth a try, ``failed`` the largest for which no
    motion was found.
    """

    hopeless: int
    failed: int = 0
    stride: int = 1

    def following(self, most: int, fewest: int) -> int | None:
        """What to try where a motion has ``most`` and its way takes ``fewest``; None: nothing."""
        self.hopeless = max(self.hopeless, min(most, int(FEWEST * fewest)))
        self.failed = max(self.failed, self.hopeless)
        if most - self.failed <= 1:
            return None
        if self.failed < fewest < most:
            return fewest
        return self.failed + min(self.stride, (most - self.failed) // 2)

    def fail(self, steps: int) -> None:
        """No motion of so many steps was found."""
        self.failed, self.stride = steps, 2 * self.stride
