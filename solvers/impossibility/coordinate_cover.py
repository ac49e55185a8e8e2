"""A growing covering of one box of coordinates by leaves: halving, neighbours, shortest ways.

Sides are halved, so leaves are given by integers, and the test of whether two leaves touch is
exact.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TypeAlias

import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array
from compiler.time_limits.time_limit import check_time
from compiler.unreachability.box_tree import LEAF, CoordinateTree

Flags: TypeAlias = NDArray[np.bool_]
Numbers: TypeAlias = NDArray[np.int64]

MOST_HALVINGS = 30
"""The most halvings of one side: 3e-9 of a turn."""
UNREACHED = -1
REMEMBERED = 1_000
"""Touching pairs are stored for at most this many leaves."""


@dataclass(frozen=True, slots=True, eq=False)
class Side:
    """The ranges (n,) of the coordinates; ``circle``: the two ends of a range coincide."""

    low: Array
    high: Array
    circle: Flags


class CoordinateCover:
    """The tree, and its kept leaves: those that nothing excludes so far.

    ``first`` (K, n) are the leaves' lower ends in units of 2^-``MOST_HALVINGS`` of the range,
    ``depth`` (K, n) counts the halvings, ``node`` (K,) is the index in the tree.
    """

    def __init__(self, side: Side) -> None:
        count = len(side.low)
        self.side = side
        self._split: list[int] = [LEAF]
        self._halves: list[tuple[int, int]] = [(0, 0)]
        self.first: Numbers = np.zeros((1, count), dtype=np.int64)
        self.depth: Numbers = np.zeros((1, count), dtype=np.int64)
        self.node: Numbers = np.zeros(1, dtype=np.int64)
        self._pairs: Flags | None = None

    @property
    def leaves(self) -> int:
        """The number of all leaves of the tree."""
        return (len(self._split) + 1) // 2

    def boxes(self) -> tuple[Array, Array]:
        """The lower and upper ends of the kept leaves, each (K, n)."""
        width = (self.side.high - self.side.low) * 2.0**-MOST_HALVINGS
        low = self.side.low + self.first * width
        return low, low + (np.int64(1) << (MOST_HALVINGS - self.depth)) * width

    def keep(self, which: Flags) -> None:
        """Keep only some of the kept leaves, given by a mask (K,)."""
        self.first, self.depth = self.first[which], self.depth[which]
        self.node = self.node[which]
        self._pairs = None

    def halve(self, where: Numbers, variables: Numbers) -> Numbers:
        """Halve m kept leaves, ``where`` (m,), each at its variable (m,); both halves are kept.

        Returns:
            the indices of the halves, (2 m,): ``where``, then the same number at the end.
        """
        rows = np.arange(len(where))
        deeper = self.depth[where]
        deeper[rows, variables] += 1
        upper = self.first[where]
        upper[rows, variables] += np.int64(1) << (MOST_HALVINGS - deeper[rows, variables])
        nodes = len(self._split) + np.arange(2 * len(where)).reshape(-1, 2)
        for node, variable, halves in zip(self.node[where], variables, nodes, strict=True):
            self._split[node] = int(variable)
            self._halves[node] = int(halves[0]), int(halves[1])
        self._split += [LEAF] * nodes.size
        self._halves += [(0, 0)] * nodes.size
        before = len(self.node)
        self.depth[where], self.node[where] = deeper, nodes[:, 0]
        self.first = np.concatenate([self.first, upper])
        self.depth = np.concatenate([self.depth, deeper])
        self.node = np.concatenate([self.node, nodes[:, 1]])
        self._pairs = None
        return np.concatenate([where, before + rows])

    def divisible(self) -> Flags:
        """Which sides of the kept leaves can be halved, (K, n)."""
        return np.asarray(self.depth < MOST_HALVINGS)

    def tree(self) -> CoordinateTree:
        """The nodes in prefix order."""
        found, waiting = [], [0]
        while waiting:
            node = waiting.pop()
            found.append(self._split[node])
            if self._split[node] != LEAF:
                waiting += self._halves[node][::-1]
        return tuple(found)

    def distances(self, sources: Flags, within: Flags) -> Numbers:
        """The least number of steps between touching leaves, (K,); ``UNREACHED`` if unreachable."""
        found = np.full(len(self.node), UNREACHED, dtype=np.int64)
        front, steps = np.flatnonzero(sources & within), 0
        found[front] = 0
        left = np.flatnonzero(within & (found == UNREACHED))
        while len(front) and len(left):
            steps += 1
            check_time()
            near = self._touched(left, front)
            front, left = left[near], left[~near]
            found[front] = steps
        return found

    def _touched(self, these: Numbers, those: Numbers) -> Flags:
        """Which of some leaves touch any of others, (len(these),)."""
        if len(self.node) > REMEMBERED:
            return np.asarray(self._touching(these, those).any(axis=1))
        if self._pairs is None:
            everything = np.arange(len(self.node))
            self._pairs = self._touching(everything, everything)
        return np.asarray(np.any(self._pairs[np.ix_(these, those)], axis=1))

    def _touching(self, these: Numbers, those: Numbers) -> Flags:
        """Which pairs of leaves touch, (len(these), len(those))."""
        whole = np.int64(1) << MOST_HALVINGS
        last = self.first + (np.int64(1) << (MOST_HALVINGS - self.depth))
        touch = np.ones((len(these), len(those)), dtype=bool)
        for i, circle in enumerate(self.side.circle):
            a, b = self.first[these, i, None], last[these, i, None]
            c, d = self.first[those, i], last[those, i]
            near = (a <= d) & (c <= b)
            if circle:
                near |= ((a == 0) & (d == whole)) | ((c == 0) & (b == whole))
            touch &= near
        return touch

    def way(self, distances: Numbers, goals: Flags) -> Numbers:
        """A shortest chain (length,) of leaves back from the nearest goal; empty if there is none.

        ``distances`` (K,) are the result of ``distances``, ``goals`` (K,) a mask.
        """
        reached = np.flatnonzero(goals & (distances != UNREACHED))
        if not len(reached):
            return reached
        at = reached[np.argmin(distances[reached])]
        chain: list[int] = [int(at)]
        while distances[at] > 0:
            before = np.flatnonzero(distances == distances[at] - 1)
            at = before[np.argmax(self._touched(before, np.array([at])))]
            chain.append(int(at))
        return np.array(chain)
