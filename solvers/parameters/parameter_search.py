"""The search for parameters: the search space, and the interface to the search methods."""

from __future__ import annotations

from dataclasses import dataclass, field
from itertools import count, islice
from math import prod
from typing import Protocol

import numpy as np

from compiler.arrays import Array
from compiler.robots.robot import RobotModel
from grammar_lang import ir
from grammar_lang.ir.constants import to_float

# --------------------------------------------------------------------------------------------------
# The parameters of a robot as a search space: a box and lists of values, mapped to the unit cube.
#
# Throughout a search, parameters are one array theta of doubles (p,), in SI units and in the order
# of ``RobotModel.parameters``; certificates state exact values, see
# :mod:`compiler.robots.parameter_values`.
#
# The points that fill the cube evenly are Halton's sequence, scrambled by a seed: J. H. Halton,
# "Algorithm 247: radical-inverse quasi-random point sequence" (1964); each digit of each axis goes
# through its own random permutation, A. B. Owen, "A randomized Halton algorithm in R" (2017).
# Every single point is then uniformly distributed in the cube.


BITS = 52
"""The total bits of the digits used, so that their sum is an exact double."""


@dataclass(frozen=True, slots=True)
class Cube:
    """The unit cube, with the number of distinct values on each axis; None for all of [0, 1].

    An axis with n values is divided into n equal intervals; its points are their midpoints.
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
        """The number of distinct points; None if an axis is continuous."""
        known = [level for level in self.levels if level is not None]
        return prod(known) if len(known) == self.dimension else None

    def nearest(self, points: Array) -> Array:
        """The points of the cube nearest to arbitrary points (..., p), same shape."""
        found: Array = np.clip(np.asarray(points, dtype=float), 0.0, 1.0)
        for axis, level in enumerate(self.levels):
            if level is not None:
                number = np.minimum(np.floor(found[..., axis] * level), level - 1)
                found[..., axis] = (number + 0.5) / level
        return found


@dataclass(frozen=True, slots=True)
class Halton:
    """Halton's sequence in ``dimension`` axes, from point 0 on, with digits permuted by the seed.

    Without a seed it is Halton's own (1964), otherwise each axis is scrambled as by Owen (2017).
    """

    dimension: int
    seed: int | None

    def points(self, first: int, last: int) -> Array:
        """The points with numbers first, ..., last - 1, shape (last - first, dimension)."""
        found = np.zeros((max(0, last - first), self.dimension))
        bases = islice((n for n in count(2) if _is_prime(n)), self.dimension)
        for axis, base in enumerate(bases):
            left = np.arange(first, last)
            # Each axis has its own generator, so that it does not depend on the number of axes.
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
    """The box of interval parameters, ``lower`` to ``upper`` (p,), in SI units.

    ``choices`` lists the values of discrete parameters, None for interval ones.
    """

    lower: Array
    upper: Array
    choices: tuple[Array | None, ...]

    @property
    def is_point(self) -> bool:
        """Whether there is only one choice."""
        return bool(np.all(self.lower == self.upper))

    @property
    def cube(self) -> Cube:
        """The unit cube with one level per value on discrete axes."""
        ends = zip(self.lower, self.upper, self.choices, strict=True)
        return Cube(
            tuple(
                1 if low == high else None if values is None else len(values)
                for low, high, values in ends
            )
        )

    def from_cube(self, point: Array) -> Array:
        """Parameters (p,) of a point of the unit cube (p,)."""
        # Rounding of the sum must not leave the box.
        theta = np.minimum(self.lower + point * (self.upper - self.lower), self.upper)
        for index, values in enumerate(self.choices):
            if values is not None:
                theta[index] = values[min(int(point[index] * len(values)), len(values) - 1)]
        return np.asarray(theta)

    def to_cube(self, theta: Array) -> Array:
        """The point of the unit cube (p,) that represents parameters (p,)."""
        width = self.upper - self.lower
        point = (theta - self.lower) / np.where(width > 0, width, 1.0)
        for index, values in enumerate(self.choices):
            if values is not None:
                nearest = int(np.argmin(np.abs(values - theta[index])))
                point[index] = (nearest + 0.5) / len(values)
        return self.cube.nearest(point)

    def samples(self, power: int, seed: int) -> list[Array]:
        """A sequence of 2**power parameters (p,) that fill the space; one if it is a point."""
        if self.is_point:
            return [self.lower]
        points = Halton(len(self.lower), seed).points(0, 2**power)
        return [self.from_cube(point) for point in points]

    def drawn(self, rng: np.random.Generator) -> Array:
        """Random parameters (p,), uniform in the box and among the discrete values."""
        return np.array(
            [
                rng.uniform(low, high) if values is None else values[int(rng.integers(len(values)))]
                for low, high, values in zip(self.lower, self.upper, self.choices, strict=True)
            ]
        )

    def uniform(self, rng: np.random.Generator, count: int) -> Array:
        """``count`` rows (count, p) drawn between the least and the greatest values."""
        return rng.uniform(self.lower, self.upper, (count, len(self.lower)))

    def free_box(self, theta: Array) -> tuple[Array, Array] | None:
        """Bounds (p,) on theta as unknowns, with discrete parameters fixed; None if all are."""
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


# --------------------------------------------------------------------------------------------------
# Ask and tell: one interface to all methods that search for the largest value in the unit cube.
#
# The caller asks a search for points and tells it their values in any order.  A method only
# proposes points and learns values; the bookkeeping that all methods share is here.


TRIES = 200
"""After this many rounds of proposals without enough new points, other points are taken."""


@dataclass(slots=True)
class Record:
    """The state of a search: points (p,) with their values, and points that are pending."""

    cube: Cube
    points: list[Array] = field(default_factory=list[Array])
    values: list[float] = field(default_factory=list[float])
    pending: list[Array] = field(default_factory=list[Array])

    def best(self) -> int:
        """The index of the largest value, the first of equal ones."""
        return int(np.argmax(self.values))


class Method(Protocol):
    """A search method; it starts once the initial points have values."""

    def propose(self, count: int, record: Record) -> list[Array]:
        """At most ``count`` points (p,) of the cube; none if it has to wait for pending ones."""
        ...

    def learn(self, point: Array, value: float) -> None:
        """Receive the value of a proposed point (p,), in the order of the proposals."""
        ...


@dataclass(slots=True)
class ParameterSearch:
    """A search for the maximum on the unit cube that asks for points and is told their values.

    The first ``initial`` points fill the cube evenly, the others come from the method.  No point is
    asked for twice: if the method proposes a known point, it is told the known value.  The points
    depend only on the seed and on the values told.
    """

    cube: Cube
    seed: int
    initial: int
    method: Method
    record: Record = field(init=False)
    _proposed: list[Array] = field(default_factory=list[Array])
    _known: dict[bytes, float] = field(default_factory=dict[bytes, float])
    _drawn: int = 0
    _begun: bool = False
    """Whether all initial points have values."""

    def __post_init__(self) -> None:
        if self.initial < 1:
            raise ValueError("a search begins with one point at least")
        self.record = Record(self.cube)

    @property
    def points(self) -> list[Array]:
        """The points (p,) that have a value, in the order in which they were told."""
        return self.record.points

    @property
    def values(self) -> list[float]:
        """The values of these points."""
        return self.record.values

    def ask(self, count: int) -> list[Array]:
        """At most ``count`` new points (p,) of the cube, all different.

        There are fewer if the method needs their values first, and none if it waits for the values
        of pending points or if all points are known.

        Raises:
            ValueError: if ``count`` is not positive.
        """
        if count < 1:
            raise ValueError("at least one point is to be asked for")
        before = len(self.record.pending)
        for _ in range(TRIES):
            wanted = before + count - len(self.record.pending)
            if wanted == 0 or self._exhausted() or not self._advance(wanted):
                break
        else:
            self._fill(before + count)
        return self.record.pending[before:]

    def tell(self, point: Array, value: float) -> None:
        """Receive the value at a point (p,) of the cube, asked for or not.

        Raises:
            ValueError: if the value is not finite (the caller must grade infeasible points), the
                point is not in the cube, or it already has another value.
        """
        point = np.array(point, dtype=float)
        if not np.isfinite(value):
            raise ValueError(f"a search cannot be told {value}")
        if point.shape != (self.cube.dimension,) or not np.all((point >= 0) & (point <= 1)):
            raise ValueError(f"no point of the unit cube: {point}")
        point = self.cube.nearest(point)
        key, record = point.tobytes(), self.record
        if key in self._known:
            if self._known[key] != value:
                raise ValueError(f"two values of one point: {self._known[key]} and {value}")
            return
        self._known[key] = float(value)
        record.pending = [p for p in record.pending if p.tobytes() != key]
        record.points.append(point)
        record.values.append(float(value))
        self._learn()

    # --- what to ask for ------------------------------------------------------------------------

    def _advance(self, wanted: int) -> bool:
        """Take points of the initial design, then of the method; False if it has to wait."""
        record = self.record
        if self._drawn < self.initial:
            self._new(self._draw())
            return True
        self._begun = self._begun or not record.pending
        if not self._begun:
            return False
        proposals = self.method.propose(wanted, record)
        if not proposals:
            if record.pending:
                return False
            self._new(self._draw())
            return True
        for raw in proposals:
            self._proposed.append(raw)
            self._new(raw)
        self._learn()
        return True

    def _draw(self) -> Array:
        """The next point of the sequence that fills the cube."""
        self._drawn += 1
        sequence = Halton(self.cube.dimension, self.seed)
        return np.asarray(sequence.points(self._drawn - 1, self._drawn)[0])

    def _fill(self, total: int) -> None:
        """Ask for points of the sequence, because the method keeps returning to known ones."""
        for _ in range(TRIES):
            if len(self.record.pending) >= total or self._exhausted():
                break
            self._new(self._draw())

    def _new(self, raw: Array) -> None:
        """Ask for a point, unless it is already pending or known."""
        point = self.cube.nearest(raw)
        key = point.tobytes()
        if key not in self._known and all(p.tobytes() != key for p in self.record.pending):
            self.record.pending.append(point)

    def _exhausted(self) -> bool:
        """Whether every point is known or pending."""
        size = self.cube.size
        return size is not None and len(self._known) + len(self.record.pending) >= size

    def _learn(self) -> None:
        """Tell the method the values of its proposals, in order, as far as they are known."""
        while self._proposed:
            key = self.cube.nearest(self._proposed[0]).tobytes()
            if key not in self._known:
                break
            self.method.learn(self._proposed.pop(0), self._known[key])
