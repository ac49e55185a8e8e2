"""Extensions by hulls: corners are constant combinations of the axes of a frame.

In a direction n the height of a corner is that of the middle plus sum(w_i n . x_i). The corner that
is lowest at the middle of a slice, in floats, is compared with all others in balls: those that are
certainly not lower throughout the slice can be left out, even if that corner is not the lowest.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from fractions import Fraction
from typing import TypeAlias

import numpy as np
from flint import arb

from compiler.arrays import Array
from compiler.expressions.evaluators.balls import ball
from solvers.verifier.proofs.extension import Corner, Extension, Forms, Rim
from solvers.verifier.proofs.point_map import Slice, Terms

MOST_CORNERS = 8
"""If more corners may be lowest, the others only contribute a bound of how much lower they are."""

Weights: TypeAlias = tuple[arb, ...]
"""One weight for each column."""


@dataclass(frozen=True, slots=True)
class HullExtension(Extension):
    """The weights are those of one of the ``ways``, or between them.

    ``floats`` are approximate weights, (w, c), by which corners are chosen.
    """

    ways: tuple[Weights, ...]
    floats: Array = field(compare=False)
    differences: dict[int, tuple[Weights, ...]] = field(
        default_factory=dict[int, tuple[Weights, ...]], compare=False, repr=False
    )
    """Maps a corner to the differences of all weights from its own; computed on demand."""

    @staticmethod
    def of(columns: tuple[int, ...], corners: Sequence[Sequence[Fraction]]) -> HullExtension:
        """The hull of corners, given in metres along the columns from a middle."""
        own = [corner[: len(columns)] for corner in corners]
        floats = np.array([[float(x) for x in corner] for corner in own])
        return HullExtension(columns, tuple(tuple(map(ball, corner)) for corner in own), floats)

    def opposite(self) -> HullExtension:
        """The mirror image at the middle."""
        ways = tuple(tuple(-weight for weight in way) for way in self.ways)
        return replace(self, ways=ways, floats=-self.floats, differences={})

    @property
    def farthest(self) -> tuple[arb, ...]:
        """The largest absolute weight of each column."""
        found = []
        for weights in zip(*self.ways, strict=True):
            most = arb(0)
            for weight in weights:
                most = most.max(abs(weight))
            found.append(most)
        return tuple(found)

    def corners(self, rims: Sequence[Rim]) -> list[Terms]:
        """All corners."""
        del rims
        return [self._terms(number) for number in range(len(self.ways))]

    def _terms(self, number: int) -> Terms:
        return tuple(zip(self.columns, self.ways[number], strict=True))

    def lowest(self, forms: Forms) -> tuple[list[Terms], arb, arb]:
        """The corners that are not certainly above the one that is lowest at the middle.

        If there are a great many, some are left out; the added bounds say how much lower these are.
        """
        heights = self.floats @ np.array([float(at.mid()) for _, at in forms])
        order = np.argsort(heights, kind="stable").tolist()
        more = self._more_than(order[0])
        kept, over, centre = [order[0]], arb(0), arb(0)
        for number in order[1:]:
            higher = _sum(more[number], [value for value, _ in forms])
            if bool(higher >= 0):
                continue
            if len(kept) < MOST_CORNERS:
                kept.append(number)
                continue
            over = over.union(higher.min(arb(0)))
            centre = centre.union(_sum(more[number], [at for _, at in forms]).min(arb(0)))
        return [self._terms(number) for number in kept], over, centre

    def _more_than(self, number: int) -> tuple[Weights, ...]:
        if number not in self.differences:
            one = self.ways[number]
            self.differences[number] = tuple(
                tuple(a - b for a, b in zip(way, one, strict=True)) for way in self.ways
            )
        return self.differences[number]


def _sum(weights: Weights, values: Sequence[arb]) -> arb:
    total = arb(0)
    for weight, value in zip(weights, values, strict=True):
        total += weight * value
    return total


def has_hull(extensions: Sequence[Extension]) -> bool:
    """Whether one of the extensions is a hull, which may have a great many corners."""
    return any(isinstance(each, HullExtension) for each in extensions)


@dataclass(frozen=True, slots=True)
class ManyCorners:
    """All corners that extensions add to some points, at the middle of a slice, in floats.

    ``places`` are (count, d); a corner is computed in balls on demand.
    """

    points: tuple[int, ...]
    terms: tuple[list[Terms], ...]
    places: Array

    @staticmethod
    def of(
        over: Slice,
        points: Sequence[int],
        extensions: Sequence[Extension],
        rims: Sequence[Sequence[Rim]],
    ) -> ManyCorners:
        """The corners in the order of ``extension.corners``; ``rims`` has directions for each."""
        found = np.array([over.middle(point) for point in points])
        terms = tuple(each.corners(more) for each, more in zip(extensions, rims, strict=True))
        for each, ways in zip(extensions, terms, strict=True):
            columns = np.array([over.middle(column) for column in each.columns])
            if isinstance(each, HullExtension):
                weights = each.floats
            else:
                weights = np.array([[float(w.mid()) for _, w in way] for way in ways])
            offsets = weights @ columns
            found = (found[:, None] + offsets[None]).reshape(-1, found.shape[1])
        return ManyCorners(tuple(points), terms, found)

    def corner(self, number: int) -> Corner:
        """The corner with a number."""
        chosen = list[Terms]()
        for ways in reversed(self.terms):
            number, way = divmod(number, len(ways))
            chosen.append(ways[way])
        return self.points[number], tuple(term for ways in reversed(chosen) for term in ways)
