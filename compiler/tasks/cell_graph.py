"""Cells and their neighbours as arrays, and distances in numbers of changes."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from compiler.tasks.clauses import Ints

UNREACHABLE = np.iinfo(np.int64).max // 4


@dataclass(frozen=True, slots=True, eq=False)
class Edges:
    """The directed edges ``tails[k] -> heads[k]`` in order of their tails; shapes (edges,)."""

    count: int
    tails: Ints
    heads: Ints
    first: Ints

    def of(self, cells: Ints) -> tuple[Ints, Ints]:
        """The edges out of some cells: the index of the cell among them, and the head."""
        degrees = self.first[cells + 1] - self.first[cells]
        owners = np.repeat(np.arange(len(cells)), degrees)
        ends = np.cumsum(degrees)
        within = np.arange(len(owners)) - np.repeat(ends - degrees, degrees)
        return owners, self.heads[self.first[cells][owners] + within]


def edges(neighbours: Sequence[Sequence[int]]) -> Edges:
    """The edges of a graph, given per cell its neighbours."""
    degrees = np.array([len(cells) for cells in neighbours], dtype=np.int64)
    heads = np.fromiter((c for cells in neighbours for c in cells), np.int64, int(degrees.sum()))
    tails = np.repeat(np.arange(len(neighbours)), degrees)
    first = np.concatenate([np.zeros(1, dtype=np.int64), np.cumsum(degrees)])
    return Edges(len(neighbours), tails, heads, first)


def distances(
    neighbours: Sequence[Sequence[int]], sources: Iterable[int], allowed: NDArray[np.bool_]
) -> Ints:
    """The least number of steps from the sources within the allowed cells, shape (n,)."""
    usable = allowed.tolist()
    found = [UNREACHABLE] * len(neighbours)
    waiting = deque(cell for cell in sorted(set(sources)) if usable[cell])
    for cell in waiting:
        found[cell] = 0
    while waiting:
        cell = waiting.popleft()
        further = found[cell] + 1
        for following in neighbours[cell]:
            if usable[following] and found[following] == UNREACHABLE:
                found[following] = further
                waiting.append(following)
    return np.array(found, dtype=np.int64)
