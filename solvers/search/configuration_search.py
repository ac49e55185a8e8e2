"""P.Synthesis for one structure and one path: parameters, then polishing, then timing.

A parameter search finds basins: it evaluates parameters by motions whose timing along the path is
free.  Convex programs with the parameters as unknowns then find the minima of the best basins.
Finally the motion is tied to the cells that it visits (``cell_timing.py``).
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Protocol

import numpy as np

from compiler.arrays import Array
from solvers.parameters.bayesian_search import DESIGN, BayesianSearch
from solvers.parameters.nelder_mead import NelderMead
from solvers.parameters.parameter_search import (
    Cube,
    ParameterSearch,
    parameter_space,
)
from solvers.run_context import RunContext
from solvers.search.calm_motion import calmer, chosen_by_spread, outgrows
from solvers.search.cell_timing import Timed, settled
from solvers.search.evaluation import Evaluator, SolveRequest, best_of, free_parameters
from solvers.search.first_motion import first_motion
from solvers.trajectory.control_problem import FULL, SURVEY, ControlOutcome, IterationBudget
from solvers.trajectory.fine_motion import narrowed
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.path_timing import Entries
from solvers.trajectory.task_limits import effort_scale

SEARCHES = ("gp-acb", "nelder-mead")
"""The names of the parameter searches, the default first."""
FURTHER = 5
"""The factor by which evaluations are increased if disturbed motions were not proved."""
BATCH = 2
HARD = 0.5
"""If at most this share of the first motions is feasible, some with a price on rates are tried."""
NEAR = 0.01
"""Units of length by which positions may be off if a motion lacks only its dynamics."""
CALM_LABEL = "|calm"
"""The label of searches with a price on rates in the journal."""
BASINS = 4
"""The number of best evaluations that are polished."""
APART = 0.1
"""Basins differ by this much in some coordinate of the unit cube."""
BENT = 0.35
"""Basins also differ if poses halfway differ by this: sin of half an angle, or metres."""
POLISH = IterationBudget(30, 1e-4, 1e-8, 2)
NARROWINGS = 3
FARTHEST = 10.0
"""rad or m; deviations of disturbed motions are capped at this in comparisons."""


@dataclass(frozen=True, slots=True, eq=False)
class Sample:
    """One evaluation: ``theta`` (p,) in SI units, in the robot's order of parameters.

    ``robustness`` is rho (Definition 7).  If the motion is not ``feasible``, it is negative and
    measures the constraint violation.
    """

    theta: Array
    robustness: float
    feasible: bool


@dataclass(frozen=True, slots=True)
class PathSamples:
    """All samples of one cell path: the ``path``-th (from 0) that was tried for a structure.

    ``structure`` is the number of the structure.  ``names`` are its parameters as ``symbol.name``,
    where the symbol is an index into its word.
    """

    structure: int
    path: int
    names: tuple[str, ...]
    samples: tuple[Sample, ...]


@dataclass(frozen=True, slots=True)
class Configuration:
    """The best outcome for a path, with its entry steps and its cells.

    ``samples`` are all parameters evaluated, in order.  If not ``bound``, the motion keeps only to
    the cells at its ends.  ``calm`` says that rates had a price, ``calmed`` that a motion with such
    a price was searched for, whether or not one was found.
    """

    outcome: ControlOutcome
    entries: Entries
    cells: tuple[int, ...]
    samples: tuple[Sample, ...] = ()
    bound: bool = True
    calm: bool = False
    calmed: bool = False


class MotionListener(Protocol):
    """Receives outcomes as they are evaluated."""

    def see(self, path_problem: PathProblem, outcome: ControlOutcome) -> None:
        """Receive an outcome and the problem that it belongs to."""

    def prove(self, path_problem: PathProblem, outcome: ControlOutcome) -> None:
        """Receive an outcome that is worth proving at once."""


def search_configuration(
    path_problem: PathProblem,
    label: str,
    context: RunContext,
    listener: MotionListener | None = None,
    start: Array | None = None,
) -> Configuration:
    """The best configuration found for a path; it may be infeasible.

    ``label`` names the structure and path in the journal; ``listener`` receives outcomes as they
    are evaluated.  If the only motions found need feedback, and the task does not ask for an open
    loop, a calm motion is preferred and searched for at once.  ``start`` (p,) restricts the
    evaluations to these parameters, in SI units.
    """
    search = _Survey(path_problem, label, context, listener)
    calm, slower = path_problem.rates > 0, None
    may_calm = not calm and start is None
    plain = may_calm and listener is not None and not path_problem.in_joints
    first = first_motion(path_problem, context.seed, context.check_time) if plain else None
    if first is not None and listener is not None:
        # Without parameters the search takes no longer than an early proof.
        (listener.see if search.space.is_point else listener.prove)(path_problem, first)
    if start is not None and not search.space.is_point:
        search.evaluate([start], SURVEY)
    else:
        search.run(until=search.prefers_calm if may_calm else None)
    if may_calm and search.prefers_calm():
        slower = calmed(path_problem, label, context, listener)
        if slower.outcome.feasible:
            return replace(slower, samples=(*search.samples, *slower.samples))
        search.run()
    entries = path_problem.waypoints()[1]
    polished = search.polished(entries)
    every = polished if first is None else [*polished, first]
    ranked = sorted(every, key=lambda outcome: -search.worth(outcome))
    samples = tuple(search.samples)
    with_price = search.calm_samples if slower is None else slower.samples
    if not path_problem.in_joints and not any(each.feasible for each in ranked):
        # A way in joint space may succeed where tracking a line through cells fails.
        other = replace(path_problem, in_joints=True)
        again = search_configuration(other, f"{label}|joints", context, listener, start)
        if again.outcome.robustness > ranked[0].robustness:
            return replace(again, samples=samples + with_price + again.samples)
        samples += again.samples
    if may_calm and slower is None and only_for_feedback(path_problem, polished):
        slower = calmed(path_problem, label, context, listener)
        if slower.outcome.feasible:
            return replace(slower, samples=samples + slower.samples)
        with_price = slower.samples
    top = _best(ranked, path_problem, entries, context)
    return Configuration(
        top.outcome,
        top.entries,
        top.path_problem.cells,
        samples + with_price,
        top.path_problem.bound,
        calm,
        calmed=calm or slower is not None,
    )


def only_for_feedback(path_problem: PathProblem, outcomes: Sequence[ControlOutcome]) -> bool:
    """Whether motions were found, all of them need feedback, and the task allows feedback."""
    found = [each for each in outcomes if each.feasible]
    regulated = [each.regulated or outgrows(path_problem, each.trajectory) for each in found]
    return path_problem.task.control != "open loop" and bool(regulated) and all(regulated)


def calmed(
    path_problem: PathProblem,
    label: str,
    context: RunContext,
    listener: MotionListener | None = None,
) -> Configuration:
    """A configuration for the same path that suits feedback better; it may be infeasible."""
    return search_configuration(calmer(path_problem), f"{label}{CALM_LABEL}", context, listener)


def searched_further(
    path_problem: PathProblem, label: str, context: RunContext
) -> Configuration | None:
    """The best of more parameters than ``calmed`` evaluates, with the samples of these alone.

    None if there are no parameters, or if they are not chosen by the spread of disturbed motions.
    """
    space = parameter_space(path_problem.model)
    closed = path_problem.task.control != "open loop"
    if space.is_point or not closed or not chosen_by_spread(calmer(path_problem)):
        return None
    most = replace(context, evaluations=FURTHER * context.evaluations)
    found = calmed(path_problem, label, most)
    return replace(found, samples=found.samples[context.evaluations :])


def _best(
    ranked: list[ControlOutcome], path_problem: PathProblem, entries: Entries, context: RunContext
) -> Timed:
    """The first of the ranked outcomes that can be settled in its cells."""
    for outcome in ranked:
        if outcome.feasible:
            timed = settled(path_problem, outcome, entries, context)
            if timed is not None:
                return timed
    top = ranked[0]
    return Timed(path_problem, replace(top, feasible=False), entries)


def parameter_search(cube: Cube, seed: int, name: str | None = None) -> ParameterSearch:
    """The parameter search of this name on a cube; None gives the default."""
    if name == "nelder-mead":
        return ParameterSearch(cube, seed, 1, NelderMead(seed))
    return ParameterSearch(cube, seed, DESIGN, BayesianSearch(seed))


class _Survey:
    """The parameters evaluated for a path, with the motions found."""

    def __init__(
        self,
        path_problem: PathProblem,
        label: str,
        context: RunContext,
        listener: MotionListener | None = None,
    ) -> None:
        self.space = parameter_space(path_problem.model)
        self.attempts: list[ControlOutcome] = []
        """The outcomes from all seeds at all parameters."""
        self.valued: list[tuple[float, ControlOutcome]] = []
        """The best outcome at each parameter vector, with its worth."""
        self.samples: list[Sample] = []
        self._path_problem = path_problem
        self._label = label
        self._context = context
        self._listener = listener
        self._evaluator = Evaluator(path_problem, context.workers, context.journal, label)
        self._search = parameter_search(self.space.cube, context.seed, context.search)
        self._harder: bool | None = None
        self.calm_samples: tuple[Sample, ...] = ()
        """Samples with a price on rates, evaluated for comparison."""

    def run(self, until: Callable[[], bool] | None = None) -> None:
        """Evaluate the points that the search proposes, or continue, until ``until`` holds."""
        if self.space.is_point:
            if not self.samples:
                self.evaluate([self.space.lower], FULL)
            return
        while len(self.samples) < self._context.evaluations:
            if self.samples and until is not None and until():
                break
            points = self._search.ask(min(BATCH, self._context.evaluations - len(self.samples)))
            if not points:
                break
            thetas = [self.space.from_cube(point) for point in points]
            for point, outcome in zip(points, self.evaluate(thetas, SURVEY), strict=True):
                self.valued.append((self.worth(outcome), outcome))
                self._search.tell(point, self.valued[-1][0])

    @property
    def share(self) -> float:
        """The share of all attempts that were feasible."""
        return sum(each.feasible for each in self.attempts) / max(len(self.attempts), 1)

    def _lacks_dynamics(self) -> bool:
        """Whether many motions have good positions but few satisfy the equations of motion."""
        near = NEAR * self._path_problem.unit
        placed = [each for each in self.attempts if each.excess <= near]
        feasible = sum(each.feasible for each in placed)
        return len(placed) >= HARD * len(self.attempts) and feasible <= HARD * len(placed)

    def prefers_calm(self) -> bool:
        """Whether all motions need feedback, or are easier to find with a price on rates."""
        return only_for_feedback(self._path_problem, self.attempts) or self._is_harder()

    def _is_harder(self) -> bool:
        """Whether the first parameters give fewer feasible motions than with a price on rates.

        This is determined once, on the first call.
        """
        if self._harder is None:
            self._harder = False
            if self._lacks_dynamics() and not self.space.is_point:
                label = f"{self._label}{CALM_LABEL}"
                calm = _Survey(calmer(self._path_problem), label, self._context)
                calm.run(until=lambda: True)
                self.calm_samples = tuple(calm.samples)
                self._harder = calm.share > self.share
        return self._harder

    def evaluate(self, thetas: list[Array], budget: IterationBudget) -> list[ControlOutcome]:
        """The best outcome at each parameter vector."""
        found = []
        attempts = self._evaluator.attempts(thetas, budget)
        for theta, outcomes in zip(thetas, attempts, strict=True):
            self._context.check_time()
            outcome = best_of(outcomes)
            found.append(outcome)
            self.attempts += outcomes
            self.samples.append(Sample(theta, outcome.robustness, outcome.feasible))
            self._context.reporter.robustness(max(o.robustness for o in self.attempts))
            if self._listener is not None:
                self._listener.prove(self._path_problem, outcome)
        return found

    def worth(self, outcome: ControlOutcome) -> float:
        """The robustness of an outcome, reduced by how far disturbed motions deviate from it."""
        path_problem = self._path_problem
        if not outcome.feasible or not chosen_by_spread(path_problem):
            return outcome.robustness
        closed = replace(path_problem, feedback=True).spreading(outcome.trajectory, 1.0)
        far = FARTHEST if closed.spread is None else min(FARTHEST, closed.spread.size)
        return outcome.robustness - far * effort_scale(path_problem.groups)

    def polished(self, entries: Entries) -> list[ControlOutcome]:
        """The best outcomes after convex programs with the parameters as unknowns."""
        if self.space.is_point:
            return self.attempts
        chosen, path_problem = self.basins(), self._path_problem
        requests = [
            SolveRequest(
                start.trajectory, entries, free_parameters(path_problem, start.trajectory), POLISH,
                released=True,
            )
            for start in chosen
        ]  # fmt: skip
        found = []
        for before, after in zip(chosen, self._evaluator.solutions(requests), strict=True):
            self._context.check_time()
            found.append(max(before, after, key=lambda item: item.robustness))
            self._context.reporter.robustness(max(o.robustness for o in found))
        return found

    def basins(self) -> list[ControlOutcome]:
        """The best outcomes that differ from each other in parameters or in motion."""
        if chosen_by_spread(self._path_problem):
            ranked = [outcome for _, outcome in sorted(self.valued, key=lambda pair: -pair[0])]
        else:
            ranked = sorted(self.attempts, key=lambda attempt: -attempt.robustness)
        chosen = ranked[:1]
        for differs in (_moves_apart, self._lies_apart):
            for attempt in ranked:
                if len(chosen) >= BASINS:
                    break
                if all(differs(attempt, other) for other in chosen):
                    chosen.append(attempt)
        return chosen

    def _lies_apart(self, one: ControlOutcome, other: ControlOutcome) -> bool:
        """Whether two attempts differ in their parameters."""
        first, second = (self.space.to_cube(each.trajectory.theta) for each in (one, other))
        return bool(np.max(np.abs(first - second), initial=0.0) > APART)


def _moves_apart(one: ControlOutcome, other: ControlOutcome) -> bool:
    """Whether the robot's poses halfway through two attempts differ by about a quarter turn."""
    half = len(one.trajectory.x) // 2
    n = len(one.trajectory.x[0]) // 2
    first, second = (attempt.trajectory.x[half, :n] for attempt in (one, other))
    return bool(np.max(np.abs(np.sin((first - second) / 2)), initial=0.0) > BENT)


def within_limits(
    path_problem: PathProblem, found: Configuration, budget: IterationBudget = FULL
) -> tuple[PathProblem, Configuration]:
    """A configuration whose motion also satisfies joint and rate limits between samples.

    Limits that it violates there are narrowed and the motion is solved again, a few times.
    """
    for _ in range(NARROWINGS):
        closer = (
            narrowed(path_problem, found.outcome.trajectory) if found.outcome.feasible else None
        )
        if closer is None:
            break
        path_problem = closer
        found = resolved(path_problem, found, budget)
    return path_problem, found


def resolved(
    path_problem: PathProblem, found: Configuration, budget: IterationBudget = FULL
) -> Configuration:
    """The configuration solved again under other margins; parameters may change too."""
    trajectory = found.outcome.trajectory
    box = free_parameters(path_problem, trajectory)
    return replace(found, outcome=path_problem.solve(trajectory, found.entries, box, budget))
