"""Pairs of convex polytopes whose interiors meet: a sweep over bounding boxes, then exact tests.

Sources: Edelsbrunner & Maurer, *On the intersection of orthogonal objects* (1981), for the sweep;
Ericson, *Real-Time Collision Detection* (2005), section 5.2, for separation by facets.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import TypeAlias

from compiler.workspaces.hull import value
from compiler.workspaces.polytope import Polytope

Pair: TypeAlias = tuple[int, int]
"""The numbers of two polytopes, the lower one first."""


@dataclass(frozen=True, slots=True)
class _Box:
    """The bounding box of polytope ``number``: the ranks of its ends along each axis."""

    number: int
    lower: tuple[int, ...]
    upper: tuple[int, ...]


def candidates(shapes: Sequence[Polytope]) -> Iterator[Pair]:
    """The pairs (i, j), i < j, of bounded polytopes whose bounding boxes have interiors that meet.

    The sweep uses the axis along which the fewest boxes overlap.
    """
    boxes = _boxes(shapes)
    if not boxes:
        return
    dimension = shapes[0].dimension
    axis = min(range(dimension), key=lambda a: (_crowding(boxes, a), a))
    others = [a for a in range(dimension) if a != axis]
    active: list[_Box] = []
    for box in sorted(boxes, key=lambda b: b.lower[axis]):
        start = box.lower[axis]
        active = [other for other in active if other.upper[axis] > start]
        for other in active:
            if all(other.lower[a] < box.upper[a] and box.lower[a] < other.upper[a] for a in others):
                yield min(box.number, other.number), max(box.number, other.number)
        active.append(box)


def interiors_meet(first: Polytope, second: Polytope) -> bool:
    """Whether two bounded, full-dimensional, irredundant polytopes have a common interior point.

    Exact.  Two convex polygons with disjoint interiors are separated along an edge of one of them,
    and two boxes along a face.  For other polyhedra, the intersection decides if no facet separates
    them.
    """
    if _facet_separates(first, second) or _facet_separates(second, first):
        return False
    if first.dimension == 2 or (_is_box(first) and _is_box(second)):
        return True
    return not first.separated_interiors(second)


def _facet_separates(first: Polytope, second: Polytope) -> bool:
    rays = [vertex.ray for vertex in second.description.vertices]
    return any(all(value(row, ray) >= 0 for ray in rays) for row in first.integer_rows)


def _is_box(shape: Polytope) -> bool:
    return all(sum(map(bool, row.normal)) == 1 for row in shape.rows)


def _boxes(shapes: Sequence[Polytope]) -> list[_Box]:
    """The bounding boxes, with coordinates replaced by their ranks: exact, and fast to compare."""
    points = [[vertex.point() for vertex in shape.description.vertices] for shape in shapes]
    ends = [[(min(axis), max(axis)) for axis in zip(*corners, strict=True)] for corners in points]
    ranks = [
        {x: rank for rank, x in enumerate(sorted({x for pair in axis for x in pair}))}
        for axis in zip(*ends, strict=True)
    ]
    return [
        _Box(
            number,
            tuple(rank[low] for rank, (low, _) in zip(ranks, axes, strict=True)),
            tuple(rank[high] for rank, (_, high) in zip(ranks, axes, strict=True)),
        )
        for number, axes in enumerate(ends)
    ]


def _crowding(boxes: Sequence[_Box], axis: int) -> int:
    """The number of pairs whose intervals along an axis overlap."""
    starts = sorted(box.lower[axis] for box in boxes)
    ends = sorted(box.upper[axis] for box in boxes)
    total = closed = 0
    for opened, start in enumerate(starts):
        while ends[closed] <= start:
            closed += 1
        total += opened - closed
    return total
