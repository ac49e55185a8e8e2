"""Positions of a robot's points over slices of a tube.

Over a slice of time of half-width d about its middle, a position is enclosed to second order,

    p(s) in p(0) + p'(0) s + [p''/2] s^2,   |s| <= d,

the first two at the middle and the last over the whole slice.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TypeAlias

from flint import arb, arb_mat, arb_series, ctx

from compiler.expressions.evaluators.balls import BALLS, SERIES, SIGNS, rows
from compiler.expressions.tape import Tape
from solvers.verifier.proofs.enclosure import TubeSegment
from solvers.verifier.proofs.vector_field import VectorField
from solvers.verifier.proofs.zonotope import Zonotope

Terms: TypeAlias = tuple[tuple[int, arb], ...]
"""Points, by number, with weights."""


@dataclass(frozen=True, slots=True)
class Slice:
    """Positions over a slice of time: per point and axis (p(0), p'(0), p''/2) and half-width d.

    In a wide tube ``columns`` (d, c) per point span p(0) about the ``path`` and keep the dependence
    between its entries; ``ranges`` are balls of all positions over the slice, (d,) per point, which
    are tighter than the expansion if p' is hardly known.
    """

    time: arb
    half: arb
    points: tuple[tuple[tuple[arb, arb, arb], ...], ...]
    path: tuple[tuple[arb, ...], ...] = ()
    columns: tuple[arb_mat, ...] = ()
    ranges: tuple[tuple[arb, ...], ...] = ()

    def form(self, normal: Sequence[arb], point: int, terms: Terms = ()) -> tuple[arb, arb]:
        """Enclosures of ``normal . p`` over the slice and at its middle.

        p is a point, or a point plus other points, used as directions, with the weights of
        ``terms``.
        """
        parts: list[tuple[Sequence[arb], int]] = [(normal, point)]
        if terms:
            parts += [([weight * a for a in normal], column) for column, weight in terms]
        zero, one, two = arb(0), arb(0), arb(0)
        for scaled, number in parts:
            for a, (p0, p1, p2) in zip(scaled, self.points[number], strict=True):
                zero, one, two = zero + a * p0, one + a * p1, two + a * p2
        if self.columns:
            zero = zero.intersection(self._together(parts))
        s = arb(0, 1) * self.half
        square = arb(0.5, 0.5) * self.half * self.half
        value = zero + one * s + two * square
        if self.ranges:
            ranges = (_product(scaled, self.ranges[number]) for scaled, number in parts)
            value = value.intersection(sum(ranges, arb(0)))
        return value, zero

    def _together(self, parts: Sequence[tuple[Sequence[arb], int]]) -> arb:
        """The sum of ``normal . p`` at the middle, computed from the columns."""
        centre = sum((_product(normal, self.path[point]) for normal, point in parts), arb(0))
        first, *others = (arb_mat([list(normal)]) * self.columns[point] for normal, point in parts)
        moved = sum(others, first)
        return centre + SIGNS * sum((abs(item) for item in moved.entries()), arb(0)).upper()

    def middle(self, point: int) -> tuple[float, ...]:
        """The approximate position of a point at the middle of the slice."""
        return tuple(float(axis[0].mid()) for axis in self.points[point])


@dataclass(frozen=True, slots=True)
class PointMap:
    """Turns a tube into enclosures of positions: ``tape`` maps (q, theta, k) to all points.

    ``slopes`` gives the Jacobian of the points in q, column by column; only wide tubes need it.
    """

    tape: Tape
    field: VectorField
    dimension: int
    slopes: Tape | None = None

    def first(self, count: int) -> PointMap:
        """A map of the first ``count`` points, over slices only."""
        return replace(self, tape=self.tape.first(count * self.dimension), slopes=None)

    def positions(self, state: Sequence[arb]) -> list[list[arb]]:
        """Positions (points, d) for a state given as balls."""
        n = self.field.dofs
        flat = self.tape.evaluate([*state[:n], *self.field.tail], BALLS)
        d = self.dimension
        return [flat[i : i + d] for i in range(0, len(flat), d)]

    def over(self, segment: TubeSegment, u: Sequence[arb], middle: arb, half: arb) -> Slice | None:
        """Positions over a slice of a segment; None if they are not finite."""
        n, d = self.field.dofs, self.dimension
        state, centre = segment.at(middle + SIGNS * half), segment.at(middle)
        try:
            pull = self.field.acceleration(state, u)
        except ZeroDivisionError:
            return None
        if not all(item.is_finite() for item in (*state, *pull)):
            return None
        wide = self._series([[state[i], state[n + i], pull[i] / 2] for i in range(n)], 3, 2)
        near = self._series([[centre[i], centre[n + i]] for i in range(n)], 2)
        flat = [(value, rate, bend) for (value, rate), (bend,) in zip(near, wide, strict=True)]
        points = tuple(tuple(flat[i : i + d]) for i in range(0, len(flat), d))
        return Slice(segment.start + middle, half, points)

    def closer(self, segment: TubeSegment, middle: arb, over: Slice) -> Slice:
        """A slice with columns for the positions at its middle, and with their ranges.

        By the mean value theorem a point differs from the path's by J e, with J at some state
        between.
        """
        if segment.spread is None:
            return over
        state, columns = segment.spread.at(middle)
        ranges = self.positions(segment.at(middle + SIGNS * over.half))
        known = replace(over, ranges=tuple(map(tuple, ranges)))
        return self._with_columns(known, state, columns, segment.at(middle))

    def instant(self, states: Zonotope) -> Slice:
        """Positions at an instant at which the states are known."""
        hull = states.hull()
        none = arb(0)
        points = tuple(tuple((x, none, none) for x in point) for point in self.positions(hull))
        over = Slice(none, none, points)
        if not states.columns.size:
            return over
        return self._with_columns(over, states.middle, states.matrix, hull)

    def _with_columns(
        self, over: Slice, state: Sequence[arb], columns: arb_mat, hull: Sequence[arb]
    ) -> Slice:
        if self.slopes is None:
            return over
        n, d = self.field.dofs, self.dimension
        flat = self.slopes.evaluate([*hull[:n], *self.field.tail], BALLS)
        if not all(item.is_finite() for item in flat):
            return over
        height = len(flat) // n
        slopes = arb_mat([[flat[j * height + i] for j in range(n)] for i in range(height)])
        moved = (slopes * rows(columns, 0, n)).tolist()
        path = tuple(map(tuple, self.positions(state)))
        parts = tuple(arb_mat(moved[i : i + d]) for i in range(0, height, d))
        return replace(over, path=path, columns=parts)

    def _series(self, q: list[list[arb]], length: int, first: int = 0) -> list[list[arb]]:
        """The coefficients of all coordinates of points, from ``first`` up to ``length``."""
        if self.field.machine is not None:
            return self.field.machine.series_of(self.tape, q, length, first)
        ctx.cap = length
        tail = [arb_series([item]) for item in self.field.tail]
        found = self.tape.evaluate([*(arb_series(item) for item in q), *tail], SERIES)
        return [[series[i] for i in range(first, length)] for series in found]


def _product(normal: Sequence[arb], place: Sequence[arb]) -> arb:
    return sum((a * x for a, x in zip(normal, place, strict=True)), arb(0))
