"""Boxes of coordinates that chains of touching boxes join to others; none is missed.

The sides are floats that reach a little beyond the boxes: a few boxes too many may touch.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from flint import arb
from numpy.typing import NDArray

from compiler.time_limits.time_limit import check_time

Flags = NDArray[np.bool_]
BEYOND = 1e-9
"""By so much each side is longer than the box, relative to its place where that is above one."""
FULL_TURN = 6.283185307179586


class Neighbourhood:
    """Closed boxes (K,) of n coordinates; ``circles`` says which of those are full turns."""

    def __init__(self, boxes: Sequence[Sequence[arb]], circles: Sequence[bool]) -> None:
        shape = (len(boxes), len(circles))
        middle = np.array([[float(side.mid()) for side in box] for box in boxes]).reshape(shape)
        radius = np.array([[float(side.rad()) for side in box] for box in boxes]).reshape(shape)
        radius += BEYOND * (1 + np.abs(middle) + radius)
        self.low, self.high = middle - radius, middle + radius
        self.circles = tuple(circles)

    def joined(self, seeds: Flags, among: Flags) -> Flags:
        """Those of some boxes that chains of touching ones of them join to seeds, (K,)."""
        reached = seeds & among
        waiting = [int(i) for i in np.flatnonzero(reached)]
        rest = np.flatnonzero(among & ~reached)
        while waiting and len(rest):
            check_time()
            touching = self._touches(waiting.pop(), rest)
            found = rest[touching]
            reached[found] = True
            waiting += [int(i) for i in found]
            rest = rest[~touching]
        return reached

    def _touches(self, one: int, others: NDArray[np.intp]) -> Flags:
        found: Flags = np.ones(len(others), dtype=bool)
        for i, circle in enumerate(self.circles):
            low, high = self.low[others, i], self.high[others, i]
            meet: Flags = np.zeros(len(others), dtype=bool)
            for shift in (-FULL_TURN, 0.0, FULL_TURN) if circle else (0.0,):
                meet |= (low <= self.high[one, i] + shift) & (self.low[one, i] + shift <= high)
            found &= meet
        return found
