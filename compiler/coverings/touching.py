"""Which boxes of a covering chains of touching boxes lead to; exact, in integers.

Closed boxes touch that share a point, a corner too; on a circle the last part touches the first.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from compiler.coverings.box_tree import MOST_HALVINGS, Parts
from compiler.time_limits.time_limit import check_time

Integers = NDArray[np.int64]
Flags = NDArray[np.bool_]
LARGEST_BLOCK = 2_000_000
"""Pairs of boxes that are compared at once."""


class TouchingBoxes:
    """Boxes by the parts of their sides; ``circles`` says which sides are circles."""

    def __init__(self, boxes: Sequence[Parts], circles: Sequence[bool]) -> None:
        shape = (len(boxes), len(circles))
        self.circles = tuple(circles)
        self.low: Integers = np.zeros(shape, dtype=np.int64)
        self.high: Integers = np.zeros(shape, dtype=np.int64)
        for i, box in enumerate(boxes):
            for j, part in enumerate(box):
                width = 1 << (MOST_HALVINGS - part.halvings)
                self.low[i, j], self.high[i, j] = part.number * width, (part.number + 1) * width

    def reachable(self, seeds: Flags, free: Flags) -> Flags:
        """The free boxes that chains of touching free boxes lead to from free seeds, (K,)."""
        reached = seeds & free
        frontier, waiting = np.flatnonzero(reached), np.flatnonzero(free & ~reached)
        while len(frontier) and len(waiting):
            touched = np.zeros(len(waiting), dtype=bool)
            size = max(1, LARGEST_BLOCK // len(waiting))
            for start in range(0, len(frontier), size):
                check_time()
                touched |= self._touch(frontier[start : start + size], waiting).any(axis=0)
            frontier, waiting = waiting[touched], waiting[~touched]
            reached[frontier] = True
        return reached

    def _touch(self, some: Integers, others: Integers) -> Flags:
        """Which pairs share a point, shape (some, others)."""
        found: Flags = np.ones((len(some), len(others)), dtype=bool)
        for side, circle in enumerate(self.circles):
            low, high = self.low[some, side, None], self.high[some, side, None]
            first, last = self.low[None, others, side], self.high[None, others, side]
            meet = (low <= last) & (first <= high)
            if circle:
                whole = 1 << MOST_HALVINGS
                meet |= ((low == 0) & (last == whole)) | ((high == whole) & (first == 0))
            found &= meet
        return found
