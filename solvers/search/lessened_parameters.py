"""Parameters with less of an objective, found from those of a proved design.

Parameters are moved towards the ends of their ranges at which the objective is least: first all
together, then one by one.  Between that end and a fraction of the way back to the design they are
unknowns of the convex programs.  The result need not be the minimum.
"""

from __future__ import annotations

from collections.abc import Generator
from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array
from compiler.expressions.exact_numbers import shortest_decimal
from compiler.objectives.least_values import Amount, mass_bounds
from compiler.robots.robot import RobotModel
from solvers.parameters.parameter_search import parameter_space
from solvers.search.path_search import PathSearch
from solvers.search.path_task import Design
from solvers.search.search_state import PathAttempt
from solvers.search.shorter_motion import attempt_along
from solvers.trajectory.trajectory import Trajectory

TOGETHER = (0.5, 0.75, 0.9, 0.97)
"""The remaining fractions of the distance to the least end; each follows a failure."""
ALONE = (0.5, 0.9)
"""The fractions for a single parameter."""
ROUNDS = 6
"""The number of times that parameters are moved together."""
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
    for index, parameter in enumerate(model.parameters):
        low, high = space.lower[index], space.upper[index]
        if amount.objective.kind == "sum":
            varied = (parameter.module, None) in amount.objective.amounts
            if varied and parameter.name == amount.objective.attribute:
                ends[index] = low
        elif amount.objective.kind == "mass":
            masses = [_mass(model, theta, index, value) for value in (low, high)]
            if masses[0] != masses[1]:
                ends[index] = low if masses[0] < masses[1] else high
    return ends


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
    """The search for less of an objective; ``held`` are the ends of earlier objectives."""

    paths: PathSearch
    amount: Amount
    held: Array

    @property
    def model(self) -> RobotModel:
        """The robot."""
        return self.paths.structure.numeric.graph.model

    def attempts(self, best: Design) -> Improved:
        """Attempts at designs with less and less of the objective."""
        theta = best.configuration.outcome.trajectory.theta
        ends = least_ends(self.amount, self.model, theta)
        free = np.flatnonzero(~np.isnan(ends))
        if not len(free):
            return best
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
        motion = best.configuration.outcome.trajectory
        space = parameter_space(self.model)
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
            low, high = kept_box(self.model, theta, kept)
            start = Trajectory(motion.x, motion.u, theta)
            self.paths.structure.context.check_time()
            attempt = attempt_along(
                self.paths, best, start, (low, high), f"less {self.amount.text} {number}"
            )
            yield attempt
            if attempt.design is not None:
                return attempt.design
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
