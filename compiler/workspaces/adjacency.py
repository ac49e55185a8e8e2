"""Which cells of a partition share a facet, and which ones touch at all; exact.

Source: Section 3, the adjacency matrix N.  Two cells are neighbours iff their intersection has
dimension d - 1; a common corner (or, in space, a common edge) is contact, not adjacency.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from typing import TypeAlias

import numpy as np

from compiler.arrays import Array
from compiler.time_limits.time_limit import check_time
from compiler.workspaces.hull import IntRow, Point, Vertex, clip, value
from compiler.workspaces.overlaps import Pair
from compiler.workspaces.polytope import Polytope

Boxes: TypeAlias = Array


def shared_facets(cells: Sequence[Polytope]) -> dict[Pair, tuple[Point, ...]]:
    """The corners of the common facet of each pair of neighbours i < j, in order of the pairs.

    The cells must be bounded, full-dimensional, irredundant and pairwise interior-disjoint; then a
    common facet lies in one hyperplane that bounds both, from its two sides.
    """
    walls: dict[IntRow, tuple[list[Pair], list[Pair]]] = {}
    for number, cell in enumerate(cells):
        for row in cell.facets:
            plane, side = _oriented(cell.integer_rows[row])
            walls.setdefault(plane, ([], []))[side].append((number, row))
    found: dict[Pair, tuple[Point, ...]] = {}
    for left, right in walls.values():
        for (i, row), (j, _) in _near(cells, left, right):
            check_time()
            corners: Sequence[Vertex] = cells[i].face(row)
            for bit, other in enumerate(cells[j].integer_rows, start=len(cells[i].rows)):
                corners = clip(corners, other, bit)
            if len(corners) >= cells[i].dimension:
                points = tuple(sorted(corner.point() for corner in corners))
                found[min(i, j), max(i, j)] = points
    return dict(sorted(found.items()))


def touching(cells: Sequence[Polytope]) -> tuple[Pair, ...]:
    """The pairs i < j of closed cells that have a common point, sorted.

    The cells must be bounded, full-dimensional and pairwise interior-disjoint.  Then two polygons
    meet iff a corner of one is in the other; in space two edges may also cross.
    """
    boxes = np.array([cell.box for cell in cells])
    rays = [frozenset(vertex.ray for vertex in cell.description.vertices) for cell in cells]
    return tuple(
        (i, j)
        for i, j in sorted(_close(boxes))
        if not rays[i].isdisjoint(rays[j])
        or _holds_one(cells[i], rays[j])
        or _holds_one(cells[j], rays[i])
        or (cells[i].dimension > 2 and cells[i].meets(cells[j]))
    )


def _holds_one(cell: Polytope, rays: Iterable[IntRow]) -> bool:
    """Whether one of these points is in the cell."""
    return any(all(value(row, ray) <= 0 for row in cell.integer_rows) for ray in rays)


def _oriented(row: IntRow) -> tuple[IntRow, int]:
    """The row with its first non-zero entry positive, and 1 if its sign was changed."""
    leading = next(entry for entry in row if entry)
    return (row, 0) if leading > 0 else (tuple(-entry for entry in row), 1)


def _near(
    cells: Sequence[Polytope], left: Sequence[Pair], right: Sequence[Pair]
) -> Iterator[tuple[Pair, Pair]]:
    """The pairs of facets on the two sides of one hyperplane whose cells have overlapping boxes."""
    if left and right:
        first, second = (np.array([cells[i].box for i, _ in side]) for side in (left, right))
        for a, b in _overlapping(first, second):
            yield left[a], right[b]


def _overlapping(first: Boxes, second: Boxes) -> Iterator[Pair]:
    """Index pairs of closed boxes that meet; shapes (n, 2, d) and (m, 2, d)."""
    for i, (lower, upper) in enumerate(first):
        meets = (second[:, 0] <= upper).all(axis=1) & (second[:, 1] >= lower).all(axis=1)
        for j in np.flatnonzero(meets):
            yield i, int(j)


def _close(boxes: Boxes) -> Iterator[Pair]:
    """The pairs i < j of closed boxes, shape (n, 2, d), that meet: a sweep along the first axis."""
    order = np.argsort(boxes[:, 0, 0], kind="stable")
    lower, upper = boxes[order, 0], boxes[order, 1]
    ends = np.searchsorted(lower[:, 0], upper[:, 0], side="right")
    for start, end in enumerate(ends):
        rest = slice(start + 1, end)
        meets = (lower[rest, 1:] <= upper[start, 1:]).all(axis=1)
        meets &= (upper[rest, 1:] >= lower[start, 1:]).all(axis=1)
        for other in order[rest][meets]:
            yield min(int(order[start]), int(other)), max(int(order[start]), int(other))
