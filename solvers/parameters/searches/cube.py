"""The unit cube that searches work in, and points that fill it evenly from the first on.

The points are Halton's sequence, scrambled by a seed: J. H. Halton, "Algorithm 247: radical-inverse
quasi-random point sequence" (1964); each digit of each axis goes through a random permutation of
its own, A. B. Owen, "A randomized Halton algorithm in R" (2017).  Every single point is then
uniformly distributed in the cube.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import count, islice
from math import prod

import numpy as np

from compiler.arrays import Array

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
