"""The parameters of a robot as a search space: a box and lists of values, mapped to the unit cube.

Everywhere in a search, parameters are one array theta of doubles (p,), in SI units and in the order
of ``RobotModel.parameters``; what is claimed of them is exact, as
:mod:`compiler.robots.parameter_values` has it.

The points that fill the cube evenly are Halton's sequence, scrambled by a seed: J. H. Halton,
"Algorithm 247: radical-inverse quasi-random point sequence" (1964); each digit of each axis goes
through a random permutation of its own, A. B. Owen, "A randomized Halton algorithm in R" (2017).
Every single point is then uniformly distributed in the cube.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import count, islice
from math import prod

import numpy as np

from compiler.arrays import Array
from compiler.robots.robot import RobotModel
from grammar_lang import ir
from grammar_lang.ir.constants import to_float

BITS = 52
"""Digits are used as long as all of them together are an exact double."""


@dataclass(frozen=True, slots=True)
class Cube:
    """The unit cube, by axis the number of values that can be told apart; None: all of [0, 1].

    An axis with n values is cut into n equal intervals; its points are their middles.
    """

    levels: tuple[int | None, ...]

    def __post_init__(self) -> None:
        if any(level is not None and level < 1 for level in self.levels):
            raise ValueError(f"an axis without values: {self.levels}")

    @property
    def dimension(self) -> int:
        """The number of axes p."""
        return len(self.levels)

    @property
    def size(self) -> int | None:
        """The number of distinct points; None where an axis is continuous."""
        known = [level for level in self.levels if level is not None]
        return prod(known) if len(known) == self.dimension else None

    def nearest(self, points: Array) -> Array:
        """The points of the cube that stand for points (..., p) of any kind, same shape."""
        found: Array = np.clip(np.asarray(points, dtype=float), 0.0, 1.0)
        for axis, level in enumerate(self.levels):
            if level is not None:
                number = np.minimum(np.floor(found[..., axis] * level), level - 1)
                found[..., axis] = (number + 0.5) / level
        return found


@dataclass(frozen=True, slots=True)
class Halton:
    """The sequence in ``dimension`` axes; without a seed, Halton's own, which begins at 0."""

    dimension: int
    seed: int | None

    def points(self, first: int, last: int) -> Array:
        """The points with numbers first, ..., last - 1, shape (last - first, dimension)."""
        found = np.zeros((max(0, last - first), self.dimension))
        bases = islice((n for n in count(2) if _is_prime(n)), self.dimension)
        for axis, base in enumerate(bases):
            left = np.arange(first, last)
            # Each axis has a generator of its own, so that no axis depends on how many there are.
            rng = None if self.seed is None else np.random.default_rng([self.seed, axis])
            weight = 1.0
            for _ in range(int(BITS / np.log2(base))):
                order = np.arange(base) if rng is None else rng.permutation(base)
                weight /= base
                found[:, axis] += order[left % base] * weight
                left = left // base
        return found


def _is_prime(number: int) -> bool:
    return all(number % divisor for divisor in range(2, int(number**0.5) + 1))


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

    def to_cube(self, theta: Array) -> Array:
        """The point of the unit cube (p,) that stands for some parameters (p,)."""
        width = self.upper - self.lower
        point = (theta - self.lower) / np.where(width > 0, width, 1.0)
        for index, values in enumerate(self.choices):
            if values is not None:
                nearest = int(np.argmin(np.abs(values - theta[index])))
                point[index] = (nearest + 0.5) / len(values)
        return self.cube.nearest(point)

    def samples(self, power: int, seed: int) -> list[Array]:
        """A sequence of 2**power parameters that fill the space; one where nothing is free."""
        if self.is_point:
            return [self.lower]
        points = Halton(len(self.lower), seed).points(0, 2**power)
        return [self.from_cube(point) for point in points]

    def drawn(self, rng: np.random.Generator) -> Array:
        """Parameters (p,) drawn at random, uniformly in the box and among the lists."""
        return np.array(
            [
                rng.uniform(low, high) if values is None else values[int(rng.integers(len(values)))]
                for low, high, values in zip(self.lower, self.upper, self.choices, strict=True)
            ]
        )

    def uniform(self, rng: np.random.Generator, count: int) -> Array:
        """``count`` rows (count, p) drawn between the least and the largest values."""
        return rng.uniform(self.lower, self.upper, (count, len(self.lower)))

    def free_box(self, theta: Array) -> tuple[Array, Array] | None:
        """Bounds (p,) of theta as unknowns: discrete parameters stay; None where all are fixed."""
        if self.is_point:
            return None
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
