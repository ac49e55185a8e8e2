"""The parameters of a robot as a search space: a box, mapped to the unit cube, and lists of values.

A search leaves doubles; what is claimed of them is exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from compiler.arrays import Array
from compiler.robots.robot import RobotModel
from grammar_lang import ir
from grammar_lang.ir.constants import rational, to_float
from solvers.parameters.searches.cube import Cube, Halton
from solvers.verifier.claims.certificate import exact_decimal


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

    @property
    def cube(self) -> Cube:
        """The unit cube with as many levels by axis as there are values."""
        ends = zip(self.lower, self.upper, self.choices, strict=True)
        return Cube(
            tuple(
                1 if low == high else None if values is None else len(values)
                for low, high, values in ends
            )
        )

    def from_cube(self, point: Array) -> Array:
        """Parameters (p,) of a point of the unit cube (p,)."""
        # The rounding of the sum must not leave the box.
        theta = np.minimum(self.lower + point * (self.upper - self.lower), self.upper)
        for index, values in enumerate(self.choices):
            if values is not None:
                theta[index] = values[min(int(point[index] * len(values)), len(values) - 1)]
        return np.asarray(theta)

    def samples(self, power: int, seed: int) -> list[Array]:
        """A sequence of 2**power parameters that fill the space; one where nothing is free."""
        if self.is_point:
            return [self.lower]
        points = Halton(len(self.lower), seed).points(0, 2**power)
        return [self.from_cube(point) for point in points]

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
