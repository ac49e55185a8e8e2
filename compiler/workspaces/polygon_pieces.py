"""A polygon with holes as few convex pieces with disjoint interiors, exactly.

Sources: Bentley & Ottmann, *Algorithms for reporting and counting geometric intersections* (1979),
for the sweep, here without crossings; Chazelle & Dobkin, *Optimal convex decompositions* (1985):
with r reflex corners every decomposition has at least r / 2 + 1 pieces.  A reflex corner makes at
most two cuts, so there are at most 2 r + 1 pieces.  The cuts are vertical, or all horizontal if
that makes fewer pieces.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from itertools import groupby
from typing import TypeAlias

from compiler.workspaces.hull import turn
from compiler.workspaces.pieces import Corner, Polygon, area
from compiler.workspaces.rings import (
    SIDE_BY_SIDE,
    BadRing,
    Edge,
    Place,
    Rings,
    TooTangled,
    sound_rings,
)

Chain: TypeAlias = list[Corner]
Side: TypeAlias = tuple[Edge, Edge]
"""The lower and the upper edge of a piece."""


def polygon_pieces(rings: Sequence[Sequence[Corner]]) -> tuple[Polygon, ...]:
    """Convex pieces of a polygon, whose areas add up to its own.

    Args:
        rings: the outline, then the holes, each closed (its last position is its first).

    Raises:
        BadRing: a ring is not simple, or the rings do not form a polygon.
        TooTangled: too many edges are near each other, or one above another.
    """
    sound = sound_rings(rings)
    found = _decomposed(sound)
    sizes = [abs(area(ring)) for ring in rings]
    if sum(map(area, found)) != sizes[0] - sum(sizes[1:]):
        raise BadRing("a hole is not within the outline, or within another hole", 0)
    swapped = Rings(tuple(tuple((y, x) for x, y in ring) for ring in sound.rings), sound.scale)
    other = _decomposed(swapped)
    if len(other) < len(found):
        found = [tuple((x, y) for y, x in piece[::-1]) for piece in other]
    return tuple(found)


def _decomposed(rings: Rings) -> list[Polygon]:
    """The pieces made by vertical cuts, in metres."""
    sweep = _Sweep(rings.scale)
    for x, ending, beginning in _events(rings):
        sweep.pass_line(x, ending, beginning)
    return sweep.pieces


def _events(rings: Rings) -> Iterator[tuple[int, list[Edge], list[Edge]]]:
    """For each abscissa of corners, from the left: edges that end and that begin there."""
    ends: list[tuple[int, bool, Edge]] = []
    for a, b in rings.edges:
        if a[0] != b[0]:
            edge = min(a, b), max(a, b)
            ends += [(edge[0][0], True, edge), (edge[1][0], False, edge)]
    ends.sort()
    for x, group in groupby(ends, key=lambda end: end[0]):
        here = list(group)
        yield (
            x,
            [edge for _, begins, edge in here if not begins],
            [edge for _, begins, edge in here if begins],
        )


def _height(edge: Edge, x: int) -> Fraction:
    """The ordinate of an edge at an abscissa within it."""
    (a, b), (c, d) = edge
    return b + Fraction((x - a) * (d - b), c - a)


def _is_below(edge: Edge, point: Place) -> int:
    """Positive if a point lies above an edge, negative below, zero on its line."""
    (a, b), (c, d) = edge
    return (c - a) * (point[1] - b) - (d - b) * (point[0] - a)


@dataclass(slots=True)
class _Open:
    """A piece to the left of the sweep line: its lower and upper chains so far, from the left."""

    lower: Chain
    upper: Chain


@dataclass(slots=True)
class _Sweep:
    """The edges that cross the sweep line, from below, and the pieces between every second pair."""

    scale: int
    edges: list[Edge] = field(default_factory=list[Edge])
    opened: dict[Side, _Open] = field(default_factory=dict[Side, _Open])
    pieces: list[Polygon] = field(default_factory=list[Polygon])
    crossed: int = 0

    def pass_line(self, x: int, ending: Sequence[Edge], beginning: Sequence[Edge]) -> None:
        """Move past an abscissa: close pieces there, continue others, and open new ones."""
        if ending:
            gone = set(ending)
            self.edges = [edge for edge in self.edges if edge not in gone]
        for edge in beginning:
            self._insert(edge)
        self.crossed += len(self.edges)
        if self.crossed > SIDE_BY_SIDE:
            raise TooTangled
        now = dict.fromkeys(zip(self.edges[::2], self.edges[1::2], strict=True))
        closing = [side for side in self.opened if side not in now]
        left: dict[tuple[Corner, Corner], _Open] = {}
        for side in closing:
            piece = self.opened.pop(side)
            wall = self._wall(side, x)
            piece.lower.append(wall[0])
            piece.upper.append(wall[1])
            if wall[0] == wall[1]:
                self.pieces.append(_polygon(piece))
            else:
                left[wall] = piece
        for side in now:
            if side not in self.opened:
                wall = self._wall(side, x)
                self.opened[side] = self._begun(left, wall, side)
        self.pieces += [_polygon(piece) for piece in left.values()]

    def _insert(self, edge: Edge) -> None:
        """Insert an edge among those that cross the line at its left end."""
        low, high = 0, len(self.edges)
        while low < high:
            middle = (low + high) // 2
            other = self.edges[middle]
            above = _is_below(other, edge[0]) or _is_below(other, edge[1])
            if above > 0:
                low = middle + 1
            else:
                high = middle
        self.edges.insert(low, edge)

    def _wall(self, side: Side, x: int) -> tuple[Corner, Corner]:
        """The ends, in metres, of the vertical segment between two edges."""
        low, high = (Fraction(_height(edge, x), self.scale) for edge in side)
        across = Fraction(x, self.scale)
        return (across, low), (across, high)

    def _begun(
        self, left: dict[tuple[Corner, Corner], _Open], wall: tuple[Corner, Corner], side: Side
    ) -> _Open:
        """The piece that ends at this wall, if it stays convex when continued; else a new one."""
        found = left.get(wall)
        if found is not None:
            below, above = (self._metres(edge[1]) for edge in side)
            if (
                turn(found.lower[-2], wall[0], below) >= 0
                and turn(found.upper[-2], wall[1], above) <= 0
            ):
                return left.pop(wall)
        return _Open([wall[0]], [wall[1]])

    def _metres(self, place: Place) -> Corner:
        return Fraction(place[0], self.scale), Fraction(place[1], self.scale)


def _polygon(piece: _Open) -> Polygon:
    """The corners counter-clockwise, without repeated and collinear ones."""
    around = [*piece.lower, *piece.upper[::-1]]
    distinct = [b for a, b in zip(around[-1:] + around[:-1], around, strict=True) if a != b]
    before, after = distinct[-1:] + distinct[:-1], distinct[1:] + distinct[:1]
    return tuple(b for a, b, c in zip(before, distinct, after, strict=True) if turn(a, b, c) != 0)
