"""Parameters with less of an objective, found from those of a proved design.

Convex programs with the parameters as unknowns minimise the objective together with the motion; so
far, they find a local minimum.  If there would be less without obstacles, other ways around them
are tried, with parameters between those two.  Discrete parameters are bisected between the design
and the end of their range at which the objective is least.  Where parameters are no unknowns of the
programs, or no other way has less, parameters are moved towards these ends: all together, then one
by one.  The result need not be the minimum.
"""

from __future__ import annotations

from collections.abc import Generator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array
from compiler.expressions.exact_numbers import shortest_decimal
from compiler.objectives.least_values import Amount, mass_bounds
from compiler.objectives.objective_text import value_text
from compiler.robots.robot import RobotModel
from solvers.parameters.parameter_search import parameter_space
from solvers.search.design_values import design_values
from solvers.search.evaluation import free_parameters, hopeful
from solvers.search.path_search import PathSearch
from solvers.search.path_task import Design
from solvers.search.search_state import PathAttempt
from solvers.search.shorter_motion import LESS, attempt_along, problem_along
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.path_relaxation import PathRelaxation
from solvers.trajectory.trajectory import Trajectory

WORTH = 30.0
"""The price of an objective: a hundredth of it costs this many hundredths of the widest margin."""
TIE = 0.1
"""The price of the next objective relative to that: of equal robots the one with less of it."""
GAIN = 1e-3
"""The least relative gain for which the search for less goes on."""
BENT = 0.01
"""The programs are solved again if slopes of the objective have changed by more than this share."""
CLOSE = 0.01
"""So near to what is possible without obstacles, no other ways are sought."""
BETWEEN = (0.1, 0.5)
"""Where other ways are sought: between the parameters without obstacles and those of a design."""
TOGETHER = (0.5, 0.75, 0.9, 0.97)
"""The remaining fractions of the distance to the least end; each follows a failure."""
ALONE = (0.5, 0.9)
"""The fractions for a single parameter."""
ROUNDS = 6
"""The number of times that each of these is repeated."""
SAME = 1e-3
"""Parameters this close to their end, relative to their range, are left unchanged."""

Indices: TypeAlias = NDArray[np.int64]
Improved: TypeAlias = Generator[PathAttempt, None, Design]
"""Yields attempts and returns the best design."""


def least_ends(amount: Amount, model: RobotModel, theta: Array) -> Array:
    """The ends (p,) of the ranges at which an objective is least; NaN if it does not depend.

    ``theta`` (p,) are the parameters around which this is determined.
    """
    space = parameter_space(model)
    ends = np.full(len(theta), np.nan)
    for index, (low, high) in enumerate(zip(space.lower, space.upper, strict=True)):
        rise = _rise(amount, model, theta, index, (low, high))
        if rise:
            ends[index] = low if rise > 0 else high
    return ends


def slopes(amount: Amount, model: RobotModel, theta: Array) -> Array:
    """The derivatives (p,) of an objective by the parameters, at ``theta`` (p,), in SI units."""
    space, found = parameter_space(model), np.zeros(len(theta))
    steps = SAME * (space.upper - space.lower)
    lower, upper = np.maximum(theta - steps, space.lower), np.minimum(theta + steps, space.upper)
    for index in np.flatnonzero(upper > lower).tolist():
        ends = lower[index], upper[index]
        found[index] = _rise(amount, model, theta, index, ends) / (ends[1] - ends[0])
    return np.nan_to_num(found, posinf=0.0, neginf=0.0)


def _rise(
    amount: Amount, model: RobotModel, theta: Array, index: int, ends: tuple[float, float]
) -> float:
    """By how much an objective rises from one value of a parameter to another; NaN if unknown."""
    parameter, objective = model.parameters[index], amount.objective
    if objective.kind == "sum":
        varied = (parameter.module, None) in objective.amounts
        return ends[1] - ends[0] if varied and parameter.name == objective.attribute else 0.0
    if objective.kind != "mass":
        return 0.0
    low, high = (_mass(model, theta, index, value) for value in ends)
    return high - low


def _mass(model: RobotModel, theta: Array, index: int, value: float) -> float:
    """The mass (kg) with one parameter set to another value."""
    changed = theta.copy()
    changed[index] = value
    bounds = mass_bounds(model, [shortest_decimal(each) for each in changed])
    return np.nan if bounds is None else float(bounds[1])


def kept_box(model: RobotModel, theta: Array, ends: Array) -> tuple[Array, Array]:
    """Bounds (p,) for parameters that may not be farther from these ends than ``theta``."""
    space = parameter_space(model)
    fixed = np.array([values is not None for values in space.choices], dtype=bool)
    low, high = (np.where(fixed, theta, side) for side in (space.lower, space.upper))
    known = ~np.isnan(ends)
    high = np.where(known & (ends <= theta), np.minimum(high, theta), high)
    low = np.where(known & (ends > theta), np.maximum(low, theta), low)
    return low, high


@dataclass(frozen=True, slots=True)
class LessenedParameters:
    """The search for less of the first of some objectives, and of the next one where this is equal.

    ``held`` are the ends of objectives before these.
    """

    paths: PathSearch
    amounts: Sequence[Amount]
    held: Array

    @property
    def model(self) -> RobotModel:
        """The robot."""
        return self.paths.structure.numeric.graph.model

    @property
    def amount(self) -> Amount:
        """The objective."""
        return self.amounts[0]

    def attempts(self, best: Design) -> Improved:
        """Attempts at designs with less and less of the objective."""
        theta, space = _motion(best).theta, parameter_space(self.model)
        ends = least_ends(self.amount, self.model, theta)
        free = np.flatnonzero(np.abs(theta - ends) > SAME * (space.upper - space.lower))
        if not len(free):
            return best
        best = yield from self._descended(best)
        for index in free.tolist():
            best = yield from self._bisected(best, ends, index)
        best, is_near = yield from self._around(best)
        return best if is_near else (yield from self._nearer(best, ends, free))

    # --- the objective in the convex programs ---------------------------------------------------

    def _value(self, design: Design) -> float:
        """The value of a design, in SI units."""
        return float(design_values(design, (self.amount,), self.paths.structure.task)[0])

    def _prices(self, best: Design) -> tuple[float, ...]:
        """The prices (p,) of the parameters near a design; empty if there is nothing to gain."""
        theta, value = _motion(best).theta, self._value(best)
        found = slopes(self.amount, self.model, theta)
        steepest = float(np.max(np.abs(found), initial=0.0))
        if not steepest or not value:
            return ()
        for number, amount in enumerate(self.amounts[1:], start=1):
            other = slopes(amount, self.model, theta)
            most = float(np.max(np.abs(other), initial=0.0))
            found = found + (TIE**number * steepest / most * other if most else 0.0)
        return tuple(float(each) for each in WORTH / abs(value) * found)

    def _attempt(
        self, best: Design, starts: Sequence[Trajectory], box: tuple[Array, Array], name: str
    ) -> PathAttempt:
        """The attempt at less than a design from some starts, with parameters in a box (p,)."""
        self.paths.structure.context.check_time()
        name = f"less {self.amount.text} {name}"
        return attempt_along(self.paths, best, starts, box, name, self._prices(best))

    def _better(self, attempt: PathAttempt, than: Design) -> Design | None:
        """The design of an attempt, if it has less than another one."""
        found = attempt.design
        if found is None or self._value(found) >= (1 - GAIN) * self._value(than):
            return None
        value = value_text(self.amount.objective, Fraction(f"{self._value(found):.4g}"))
        self.paths.structure.context.reporter.note(f"best {self.amount.text}: {value}")
        return found

    def _descended(self, best: Design) -> Improved:
        """Attempts at the nearest local minimum."""
        for number in range(ROUNDS):
            motion = _motion(best)
            if self._programmed(best) is None:
                break
            box = kept_box(self.model, motion.theta, self.held)
            attempt = self._attempt(best, [motion], box, f"near {number}")
            yield attempt
            found = self._better(attempt, best)
            if found is None:
                break
            before, after = (
                slopes(self.amount, self.model, _motion(each).theta) for each in (best, found)
            )
            best = found
            if np.allclose(before, after, rtol=BENT, atol=BENT * float(np.max(np.abs(before)))):
                break
        return best

    def _bisected(self, best: Design, ends: Array, index: int) -> Improved:
        """Attempts with values of a discrete parameter nearer its end, that end first."""
        values, motion = parameter_space(self.model).choices[index], _motion(best)
        if values is None:
            return best
        away = np.abs(values - ends[index])
        nearer = values[np.argsort(away, kind="stable")]
        nearer = nearer[: np.count_nonzero(away < abs(motion.theta[index] - ends[index]))]
        failed, known, place = -1, len(nearer), 0
        while known - failed > 1:
            theta = _motion(best).theta.copy()
            theta[index] = nearer[place]
            box, start = kept_box(self.model, theta, self.held), replace(_motion(best), theta=theta)
            attempt = self._attempt(best, [start], box, f"{index} {place}")
            yield attempt
            found = self._better(attempt, best)
            if found is None:
                failed = place
            else:
                best, known = found, place
            place = (failed + known) // 2
        return best

    # --- other ways around obstacles ------------------------------------------------------------

    def _programmed(self, best: Design) -> PathProblem | None:
        """The problem along a design, with prices on parameters; None if it has none to choose."""
        found = problem_along(self.paths, best.abstraction, best, len(best.inputs))
        motion, prices = _motion(best), self._prices(best)
        box = None if found is None else free_parameters(found, motion)
        if found is None or box is None or not prices or np.array_equal(*box):
            return None
        box = kept_box(self.model, motion.theta, self.held)
        return replace(found, box=box, prices=prices)

    def _around(self, best: Design) -> Generator[PathAttempt, None, tuple[Design, bool]]:
        """Attempts along other ways; whether the best is near the least without obstacles."""
        for number in range(ROUNDS):
            path_problem, motion = self._programmed(best), _motion(best)
            if path_problem is None:
                return best, False
            entries = path_problem.waypoints()[1]
            box = free_parameters(path_problem, motion)
            free = PathRelaxation(path_problem, {}, apart=False).outcome(motion, entries, box, LESS)
            saved = np.dot(path_problem.prices, motion.theta - free.trajectory.theta)
            if not free.feasible or saved < CLOSE * WORTH:
                return best, free.feasible
            found = None
            for part in BETWEEN:
                theta = free.trajectory.theta + part * (motion.theta - free.trajectory.theta)
                starts = self._ways(path_problem, theta)
                if not starts or path_problem.box is None:
                    continue
                attempt = self._attempt(best, starts, path_problem.box, f"around {number} {part}")
                yield attempt
                found = self._better(attempt, best)
                if found is not None:
                    break
            if found is None:
                return best, False
            best = found
        return best, False

    def _ways(self, path_problem: PathProblem, theta: Array) -> list[Trajectory]:
        """Ways around obstacles with parameters (p,)."""
        self.paths.structure.context.check_time()
        problem = path_problem.problem(path_problem.waypoints()[1], released=True)
        return hopeful(problem, replace(path_problem, in_joints=True).seeds(theta))

    # --- parameters nearer their ends -----------------------------------------------------------

    def _nearer(self, best: Design, ends: Array, free: Indices) -> Improved:
        """Attempts with parameters nearer their ends: all together, then one by one."""
        for _ in range(ROUNDS):
            better = yield from self._drawn(best, ends, free, TOGETHER)
            if better is best:
                break
            best = better
        for index in free if len(free) > 1 else ():
            best = yield from self._drawn(best, ends, np.array([index]), ALONE)
        return best

    def _drawn(
        self, best: Design, ends: Array, chosen: Indices, parts: tuple[float, ...]
    ) -> Improved:
        """Attempts with some parameters nearer their ends, until one is proved."""
        motion, space = _motion(best), parameter_space(self.model)
        kept = np.where(np.isnan(self.held), ends, self.held)
        span = np.maximum(space.upper - space.lower, 1e-12)
        away = np.abs(motion.theta - ends)[chosen] / span[chosen]
        if not np.max(away, initial=0.0) > SAME:
            return best
        for number, part in enumerate(parts):
            theta = motion.theta.copy()
            theta[chosen] = ends[chosen] + part * (theta[chosen] - ends[chosen])
            theta = self._allowed(theta, motion.theta)
            if np.allclose(theta, motion.theta, rtol=0, atol=SAME * float(span.min())):
                continue
            box = kept_box(self.model, theta, kept)
            attempt = self._attempt(best, [replace(motion, theta=theta)], box, str(number))
            yield attempt
            found = self._better(attempt, best)
            if found is not None:
                return found
        return best

    def _allowed(self, theta: Array, before: Array) -> Array:
        """Round discrete parameters to the next value at or past ``theta``, from ``before``."""
        space, found = parameter_space(self.model), theta.copy()
        for index, values in enumerate(space.choices):
            if values is not None:
                down = theta[index] <= before[index]
                allowed = values[values <= theta[index]] if down else values[values >= theta[index]]
                nearest = allowed if len(allowed) else values
                found[index] = nearest.max() if down else nearest.min()
        return found


def _motion(design: Design) -> Trajectory:
    """The motion of a design."""
    return design.configuration.outcome.trajectory
