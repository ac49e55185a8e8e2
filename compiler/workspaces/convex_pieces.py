"""Polygons with holes as few convex pieces: one cut at every reflex corner, or one for two.

Sources: Chazelle & Dobkin, *Optimal convex decompositions* (1985): every reflex corner needs a cut,
and a cut serves at most two; Hertel & Mehlhorn, *Fast triangulation of simple polygons* (1983).
Shortest cuts go first, so that the pieces are fat.  Floats choose, integers decide.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from fractions import Fraction
from typing import NamedTuple

import numpy as np

from compiler.arrays import Array
from compiler.workspaces.hull import primitive
from compiler.workspaces.overlaps import candidates, interiors_meet
from compiler.workspaces.partition import glue
from compiler.workspaces.plane_boundary import (
    Direction,
    Edge,
    Ray,
    boundary,
    cross,
    direction,
    divided,
    following,
    line,
    orientation,
    outgoing,
    places,
    polygon,
    traced,
)
from compiler.workspaces.polytope import Polytope

NEAREST = 12
"""The number of nearest partners of a reflex corner that are tried for a common cut."""
FUZZY = 1e-9


class Corner(NamedTuple):
    """A reflex corner, with the directions of its incoming and outgoing edges."""

    at: Ray
    arriving: Direction
    leaving: Direction

    def heals(self, way: Direction) -> bool:
        """Whether a cut in this direction leaves no reflex angle."""
        return cross(self.arriving, way) >= 0 and cross(self.leaving, way) >= 0


class _Walls:
    """The edges and cuts so far, exactly and in floats, and the points of each where others end."""

    def __init__(self, edges: Sequence[Edge]) -> None:
        self.edges = list(edges)
        self.stops: list[list[Ray]] = [[] for _ in edges]
        self._ends = np.zeros((2 * len(edges) + 16, 2, 2))
        for i in (0, 1):
            self._ends[: len(edges), i] = places([edge[i] for edge in edges])

    @property
    def ends(self) -> Array:
        """Both ends of every wall, shape (n, 2, 2)."""
        return self._ends[: len(self.edges)]

    def add(self, cut: Edge) -> None:
        """Add a cut as a wall for later cuts."""
        if len(self.edges) == len(self._ends):
            self._ends = np.concatenate([self._ends, np.zeros_like(self._ends)])
        self._ends[len(self.edges)] = places(cut)
        self.edges.append(cut)
        self.stops.append([])

    def blocks(self, cut: Edge) -> bool:
        """Whether a cut meets any wall except at its own ends, where it runs between the edges."""
        start, end = places(cut)
        first, last = self.ends[:, 0], self.ends[:, 1]
        # If squares overflow, nothing counts as certainly apart.
        with np.errstate(over="ignore", invalid="ignore"):
            along, sides = _turns(start, end, first), _turns(start, end, last)
            ahead, behind = _turns(first, last, start), _turns(first, last, end)
            slack = FUZZY * (1 + np.abs(self.ends).max() ** 2)
            apart = (np.minimum(along, sides) > slack) | (np.maximum(along, sides) < -slack)
            apart |= (np.minimum(ahead, behind) > slack) | (np.maximum(ahead, behind) < -slack)
        return any(_meet(cut, self.edges[k]) for k in np.flatnonzero(~apart))

    def hit(self, corner: Corner, way: Direction) -> tuple[Ray, int]:
        """The point where a ray from a corner first meets a wall, and the number of that wall."""
        beam = line(corner.at, (*_ahead(corner.at, way), corner.at[2]))
        best: tuple[Fraction, Ray, int] | None = None
        for k in self._before(corner.at, way):
            point = _crossing(beam, self.edges[k])
            if point is None:
                continue
            gap = direction(corner.at, point)
            dot = gap[0] * way[0] + gap[1] * way[1]
            if dot <= 0:
                continue
            distance = Fraction(dot, point[2])
            if best is None or distance < best[0]:
                best = distance, point, k
        if best is None:
            raise AssertionError("a ray into a bounded polygon meets its boundary")
        return best[1:]

    def _before(self, at: Ray, way: Direction) -> Iterator[int]:
        """The walls that a ray may meet first."""
        origin = places([at])[0]
        heading = np.array(way, dtype=float)
        heading /= np.linalg.norm(heading)
        first, last = self.ends[:, 0] - origin, self.ends[:, 1] - origin
        left = heading[0] * first[:, 1] - heading[1] * first[:, 0]
        right = heading[0] * last[:, 1] - heading[1] * last[:, 0]
        slack = FUZZY * (1 + float(np.abs(self.ends).max()))
        near = np.flatnonzero(
            (np.minimum(left, right) <= slack) & (np.maximum(left, right) >= -slack)
        )
        far = np.maximum(first[near] @ heading, last[near] @ heading)
        yield from map(int, near[far > -slack])


def _ahead(at: Ray, way: Direction) -> tuple[int, int]:
    return at[0] + at[2] * way[0], at[1] + at[2] * way[1]


def _turns(a: Array, b: Array, c: Array) -> Array:
    gap, other = b - a, c - a
    return gap[..., 0] * other[..., 1] - gap[..., 1] * other[..., 0]


def _meet(cut: Edge, wall: Edge) -> bool:
    """Whether two closed segments meet; a common end does not count."""
    if set(cut) & set(wall):
        return False
    (a, b), (c, d) = cut, wall
    first, second = orientation(a, b, c), orientation(a, b, d)
    if (first > 0 and second > 0) or (first < 0 and second < 0):
        return False
    third, fourth = orientation(c, d, a), orientation(c, d, b)
    if (third > 0 and fourth > 0) or (third < 0 and fourth < 0):
        return False
    return bool(first or second) or _overlap(cut, wall)


def _overlap(cut: Edge, wall: Edge) -> bool:
    """Whether two collinear segments have a common point."""
    (a, b), (c, d) = (sorted(tuple(Fraction(x, p[2]) for x in p) for p in s) for s in (cut, wall))
    return a <= d and c <= b


def _crossing(beam: Ray, wall: Edge) -> Ray | None:
    """The point of a wall on a line; None if there is none, or more than one."""
    first, second = (sum(a * x for a, x in zip(beam, end, strict=True)) for end in wall)
    if not first:
        return wall[0] if second else None
    if not second:
        return wall[1]
    if (first > 0) == (second > 0):
        return None
    point = line(beam, line(*wall))
    return primitive(point if point[2] > 0 else tuple(-x for x in point))


def convex_pieces(pieces: Sequence[Polytope]) -> tuple[Polytope, ...]:
    """Divide a union of interior-disjoint polygons anew into convex ones.

    If all sides are along the axes, the pieces are boxes.
    """
    edges = boundary(pieces)
    walls = _Walls(edges)
    rest = _heal_in_pairs(walls, _reflex(edges), square=all(_on_axis(*edge) for edge in edges))
    for corner in rest:
        _heal(walls, corner)
    parts: list[Edge] = []
    for number, (edge, stops) in enumerate(zip(walls.edges, walls.stops, strict=True)):
        forward = divided(edge, stops)
        parts += forward
        if number >= len(edges):
            parts += [(end, start) for start, end in forward]
    found = [polygon(cycle) for cycle in traced(parts)]
    whole = tuple(piece for piece in found if piece is not None)
    if sum(p.volume for p in whole) != sum(p.volume for p in pieces) or len(whole) != len(found):
        raise AssertionError("the pieces between the cuts are convex and cover what was there")
    return whole


def _reflex(edges: Sequence[Edge]) -> list[Corner]:
    around = outgoing(edges)
    found = []
    for edge in edges:
        after = following(edge, around)
        arriving, leaving = direction(*edge), direction(*after)
        if cross(arriving, leaving) < 0:
            found.append(Corner(edge[1], arriving, leaving))
    return sorted(found, key=lambda c: tuple(Fraction(x, c.at[2]) for x in c.at[:2]))


def _on_axis(start: Ray, end: Ray) -> bool:
    return 0 in direction(start, end)


def _heal_in_pairs(walls: _Walls, corners: Sequence[Corner], *, square: bool) -> list[Corner]:
    """Cut between pairs of reflex corners that see each other and then need no other cut.

    If ``square``, the cuts are along the axes.

    Returns:
        The other corners.
    """
    healed: set[int] = set()
    for i, j in _partners(corners):
        if i in healed or j in healed or (square and not _on_axis(corners[i].at, corners[j].at)):
            continue
        first, second = corners[i], corners[j]
        way = direction(first.at, second.at)
        if not first.heals(way) or not second.heals((-way[0], -way[1])):
            continue
        if not walls.blocks((first.at, second.at)):
            walls.add((first.at, second.at))
            healed |= {i, j}
    return [corner for number, corner in enumerate(corners) if number not in healed]


def _partners(corners: Sequence[Corner]) -> list[tuple[int, int]]:
    """Pairs i < j of corners that may share a cut, nearest first."""
    if not corners:
        return []
    at = places([corner.at for corner in corners])
    arriving = np.array([_unit(corner.arriving) for corner in corners])
    leaving = np.array([_unit(corner.leaving) for corner in corners])
    gap = at[None] - at[:, None]
    length = np.hypot(gap[..., 0], gap[..., 1])
    sees = length > 0
    for way in (arriving, leaving):
        sees &= way[:, None, 0] * gap[..., 1] - way[:, None, 1] * gap[..., 0] >= -FUZZY
    length[~(sees & sees.T)] = np.inf
    order = np.argsort(length, axis=1, kind="stable")[:, :NEAREST]
    pairs = {
        (min(i, int(j)), max(i, int(j)))
        for i, row in enumerate(order)
        for j in row
        if np.isfinite(length[i, j])
    }
    return sorted(pairs, key=lambda pair: (length[pair], pair))


def _unit(way: Direction) -> tuple[float, float]:
    scale = max(map(abs, way))
    x, y = way[0] / scale, way[1] / scale
    norm = (x * x + y * y) ** 0.5
    return x / norm, y / norm


def _heal(walls: _Walls, corner: Corner) -> None:
    """Cut from a reflex corner along the extension of one of its edges, whichever is shorter."""
    options: list[tuple[float, int, Ray, int]] = []
    for way in (corner.arriving, (-corner.leaving[0], -corner.leaving[1])):
        point, wall = walls.hit(corner, way)
        reach = places([corner.at, point])
        options.append((float(np.hypot(*(reach[1] - reach[0]))), len(options), point, wall))
    _, _, point, wall = min(options)
    if point not in walls.edges[wall]:
        walls.stops[wall].append(point)
    walls.add((corner.at, point))


# --- Few large convex pieces with the same union --------------------------------------------------


def coarsened(pieces: Sequence[Polytope]) -> tuple[Polytope, ...]:
    """Few convex pieces with the same union.

    Pieces with a convex union are glued.  In the plane the union is also divided anew, by cuts at
    its reflex corners, independently of the old pieces.  The new division is used if it has no more
    pieces; for boxes, only if it has fewer.
    """
    glued = glue(pieces)
    if len(glued) < 3 or glued[0].dimension != 2:
        return glued  # two pieces that cannot be glued have no convex union
    afresh = glue(convex_pieces(glued))
    boxes = all(0 in row.normal for piece in glued for row in piece.rows)
    if len(afresh) + boxes > len(glued):
        return glued
    if not is_division(afresh, glued):
        raise AssertionError("pieces made afresh have the union of those before")
    return afresh


def is_division(parts: Sequence[Polytope], wholes: Sequence[Polytope]) -> bool:
    """Whether polygons are interior-disjoint and have the same union as others that are; exact.

    Proofs rely on cells, so this check shares nothing with the construction of the parts.
    """
    covered = Fraction(0)
    for i, j in candidates((*parts, *wholes)):
        if j < len(parts):
            if interiors_meet(parts[i], parts[j]):
                return False
        elif i < len(parts):
            covered += parts[i].intersection(wholes[j - len(parts)]).volume
    return covered == sum(part.volume for part in parts) == sum(whole.volume for whole in wholes)
