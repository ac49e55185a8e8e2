"""Arrays of balls of doubles, converted to and from balls of any precision."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from flint import arb, arb_mat

from compiler.arrays import Array

UPWARDS = 1 + 2.0**-50
"""A bound rounded to the nearest double, times this and plus ``LEAST``, is again a bound."""
LEAST = 2.0**-1000
"""Added to a rounded bound, which may be too small to have all its bits, or any."""


@dataclass(frozen=True, slots=True, eq=False)
class BallArray:
    """Balls with these middles and radii, arrays of one shape; NaN stands for any number."""

    middle: Array
    radius: Array

    @staticmethod
    def zeros(*shape: int) -> BallArray:
        """Exact zeros."""
        return BallArray(np.zeros(shape), np.zeros(shape))

    @staticmethod
    def of(balls: Iterable[arb]) -> BallArray:
        """Balls of doubles (n,) that contain the given balls."""
        pairs = [_doubles(item) for item in balls]
        array = np.array(pairs, dtype=np.float64).reshape(len(pairs), 2)
        return BallArray(array[:, 0], array[:, 1])

    @staticmethod
    def of_matrix(matrix: arb_mat) -> BallArray:
        """Balls of doubles that contain the entries of a matrix, in its shape."""
        found, shape = BallArray.of(matrix.entries()), (matrix.nrows(), matrix.ncols())
        return BallArray(found.middle.reshape(shape), found.radius.reshape(shape))

    @staticmethod
    def series(rows: Sequence[Sequence[arb]], length: int) -> BallArray:
        """The first coefficients of series, (n, length); missing ones are 0."""
        found = BallArray.zeros(len(rows), length)
        for number, row in enumerate(rows):
            for k, item in enumerate(row[:length]):
                found.middle[number, k], found.radius[number, k] = _doubles(item)
        return found

    def balls(self) -> list[arb]:
        """All balls, row by row."""
        pairs = zip(self.middle.ravel().tolist(), self.radius.ravel().tolist(), strict=True)
        return [arb(m) if r == 0 else arb(m, r) if r < np.inf else arb("nan") for m, r in pairs]

    def at(self, *index: int | slice) -> BallArray:
        """The balls at an index."""
        return BallArray(self.middle[index], self.radius[index])


def _doubles(item: arb) -> tuple[float, float]:
    middle = float(item)
    rest = item - middle
    return (middle, 0.0) if rest == 0 else (middle, float(rest.abs_upper()) * UPWARDS + LEAST)
