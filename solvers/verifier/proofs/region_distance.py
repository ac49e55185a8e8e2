"""Proved bounds of how deep in a region, or how far from it, a moving point is over a time slice.

Inside, the distance to the complement is the distance to the nearest facet. Outside, every
direction gives a lower bound of the distance. The directions tried are those of the facets and the
one from the nearest point on an edge of the region.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations, pairwise
from math import inf, isnan

from flint import arb

from compiler.expressions.evaluators.balls import ball, below
from compiler.workspaces.polytope import Polytope
from solvers.verifier.proofs.point_map import Slice
from solvers.verifier.proofs.tube_checks import Row, rows_of


@dataclass(frozen=True, slots=True)
class Gap:
    """Bounds in metres; the estimates guide a refinement and prove nothing.

    Throughout the slice the point is at least ``inside`` from the complement of the region and at
    least ``outside`` from the region; each is zero unless the point is certainly on that side. No
    smaller slice is likely to show more than ``most_inside`` and ``most_outside``.
    """

    inside: float
    outside: float
    most_inside: float
    most_outside: float

    def at_best(self, other: Gap) -> Gap:
        """The combination of two gaps of the same slice, or of one that contains it."""
        return Gap(
            max(self.inside, other.inside),
            max(self.outside, other.outside),
            min(self.most_inside, other.most_inside),
            min(self.most_outside, other.most_outside),
        )


UNKNOWN = Gap(0.0, 0.0, inf, inf)


@dataclass(frozen=True, slots=True)
class RegionDistance:
    """A convex region, in balls; ``edges`` are pairs of ``vertices``, both empty if unbounded."""

    polytope: Polytope
    rows: tuple[Row, ...]
    vertices: tuple[tuple[arb, ...], ...]
    edges: tuple[tuple[int, int], ...]

    def over(self, time: Slice, point: int) -> Gap:
        """The bounds for one of the points of a slice."""
        if self.polytope.is_empty:
            return Gap(0.0, inf, 0.0, inf)
        least, most = arb("inf"), inf
        for item in self.rows:
            over, middle = time.form(item.normal, point)
            depth = (item.offset - over) / item.length
            least, most = least.min(depth), min(most, _at_best(depth, middle / item.length))
        inside = max(0.0, below(least))
        if inside > 0:
            return Gap(inside, 0.0, most, 0.0)
        outside, most_outside = self._outside(time, point)
        return Gap(0.0, outside, max(0.0, most), most_outside)

    def _outside(self, time: Slice, point: int) -> tuple[float, float]:
        best, most = 0.0, 0.0
        for item in (*self.rows, *self._nearest(time, point)):
            over, middle = time.form(item.normal, point)
            beyond = (over - item.offset) / item.length
            best = max(best, below(beyond))
            most = max(most, _at_best(beyond, middle / item.length))
        return best, most

    def _nearest(self, time: Slice, point: int) -> list[Row]:
        """The half-space around the region whose normal points from it to the point."""
        place = [float(axis[0].mid()) for axis in time.points[point]]
        corners = [[float(x) for x in vertex] for vertex in self.vertices]
        away: list[float] | None = None
        for i, j in self.edges:
            gap = _from_edge(place, corners[i], corners[j])
            if away is None or _square(gap) < _square(away):
                away = gap
        if away is None or not 0 < _square(away) < inf:
            return []
        normal = tuple(arb(x) for x in away)
        support = arb("-inf")
        for vertex in self.vertices:
            support = support.max(sum((a * x for a, x in zip(normal, vertex, strict=True)), arb(0)))
        length = sum((a * a for a in normal), arb(0)).sqrt()
        return [Row(normal, support, length)]


def region_distance(polytope: Polytope) -> RegionDistance:
    """The distance to a region, in the working precision."""
    vertices = polytope.vertices if polytope.is_bounded else ()
    count = len(vertices)
    edges = tuple(combinations(range(count), 2)) or ((0, 0),) * count
    if polytope.dimension == 2 and count > 2:
        # In the plane the vertices are in order around the region.
        edges = (*pairwise(range(count)), (count - 1, 0))
    balls = tuple(tuple(ball(x) for x in vertex) for vertex in vertices)
    return RegionDistance(polytope, rows_of(polytope), balls, edges)


def _from_edge(p: Sequence[float], a: Sequence[float], b: Sequence[float]) -> list[float]:
    """The vector to p from the nearest point of the segment between a and b."""
    along = [y - x for x, y in zip(a, b, strict=True)]
    ahead = [y - x for x, y in zip(a, p, strict=True)]
    length = _square(along)
    share = sum(x * y for x, y in zip(along, ahead, strict=True)) / length if length else 0.0
    share = min(1.0, max(0.0, share))
    return [x - share * y for x, y in zip(ahead, along, strict=True)]


def _square(vector: Sequence[float]) -> float:
    return sum(x * x for x in vector)


def _at_best(over: arb, middle: arb) -> float:
    """The most that smaller slices may show: a wide tube is as wide in each of them."""
    most = float(over.upper() - 2 * middle.rad())
    return inf if isnan(most) else most
