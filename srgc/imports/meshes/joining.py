"""Join neighbouring parts of a mesh if one piece for both adds little."""

from __future__ import annotations

import heapq
from itertools import count

import numpy as np

from srgc.imports.meshes.mesh import Floats
from srgc.imports.meshes.regions import MergedRegion, Region

NEIGHBOURS = 8
"""A region may be joined with one of this many nearest neighbours."""
APART = 0.02
"""Regions farther apart than this share of the larger are joined only if they are too many."""


class Joining:
    """Regions, and the pairs that may be joined, in the order of the volume that this adds."""

    def __init__(self, regions: list[Region]) -> None:
        self.alive = dict(enumerate(regions))
        self.boxes = {number: _box(region) for number, region in self.alive.items()}
        self.numbers = count(len(regions))
        self.heap: list[tuple[float, int, int, MergedRegion]] = []
        self.offered: set[tuple[int, int]] = set()
        for number in list(self.alive) if len(self.alive) > 1 else ():
            self._offer(number, apart=APART)

    def join(self, budget: float, most: int) -> list[Region]:
        """The regions, joined while in all they add at most the budget (m^3), or are too many."""
        total = sum(each.excess for each in self.alive.values())
        while len(self.alive) > 1:
            if not self.heap:
                if len(self.alive) <= most:
                    break
                for number in self.alive:
                    self._offer(number, apart=np.inf)
            added, one, other, merged = heapq.heappop(self.heap)
            if one not in self.alive or other not in self.alive:
                continue
            if len(self.alive) <= most and total + added > budget:
                break
            total += added
            del self.alive[one], self.alive[other]
            number = next(self.numbers)
            self.alive[number] = merged
            self.boxes[number] = _box(merged)
            if len(self.alive) > 1:
                self._offer(number, apart=APART)
        return list(self.alive.values())

    def _offer(self, number: int, *, apart: float) -> None:
        """Add the pairs of a region and its neighbours to the heap."""
        region, (lower, upper) = self.alive[number], self.boxes[number]
        others = [i for i in self.alive if i != number]
        low, high = np.array([self.boxes[i] for i in others]).transpose(1, 0, 2)
        gaps = np.maximum(np.maximum(lower - high, low - upper), 0.0).max(axis=1)
        middles = np.abs(lower + upper - low - high).max(axis=1)
        sizes = np.maximum((high - low).max(axis=1), (upper - lower).max())
        for place in np.lexsort((middles, gaps))[:NEIGHBOURS].tolist():
            i = others[place]
            pair = (min(i, number), max(i, number))
            if gaps[place] > apart * sizes[place] or pair in self.offered:
                continue
            self.offered.add(pair)
            merged = MergedRegion(region, self.alive[i])
            added = merged.excess - region.excess - self.alive[i].excess
            heapq.heappush(self.heap, (added, *pair, merged))


def _box(region: Region) -> tuple[Floats, Floats]:
    return region.points.min(axis=0), region.points.max(axis=0)
