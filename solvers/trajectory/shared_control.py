"""Motions of several robots with common parameters: maximise the least of their robustness.

One robot does several tasks, or robots are rebuilt between tasks and kept modules keep their
values.  Linearise all motions, solve one program for all of them (``shared_step.py``), evaluate
each on its own robot, repeat.  Every motion has its own trust region, price of moves and fictitious
inputs, by the rules of ``control.py``.  A step is accepted for all of them or for none.  At the end
each motion is solved separately, with the shared parameters fixed.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field, replace
from functools import partial

import numpy as np

from compiler.arrays import Array
from solvers.backends.conic import NotSolved
from solvers.trajectory.control import (
    COARSE,
    FREE_STEPS,
    PROXIMAL,
    SMALLEST_RADIUS,
    Iteration,
    as_it_is,
    begun,
)
from solvers.trajectory.control_problem import (
    FULL,
    ControlOutcome,
    ControlProblem,
    IterationBudget,
    MeasuredMotion,
    measured,
)
from solvers.trajectory.convex_step import ConvexStep
from solvers.trajectory.given_parameters import with_given
from solvers.trajectory.shared_step import Link, SharedStep
from solvers.trajectory.subproblem import StepResult, TrustRegion
from solvers.trajectory.trajectory import Trajectory

RADIUS = 0.5
"""The radius of the first trust region, which is also the largest one."""
NEAR_RADIUS, NEAR_PROXIMAL = 0.1, 1e-2
"""The first trust region of careful iterations, about motions that are already feasible."""
GROWTH = 1.5
"""The growth factor of trust regions after steps with small defects."""
ROUNDS = 8
"""The most rounds in which all motions are solved together and then separately."""
WORTHWHILE = 1e-3
"""The least gain of the share by which a round counts as progress."""
Box = tuple[Array, Array]
"""Lower and upper bounds (p,) of parameters, in SI units."""


@dataclass(frozen=True, slots=True)
class SharedTask:
    """A control problem, the start of its motion, and bounds on its parameters."""

    problem: ControlProblem
    start: Trajectory
    box: Box


@dataclass(frozen=True, slots=True)
class SharedOutcome:
    """An outcome for every problem; linked parameters are equal bit by bit.

    ``shares`` are robustness relative to its maximum, or minus the violation.  A share is 1 if all
    inputs have only one admissible value, so that no margin to their bounds is possible.
    """

    outcomes: tuple[ControlOutcome, ...]
    shares: tuple[float, ...]

    @property
    def trajectories(self) -> tuple[Trajectory, ...]:
        """The motions."""
        return tuple(each.trajectory for each in self.outcomes)

    @property
    def robustness(self) -> tuple[float, ...]:
        """Rho of each motion, or minus its violation, in units of its own effort."""
        return tuple(each.robustness for each in self.outcomes)

    @property
    def feasible(self) -> bool:
        """Whether all motions are feasible."""
        return all(each.feasible for each in self.outcomes)

    @property
    def share(self) -> float:
        """The least of the shares, which is maximised."""
        return min(self.shares)


def share_of(problem: ControlProblem, outcome: ControlOutcome) -> float:
    """The share of an outcome, as in ``SharedOutcome.shares``."""
    if outcome.feasible and not _chooses(problem):
        return 1.0
    return outcome.robustness / problem.scale


def _chooses(problem: ControlProblem) -> bool:
    """Whether some input has more than one admissible value."""
    return any(group.widest_margin > 0 for group in problem.groups)


def shared_control(
    tasks: Sequence[SharedTask],
    links: Iterable[Iterable[tuple[int, int]]],
    budget: IterationBudget = FULL,
) -> SharedOutcome | None:
    """Motions with linked parameters equal whose least share of robustness is locally maximal.

    A link lists parameters, each by the index of its problem and its own index there.  If the
    starts differ in linked parameters, their mean is the start.  Problems that share nothing are
    solved separately.  None if linked parameters have no common value.

    Raises:
        ValueError: if a link names a parameter that does not exist.
    """
    joined = merged(links)
    common = in_common(tasks, joined)
    if common is None:
        return None
    outcomes = dict[int, ControlOutcome]()
    with np.errstate(all="ignore"):  # trial motions may diverge; that counts as infeasible
        for group in _components(len(tasks), joined):
            known = {task: place for place, task in enumerate(group)}
            own = [tuple((known[k], i) for k, i in link) for link in joined if link[0][0] in known]
            found = _solved([common[task] for task in group], tuple(own), budget)
            outcomes |= zip(group, found, strict=True)
    every = [outcomes[task] for task in range(len(tasks))]
    shares = [share_of(task.problem, each) for task, each in zip(tasks, every, strict=True)]
    return SharedOutcome(tuple(every), tuple(shares))


# --- links --------------------------------------------------------------------------------------


def merged(links: Iterable[Iterable[tuple[int, int]]]) -> tuple[Link, ...]:
    """Equivalent links without common parameters, in order; links of one parameter are dropped."""
    groups = list[set[tuple[int, int]]]()
    for link in links:
        new = set(link)
        apart = [group for group in groups if not group & new]
        groups = [*apart, new.union(*(group for group in groups if group & new))]
    return tuple(sorted(tuple(sorted(group)) for group in groups if len(group) > 1))


def _components(count: int, links: Sequence[Link]) -> list[list[int]]:
    """Groups of problems that share parameters, directly or indirectly, in order."""
    found = [{task} for task in range(count)]
    for link in links:
        tasks = {task for task, _ in link}
        apart = [group for group in found if not group & tasks]
        found = [*apart, tasks.union(*(group for group in found if group & tasks))]
    return sorted(sorted(group) for group in found)


def in_common(tasks: Sequence[SharedTask], links: Sequence[Link]) -> list[SharedTask] | None:
    """The tasks with linked parameters equal and their bounds intersected; None if impossible.

    Raises:
        ValueError: if a link names a parameter that does not exist.
    """
    thetas = [task.start.theta.copy() for task in tasks]
    lower, upper = ([task.box[end].astype(float) for task in tasks] for end in (0, 1))
    for link in links:
        if any(not (0 <= k < len(tasks) and 0 <= i < len(thetas[k])) for k, i in link):
            raise ValueError(f"a link without such a parameter: {link}")
        low, high = max(lower[k][i] for k, i in link), min(upper[k][i] for k, i in link)
        if low > high:
            return None
        values = [thetas[k][i] for k, i in link]
        value = values[0] if min(values) == max(values) else float(np.mean(values))
        for k, i in link:
            lower[k][i], upper[k][i] = low, high
            thetas[k][i] = min(max(value, low), high)
    return [
        SharedTask(task.problem, replace(task.start, theta=theta), (low, high))
        for task, theta, low, high in zip(tasks, thetas, lower, upper, strict=True)
    ]


# --- the iteration --------------------------------------------------------------------------------


@dataclass(slots=True)
class _SharedIteration:
    """Control syntheses that are iterated together."""

    members: list[Iteration]
    step: SharedStep
    budget: IterationBudget
    careful: bool
    """Whether no step may cause large defects, not even the first ones."""
    used: int = 0
    calm: list[Trajectory] = field(default_factory=list[Trajectory])
    """The motions with the greatest least share whose defects were small, if any are known."""
    _best: float = -np.inf

    def run(self) -> None:
        """Iterate until no motion gains anything, or the iterations are used up."""
        while self.used < self.budget.iterations and self.advance():
            pass

    def advance(self) -> bool:
        """Take one convex step for all; return whether to continue."""
        members = self.members
        self.used += 1
        for each in members:
            each.used = self.used + (FREE_STEPS if self.careful else 0)
        results = self.step.solve(
            [each.current for each in members], [each.region for each in members],
            max(COARSE, self.budget.accuracy), [each.fictitious for each in members],
        )  # fmt: skip
        if isinstance(results, NotSolved):
            self._relent(results)
            return self._hopeful
        trials = list[MeasuredMotion]()
        for each, result in zip(members, results, strict=True):
            trial = measured(each.problem, result.trajectory)
            if trial is None or each.strayed(trial, result):
                each.hold()
            else:
                trials.append(trial)
        if len(trials) < len(members):
            return self._hopeful
        share = self._share(results)
        due = [
            each.follow(trial, replace(result, margin=share * each.problem.scale))
            for each, trial, result in zip(members, trials, results, strict=True)
        ]
        caused = [m.infeasibility(each.problem) for m, each in zip(trials, members, strict=True)]
        if max(caused) <= self.budget.calm and share > self._best:
            self.calm, self._best = [each.trajectory for each in trials], share
        for each, defect in zip(members, caused, strict=True):
            if defect <= each.level:
                # Motions that were held back because of others may move farther again.
                radius = min(RADIUS, GROWTH * each.region.radius)
                each.region = TrustRegion(radius, each.region.proximal)
        return any(due)

    @property
    def _hopeful(self) -> bool:
        return all(each.region.radius >= SMALLEST_RADIUS for each in self.members)

    def _share(self, results: Sequence[StepResult]) -> float:
        """The least share of the margins, which is the gain of a step for every motion.

        Motions whose inputs have only one admissible value have no margin and do not count.
        """
        shares = [
            result.margin / each.problem.scale
            for each, result in zip(self.members, results, strict=True)
            if _chooses(each.problem)
        ]
        return min(shares, default=0.0)

    def _relent(self, failure: NotSolved) -> None:
        """Offer fictitious inputs to members without them; if all have them, shorten the steps."""
        lacking = [each for each in self.members if not each.fictitious]
        for each in lacking or self.members:
            each.relent(failure)


def _solved(
    tasks: Sequence[SharedTask], links: tuple[Link, ...], budget: IterationBudget
) -> list[ControlOutcome]:
    """The outcomes of tasks that share parameters, or of a single task that shares none."""
    if len(tasks) == 1 and not links:
        (task,) = tasks
        return [with_given(task.problem, task.start, task.box, frozenset(), budget)]
    best = _known(tasks)
    if best is None:
        # Feasible motions for these parameters are better starts than seeds.
        tasks = [
            _moving(task, own, budget)
            for task, own in zip(tasks, _given(tasks, links), strict=True)
        ]
        best = _known(tasks)
    careful = best is not None
    for _ in range(ROUNDS):
        found = _round(tasks, links, budget, careful=careful)
        gained = np.inf if best is None else _least(tasks, found) - _least(tasks, best)
        if gained > 0:
            best = found
            tasks = [
                replace(task, start=each.trajectory)
                for task, each in zip(tasks, found, strict=True)
            ]
        if gained > WORTHWHILE:
            careful = True
        elif careful:
            # If no short step improves the motions, long ones may reach better ones.
            careful = False
        else:
            break
    return [] if best is None else best


def _known(tasks: Sequence[SharedTask]) -> list[ControlOutcome] | None:
    """The outcomes of the starts as they are; None unless all are feasible motions."""
    before = [as_it_is(task.problem, task.start) for task in tasks]
    found = [each for each in before if each is not None and each.feasible]
    return found if len(found) == len(tasks) else None


def _given(tasks: Sequence[SharedTask], links: Sequence[Link]) -> list[frozenset[int]]:
    """The parameters that each task shares, by index."""
    return [
        frozenset(i for link in links for k, i in link if k == own) for own in range(len(tasks))
    ]


def _moving(task: SharedTask, given: frozenset[int], budget: IterationBudget) -> SharedTask:
    """The task starting from a feasible motion with the given parameters, if one is found."""
    found = as_it_is(task.problem, task.start)
    if found is None or not found.feasible:
        found = with_given(task.problem, task.start, task.box, given, budget)
    return replace(task, start=found.trajectory) if found.feasible else task


def _least(tasks: Sequence[SharedTask], outcomes: Sequence[ControlOutcome]) -> float:
    pairs = zip(tasks, outcomes, strict=True)
    return min(share_of(task.problem, each) for task, each in pairs)


def _round(
    tasks: Sequence[SharedTask], links: tuple[Link, ...], budget: IterationBudget, *, careful: bool
) -> list[ControlOutcome]:
    """Solve all motions together, then each separately with the resulting shared parameters."""
    region = TrustRegion(NEAR_RADIUS, NEAR_PROXIMAL) if careful else TrustRegion(RADIUS, PROXIMAL)
    members = list[Iteration]()
    for task in tasks:
        member = begun(replace(task.problem, steps=ConvexStep), task.start, task.box, budget)
        if member is not None:
            member.region = region
            members.append(member)
    if len(members) < len(tasks):
        return _ended(tasks, [task.start for task in tasks], links, budget)
    steps = tuple(each.step for each in members if isinstance(each.step, ConvexStep))
    iteration = _SharedIteration(members, SharedStep(steps, links), budget, careful)
    iteration.run()
    found = _ended(tasks, [each.current.trajectory for each in members], links, budget)
    if iteration.calm and not all(each.feasible for each in found):
        # The defects of the last steps were too large to be closed.
        return max(found, _ended(tasks, iteration.calm, links, budget), key=partial(_least, tasks))
    return found


def _ended(
    tasks: Sequence[SharedTask],
    motions: Sequence[Trajectory],
    links: tuple[Link, ...],
    budget: IterationBudget,
) -> list[ControlOutcome]:
    """The outcome of each task from its motion, with its shared parameters fixed."""
    return [
        with_given(
            task.problem, replace(motion, theta=np.clip(motion.theta, *task.box)), task.box, own,
            budget,
        )  # solvers respect bounds only approximately
        for task, motion, own in zip(tasks, motions, _given(tasks, links), strict=True)
    ]  # fmt: skip
