"""The convex pieces of a map, before they become regions."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from compiler.workspaces.hull import turn
from compiler.workspaces.polytope import Polytope

Corner: TypeAlias = tuple[Fraction, Fraction]
Polygon: TypeAlias = tuple[Corner, ...]
"""The corners of a polygon (m), counter-clockwise, no three consecutive ones collinear."""


@dataclass(frozen=True, slots=True)
class Pieces:
    """Convex polygons or polytopes whose union contains all obstacles of a map.

    ``origin`` says in words what they were made from.  None of their points is farther than
    ``inflation`` metres from an obstacle.  ``extent`` is the area that the map covers, if it is
    bounded.

    A mesh has ``polytopes`` instead of polygons: one for each object, irredundant and containing
    it.
    """

    polygons: tuple[Polygon, ...]
    origin: str
    inflation: Fraction = Fraction(0)
    extent: Polygon | None = None
    polytopes: tuple[Polytope, ...] = ()

    @property
    def count(self) -> int:
        """The number of pieces."""
        return len(self.polytopes) or len(self.polygons)


def area(polygon: Sequence[Corner]) -> Fraction:
    """The signed area of a simple polygon (m^2), positive if counter-clockwise."""
    twice = sum(
        (a[0] * b[1] - a[1] * b[0] for a, b in zip(polygon, _shifted(polygon), strict=True)),
        Fraction(0),
    )
    return twice / 2


def _shifted(polygon: Sequence[Corner]) -> Sequence[Corner]:
    return (*polygon[1:], polygon[0])


def sides(polygon: Sequence[Corner]) -> list[tuple[Corner, Corner]]:
    """The directed edges of a polygon."""
    return list(zip(polygon, _shifted(polygon), strict=True))


def apart(first: Polygon, second: Polygon) -> bool:
    """Whether the interiors of two convex polygons are disjoint (touching is allowed).

    Two convex polygons with disjoint interiors are separated along an edge of one of them.
    """
    return _separates(first, second) or _separates(second, first)


def disjoint(first: Polygon, second: Polygon) -> bool:
    """Whether two closed convex polygons are disjoint; as above, with strict separation."""
    return _parts(first, second) or _parts(second, first)


def _separates(first: Polygon, second: Polygon) -> bool:
    return any(all(turn(a, b, corner) <= 0 for corner in second) for a, b in sides(first))


def _parts(first: Polygon, second: Polygon) -> bool:
    return any(all(turn(a, b, corner) < 0 for corner in second) for a, b in sides(first))
