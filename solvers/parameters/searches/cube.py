"""The unit cube that searches work in; an axis may stand for a finite list of values."""

from __future__ import annotations

from dataclasses import dataclass
from math import prod

import numpy as np

from compiler.arrays import Array


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
