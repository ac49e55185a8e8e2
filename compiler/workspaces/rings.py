"""Rings of polygons: whether they are simple, and whether those of one polygon cross.

Bounding boxes and sides in floats select the pairs of edges to examine, with a margin for rounding
so that none is missed.  Everything else is exact, in integers.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from math import lcm
from typing import TYPE_CHECKING, Literal, TypeAlias

from compiler.workspaces.hull import turn
from compiler.workspaces.pieces import Corner

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from compiler.arrays import Array


Place: TypeAlias = tuple[int, int]
"""A point in units of a common denominator."""
Edge: TypeAlias = tuple[Place, Place]
Contact: TypeAlias = Literal["point", "more"] | None

SIDE_BY_SIDE = 2 * 10**6
"""The most pairs of edges that may be side by side; outlines of real things have a hundredth."""
EXACT_LIMIT = SIDE_BY_SIDE // 10
"""The most pairs too close to each other for floats: neighbours, and few others."""
_ROUNDED = 2.0**-48


class BadRing(Exception):
    """A ring that is not an outline; ``ring`` counts from 0, ``where`` is a point of it."""

    def __init__(self, message: str, ring: int, where: Corner | None = None) -> None:
        at = "" if where is None else f" at ({float(where[0]):g}, {float(where[1]):g})"
        super().__init__(f"{message}{at}")
        self.message = f"{message}{at}"
        self.ring = ring


class TooTangled(Exception):
    """A polygon with so many edges side by side that cutting it would take minutes."""


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
    """The rings of one polygon, without repeated positions.

    Args:
        rings: each closed, its last position the first.

    Raises:
        BadRing: a ring is not closed, has no area, meets itself, or meets another in more than
            points.
        TooTangled: more than ``SIDE_BY_SIDE`` pairs of edges are near each other.
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
    for count, (i, j) in enumerate(_near(edges)):
        if count == EXACT_LIMIT:
            raise TooTangled
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


def _near(edges: Sequence[Edge]) -> Iterator[tuple[int, int]]:
    """The pairs i < j of edges that may have a common point.

    Coordinates are measured from the lower left corner, in units of the extent.  They are between 0
    and 1, and rounding moves them by less than 2^-53 and keeps their order: boxes that meet still
    do so.  A side is the difference of two products of differences, all of them at most 1, so its
    error is less than 2^-48.
    """
    import numpy as np

    corners = [corner for edge in edges for corner in edge]
    left, lower = (min(corner[axis] for corner in corners) for axis in (0, 1))
    extent = max(max(x - left, y - lower) for x, y in corners)
    ends = np.array(
        [[((x - left) / extent, (y - lower) / extent) for x, y in edge] for edge in edges]
    )
    low, high = ends.min(axis=1), ends.max(axis=1)
    pairs = 0
    for i in range(len(edges) - 1):
        rest = slice(i + 1, None)
        apart = (low[rest] > high[i]).any(axis=1) | (high[rest] < low[i]).any(axis=1)
        near = i + 1 + np.flatnonzero(~apart)
        pairs += len(near)
        if pairs > SIDE_BY_SIDE:
            raise TooTangled
        others = ends[near]
        one, other = _sides(ends[i], others), _sides(others, ends[i])
        for j in near[~(_aside(one) | _aside(other))]:
            yield i, int(j)


def _sides(lines: Array, points: Array) -> Array:
    """The sides of lines on which both ends of edges are; shapes (…, 2, 2), result (…, 2)."""
    start, along = lines[..., :1, :], lines[..., 1:, :] - lines[..., :1, :]
    away = points - start
    sides: Array = along[..., 0] * away[..., 1] - along[..., 1] * away[..., 0]
    return sides


def _aside(sides: Array) -> NDArray[np.bool_]:
    """Whether both ends are certainly on one side."""
    import numpy as np

    found: NDArray[np.bool_] = np.logical_or(
        np.all(sides > _ROUNDED, axis=-1), np.all(sides < -_ROUNDED, axis=-1)
    )
    return found


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
    """How two edges on one line meet."""
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
