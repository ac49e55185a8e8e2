"""Points that fill the unit cube evenly from the first on: Halton's sequence, scrambled by a seed.

J. H. Halton, "Algorithm 247: radical-inverse quasi-random point sequence" (1964); each digit of
each axis goes through a random permutation of its own, A. B. Owen, "A randomized Halton algorithm
in R" (2017).  Every single point is then uniformly distributed in the cube.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import count, islice

import numpy as np

from compiler.arrays import Array

BITS = 52
"""Digits are used as long as all of them together are an exact double."""


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
