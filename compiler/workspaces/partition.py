"""Cutting a convex polytope along the facets of another, and gluing pieces back together.

Sources: Bemporad, Morari, Dua & Pistikopoulos, *The explicit linear quadratic regulator for
constrained systems* (2002), Theorem 3 (the remainder of a polytope as convex pieces); Bemporad,
Fukuda & Torrisi, *Convexity recognition of the union of polyhedra* (2001).
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence

from compiler.workspaces.double_description import value
from compiler.workspaces.overlaps import interiors_meet
from compiler.workspaces.polytope import Polytope


def divide(cell: Polytope, region: Polytope) -> tuple[tuple[Polytope, ...], Polytope | None]:
    """``cell`` minus ``region`` as interior-disjoint convex pieces, and their intersection.

    Both are bounded and have an interior.  Only facets of the region that cut what is left of the
    cell make a piece; the one that cuts off most goes first, which keeps the pieces few and large.

    Returns:
        The remainders, and the common part, or None where the interiors do not meet (then the only
        remainder is the cell itself, and the region's facets cut nothing).
    """
    cell, region = cell.irredundant(), region.irredundant()
    if not interiors_meet(cell, region):
        return (cell,), None
    remainders: list[Polytope] = []
    rest, pending = cell, list(region.rows)
    while True:
        cuts = [(row, inside, outside) for row in pending
                for inside, outside in (rest.halves(row),)
                if inside is not None and outside is not None]  # fmt: skip
        if not cuts:
            return tuple(remainders), rest
        best, rest, outer = max(cuts, key=lambda cut: cut[2].volume)
        remainders.append(outer)
        pending = [row for row, _, _ in cuts if row is not best]


def remainder(cell: Polytope, regions: Sequence[Polytope]) -> tuple[Polytope, ...]:
    """``cell`` minus the union of ``regions``: pieces with interior; none if the union covers it.

    All are bounded and have an interior.  As the cell is the closure of its interior, no piece
    left means that every point of the cell is in one of the (closed) regions.
    """
    pieces: tuple[Polytope, ...] = (cell,)
    for region in regions:
        pieces = tuple(part for piece in pieces for part in divide(piece, region)[0])
    return pieces


def glue(pieces: Sequence[Polytope]) -> tuple[Polytope, ...]:
    """Merge interior-disjoint irredundant pieces while two of them have a convex union.

    Greedy, in the order given; the union of all pieces stays the same.
    """
    alive: dict[int, Polytope] = dict(enumerate(pieces))
    sides: dict[frozenset[tuple[int, ...]], list[int]] = {}
    for number, piece in alive.items():
        _enter(sides, number, piece)
    waiting = deque(alive)
    following = len(pieces)
    while waiting:
        number = waiting.popleft()
        if number not in alive:
            continue
        found = _mergeable(number, alive, sides)
        if found is not None:
            partner, union = found
            del alive[number], alive[partner]
            alive[following] = union
            _enter(sides, following, union)
            waiting.append(following)
            following += 1
    return tuple(alive.values())


def _corners(piece: Polytope, row: int) -> frozenset[tuple[int, ...]]:
    return frozenset(vertex.ray for vertex in piece.face(row))


def _enter(
    sides: dict[frozenset[tuple[int, ...]], list[int]], number: int, piece: Polytope
) -> None:
    for row in piece.facets:
        sides.setdefault(_corners(piece, row), []).append(number)


def _mergeable(
    number: int, alive: dict[int, Polytope], sides: dict[frozenset[tuple[int, ...]], list[int]]
) -> tuple[int, Polytope] | None:
    """A living piece that shares a whole facet with this one and has a convex union with it."""
    piece = alive[number]
    for row in piece.facets:
        corners = _corners(piece, row)
        for partner in sides[corners]:
            if partner != number and partner in alive:
                union = _convex_union(piece, alive[partner], corners)
                if union is not None:
                    return partner, union
    return None


def _convex_union(
    first: Polytope, second: Polytope, corners: frozenset[tuple[int, ...]]
) -> Polytope | None:
    """The union of two polytopes on either side of a common facet, if it is convex.

    It is iff every other facet of each holds on the other: near the middle of such a facet the
    union is one of the two, so its half-space holds on a convex union; and conversely a point where
    all of them hold is in the polytope of its side.
    """
    rows = []
    for piece, other in ((first, second), (second, first)):
        for i in piece.facets:
            if _corners(piece, i) == corners:
                continue
            row = piece.integer_rows[i]
            if any(value(row, vertex.ray) > 0 for vertex in other.description.vertices):
                return None
            rows.append(piece.rows[i])
    return Polytope(tuple(rows)).irredundant()
