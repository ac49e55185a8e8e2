"""Rings of polygons: whether they are simple, and whether those of one polygon cross.

Bounding boxes in floats choose the pairs of edges that are looked at; rounding is monotone, so that
none is missed.  Everything else is exact, in integers.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import lcm
from typing import Literal, TypeAlias

from compiler.maps.pieces import Corner

Place: TypeAlias = tuple[int, int]
"""A point in units of a common denominator."""
Edge: TypeAlias = tuple[Place, Place]
Contact: TypeAlias = Literal["point", "more"] | None


class BadRing(Exception):
    """A ring that is no outline; ``ring`` counts from 0, ``where`` is a point of it."""

    def __init__(self, message: str, ring: int, where: Corner | None = None) -> None:
        at = "" if where is None else f" at ({float(where[0]):g}, {float(where[1]):g})"
        super().__init__(f"{message}{at}")
        self.message = f"{message}{at}"
        self.ring = ring


def turn(a: Place, b: Place, c: Place) -> int:
    """Twice the signed area of a triangle: positive where a, b, c turns to the left."""
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])


@dataclass(frozen=True, slots=True)
class Rings:
    """Simple rings that do not cross, closed implicitly, in units of ``1 / scale`` metres."""

    rings: tuple[tuple[Place, ...], ...]
    scale: int

    @property
    def edges(self) -> Iterator[Edge]:
        """All edges, ring by ring."""
        return (edge for ring in self.rings for edge in pairwise((*ring, ring[0])))


def sound_rings(rings: Sequence[Sequence[Corner]]) -> Rings:
    """The rings of one polygon, repeated positions left out.

    Args:
        rings: each closed, its last position the first.

    Raises:
        BadRing: one is not closed, has no area, meets itself, or meets another in more than points.
    """
    scale = lcm(*(x.denominator for ring in rings for corner in ring for x in corner))
    found: list[tuple[Place, ...]] = []
    for number, ring in enumerate(rings):
        if len(ring) < 4:
            raise BadRing("a ring has at least four positions", number)
        if ring[0] != ring[-1]:
            raise BadRing("a ring is not closed: its last position is not its first", number)
        places = [(int(x * scale), int(y * scale)) for x, y in ring]
        ring_of = tuple(b for a, b in pairwise(places) if a != b)
        if not any(turn(ring_of[0], ring_of[1], place) for place in ring_of[2:]):
            raise BadRing("a ring has no area", number)
        found.append(ring_of)
    made = Rings(tuple(found), scale)
    _check_contacts(made)
    return made


def _check_contacts(made: Rings) -> None:
    edges = list(made.edges)
    owner = [number for number, ring in enumerate(made.rings) for _ in ring]
    following = list(range(1, len(edges) + 1))
    start = 0
    for ring in made.rings:
        following[start + len(ring) - 1] = start
        start += len(ring)
    for i, j in _near(edges, made.scale):
        first, second = edges[i], edges[j]
        kind = _contact(first, second)
        same = owner[i] == owner[j]
        if kind is None or (kind == "point" and not same):
            continue
        if kind == "point" and (following[i] == j or following[j] == i):
            continue
        message = "a ring meets itself" if same else "a ring crosses another one"
        x, y = _common(first, second)
        raise BadRing(message, owner[j], (x / made.scale, y / made.scale))


def _near(edges: Sequence[Edge], scale: int) -> Iterator[tuple[int, int]]:
    """The pairs i < j of edges whose bounding boxes, rounded, have a common point.

    Rounding keeps the order, so that boxes which meet do so after it; the quotients are no larger
    than the coordinates of the file, of which doubles hold all that may be written.
    """
    import numpy as np

    ends = np.array([[[x / scale for x in place] for place in edge] for edge in edges])
    low, high = ends.min(axis=1), ends.max(axis=1)
    for i in range(len(edges) - 1):
        rest = slice(i + 1, None)
        apart = (low[rest] > high[i]).any(axis=1) | (high[rest] < low[i]).any(axis=1)
        for j in np.flatnonzero(~apart):
            yield i, i + 1 + int(j)


def _contact(first: Edge, second: Edge) -> Contact:
    """How two edges meet: not, in one point that is an end of one, or in more than that."""
    (a, b), (c, d) = first, second
    sides = turn(a, b, c), turn(a, b, d), turn(c, d, a), turn(c, d, b)
    if not any(sides):
        return _overlap(first, second)
    if sides[0] * sides[1] > 0 or sides[2] * sides[3] > 0:
        return None
    return "point" if 0 in sides else "more"


def _overlap(first: Edge, second: Edge) -> Contact:
    """Of two edges on one line."""
    start = max(min(first), min(second))
    end = min(max(first), max(second))
    if start > end:
        return None
    return "point" if start == end else "more"


def _common(first: Edge, second: Edge) -> Corner:
    """A common point of two edges that meet."""
    from fractions import Fraction

    (a, b), (c, d) = first, second
    down = turn(c, d, a) - turn(c, d, b)
    if not down:
        x, y = max(min(first), min(second))
        return Fraction(x), Fraction(y)
    part = Fraction(turn(c, d, a), down)
    return a[0] + part * (b[0] - a[0]), a[1] + part * (b[1] - a[1])
