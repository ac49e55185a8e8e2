"""P.Synthesis, problem (ii): the search for parameters, as ask and tell.

The search space is the robot's parameter box mapped to the unit cube; a parameter with a finite set
of values is rounded to one of them.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction

import numpy as np
from scipy.stats.qmc import Sobol

from compiler.discretisation.float_reading import Array
from compiler.robots.robot import RobotModel
from grammar_lang import ir
from grammar_lang.constants import rational, to_float
from solvers.claims.certificate import exact_decimal
from solvers.parameters.acquisition import Acquisition, gp_acb
from solvers.parameters.surrogate import posterior

CANDIDATES_LOG2 = 9
INITIAL_LOG2 = 3
APART = 0.05
"""Points asked for at once differ by this much in some coordinate of the unit cube."""


@dataclass(frozen=True, slots=True)
class ParameterSpace:
    """The box of interval parameters and the lists of discrete ones, SI."""

    lower: Array
    upper: Array
    choices: tuple[Array | None, ...]

    @property
    def is_point(self) -> bool:
        """Whether there is nothing to choose."""
        return bool(np.all(self.lower == self.upper))

    def from_cube(self, point: Array) -> Array:
        """Parameters (p,) of a point of the unit cube (p,)."""
        theta = self.lower + point * (self.upper - self.lower)
        for index, values in enumerate(self.choices):
            if values is not None:
                theta[index] = values[min(int(point[index] * len(values)), len(values) - 1)]
        return np.asarray(theta)

    def samples(self, power: int, seed: int) -> list[Array]:
        """A Sobol sequence of 2**power parameters; one where nothing is free."""
        from scipy.stats.qmc import Sobol

        if self.is_point:
            return [self.lower]
        cube = Sobol(len(self.lower), seed=seed).random_base2(power)
        return [self.from_cube(point) for point in cube]

    def free_box(self, theta: Array) -> tuple[Array, Array]:
        """Bounds for polishing about theta: discrete parameters stay as they are."""
        fixed = np.array([values is not None for values in self.choices], dtype=bool)
        return np.where(fixed, theta, self.lower), np.where(fixed, theta, self.upper)


def parameter_space(model: RobotModel) -> ParameterSpace:
    """The search space of a robot."""
    lower, upper, choices = [], [], list[Array | None]()
    for parameter in model.parameters:
        domain = parameter.domain
        if isinstance(domain, ir.Interval):
            ends = to_float(domain.lower), to_float(domain.upper)
            choices.append(None)
        else:
            values = np.array([to_float(value) for value in domain.values])
            ends = float(values.min()), float(values.max())
            choices.append(values)
        lower.append(ends[0])
        upper.append(ends[1])
    return ParameterSpace(np.array(lower), np.array(upper), tuple(choices))


@dataclass(slots=True)
class BayesianSearch:
    """Ask for parameters, tell their robustness; maximises.

    The first points are a Sobol sequence; then the acquisition rule over a finite candidate set.
    No candidate is ever discarded on a confidence bound.
    """

    space: ParameterSpace
    seed: int
    acquisition: Acquisition = gp_acb
    points: list[Array] = field(default_factory=list[Array])
    values: list[float] = field(default_factory=list[float])
    _candidates: Array | None = None

    @property
    def candidates(self) -> Array:
        """The candidate set in the unit cube, shape (c, p)."""
        if self._candidates is None:
            sobol = Sobol(len(self.space.lower), seed=self.seed)
            self._candidates = np.asarray(sobol.random_base2(CANDIDATES_LOG2))
        return self._candidates

    def initial(self) -> list[Array]:
        """The points of the unit cube to be tried first, independent of each other."""
        return list(self.candidates[: 2**INITIAL_LOG2])

    def ask(self, count: int) -> list[Array]:
        """The next points of the unit cube: the best by the rule, then the best apart from it."""
        mean, deviation = posterior(np.array(self.points), np.array(self.values), self.candidates)
        worth = self.acquisition(mean, deviation, len(self.points))
        chosen = list(self.points)
        new: list[Array] = []
        for _ in range(count):
            gap = np.min(
                [np.max(np.abs(self.candidates - point), axis=1) for point in chosen], axis=0
            )
            apart = gap > (APART if new else 0.0)
            if not apart.any():
                break
            best = self.candidates[int(np.argmax(np.where(apart, worth, -np.inf)))]
            new.append(np.asarray(best))
            chosen.append(new[-1])
        return new

    def tell(self, point: Array, value: float) -> None:
        """Record the robustness at a point of the unit cube."""
        self.points.append(point)
        self.values.append(value)


def exact_value(domain: ir.Interval | ir.Choices, value: float) -> Fraction:
    """The rational that states what a search has left beside a value of a domain by rounding.

    A value that is not rational is stated by the double next to it.
    """
    nearest = Fraction(repr(float(value)))
    if isinstance(domain, ir.Choices):
        stated = [_stated(choice) for choice in domain.values]
        return min(stated, key=lambda choice: abs(choice - nearest))
    lower, upper = rational(domain.lower), rational(domain.upper)
    if lower is not None:
        nearest = max(nearest, lower)
    return nearest if upper is None else min(nearest, upper)


def _stated(value: ir.Expr) -> Fraction:
    exact = rational(value)
    return Fraction(repr(to_float(value))) if exact is None else exact


def exact_text(domain: ir.Interval | ir.Choices, value: float) -> str:
    """That rational as a finite decimal where it is one, else as a quotient."""
    nearest = exact_value(domain, value)
    try:
        return exact_decimal(nearest)
    except ValueError:
        return str(nearest)
