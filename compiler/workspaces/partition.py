"""Cut cells along facets, divide them in two, and glue them back together; exact."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

from compiler.workspaces.hull import IntRow, Point, around, integer_row, on_lattice, value
from compiler.workspaces.overlaps import Pair, interiors_meet
from compiler.workspaces.polytope import Polytope
from grammar_lang.ir import HalfSpace

# --- Cutting a convex polytope along the facets of another, and gluing pieces back together -------
#
# Sources: Bemporad, Morari, Dua & Pistikopoulos, *The explicit linear quadratic regulator for
# constrained systems* (2002), Theorem 3 (the remainder of a polytope as convex pieces); Bemporad,
# Fukuda & Torrisi, *Convexity recognition of the union of polyhedra* (2001).


def divide(cell: Polytope, region: Polytope) -> tuple[tuple[Polytope, ...], Polytope | None]:
    """``cell`` minus ``region`` as interior-disjoint convex pieces, and their intersection.

    Both must be bounded and full-dimensional.  Only facets of the region that cut the rest of the
    cell make a piece; the one that cuts off most goes first, which keeps the pieces few and large.

    Returns:
        The remainders, and the common part, which is None if the interiors do not meet.  Then the
            only
        remainder is the cell itself, and the region's facets cut nothing.
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
    """``cell`` minus the union of ``regions``: pieces with interior, or none if it is covered.

    All must be bounded and full-dimensional.  Since the cell is the closure of its interior, an
    empty result means that every point of the cell is in one of the (closed) regions.
    """
    pieces: tuple[Polytope, ...] = (cell,)
    for region in regions:
        pieces = tuple(part for piece in pieces for part in divide(piece, region)[0])
    return pieces


def glue(pieces: Sequence[Polytope]) -> tuple[Polytope, ...]:
    """Merge interior-disjoint irredundant pieces while two of them have a convex union.

    Greedy, in the given order; the union of all pieces stays the same.
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
    """A remaining piece that shares a whole facet with this one and has a convex union with it."""
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

    It is convex iff every other facet of each is valid for the other.  Near the middle of such a
    facet, the union is one of the two, so the facet's half-space is valid for a convex union.
    Conversely, a point in all these half-spaces is in the polytope on its side.
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


# --- Cutting cells of a partition in two, and updating the common facets; exact and local ---------
#
# Source: Clarke, Grumberg, Jha, Lu & Veith, *Counterexample-guided abstraction refinement* (2003):
# a cell that is too coarse is split, and the others stay.  Only the facets of a cell that is cut
# are recomputed.


@dataclass(frozen=True, slots=True)
class Cut:
    """Divide cell number ``cell`` by a hyperplane that meets its interior.

    The part in ``half_space`` keeps the number; the other part gets the next free number.
    """

    cell: int
    half_space: HalfSpace


@dataclass(frozen=True, slots=True)
class Pieces:
    """The polytopes after some cuts, their facets by pairs i < j, and the original cell of each."""

    polytopes: tuple[Polytope, ...]
    facets: Mapping[Pair, tuple[Point, ...]]
    origins: tuple[int, ...]


def split_cells(
    polytopes: Sequence[Polytope], facets: Mapping[Pair, tuple[Point, ...]], cuts: Iterable[Cut]
) -> Pieces:
    """Apply the cuts in turn to irredundant cells with interior and their common facets.

    Raises:
        ValueError: a cut names no cell, or misses the interior of its cell.
    """
    cells = list(polytopes)
    origins = list(range(len(cells)))
    beside: list[dict[int, tuple[Point, ...]]] = [{} for _ in cells]
    for (i, j), corners in facets.items():
        beside[i][j] = beside[j][i] = corners
    for cut in cuts:
        if not 0 <= cut.cell < len(cells):
            raise ValueError(f"there is no cell number {cut.cell} to cut")
        inside, outside = cells[cut.cell].halves(cut.half_space)
        if inside is None or outside is None:
            raise ValueError(f"a cut of cell number {cut.cell} misses its interior")
        cells[cut.cell] = inside
        cells.append(outside)
        origins.append(origins[cut.cell])
        beside.append({})
        _share_out(beside, cut)
        common = inside.face(len(inside.rows) - 1)
        wall = tuple(sorted(vertex.point() for vertex in common))
        beside[cut.cell][len(cells) - 1] = beside[-1][cut.cell] = wall
    found = {
        (i, j): corners for i, around in enumerate(beside) for j, corners in around.items() if i < j
    }
    return Pieces(tuple(cells), dict(sorted(found.items())), tuple(origins))


def _share_out(beside: list[dict[int, tuple[Point, ...]]], cut: Cut) -> None:
    """Distribute the facets of a cut cell to its two parts; the last cell is the outer one."""
    row = integer_row(cut.half_space.normal, cut.half_space.offset)
    first, second = cut.cell, len(beside) - 1
    around = beside[first]
    beside[first] = {}
    for other, corners in around.items():
        del beside[other][first]
        for part, share in zip((first, second), _sides(corners, row), strict=True):
            if share:
                beside[part][other] = beside[other][part] = share


def _sides(corners: tuple[Point, ...], row: IntRow) -> tuple[tuple[Point, ...], tuple[Point, ...]]:
    """The corners of the parts of a facet on the two sides of a plane; empty for an empty part.

    The plane must not be that of the facet.
    """
    rays = [_ray(corner) for corner in corners]
    heights = [value(row, ray) for ray in rays]
    if max(heights) <= 0:
        return corners, ()
    if min(heights) >= 0:
        return (), corners
    known = dict(zip(corners, zip(heights, rays, strict=True), strict=True))
    below = [corner for corner, height in zip(corners, heights, strict=True) if height <= 0]
    above = [corner for corner, height in zip(corners, heights, strict=True) if height >= 0]
    ring = around(corners)
    for start, end in pairwise((*ring, ring[0]) if len(ring) > 2 else ring):
        (low, first), (high, second) = known[start], known[end]
        if low * high < 0:
            crossing = [high * a - low * b for a, b in zip(first, second, strict=True)]
            point = tuple(Fraction(x, crossing[-1]) for x in crossing[:-1])
            below.append(point)
            above.append(point)
    return tuple(sorted(below)), tuple(sorted(above))


def _ray(point: Point) -> tuple[int, ...]:
    """The point in homogeneous integers."""
    (lattice,), scale = on_lattice([point])
    return (*lattice, scale)
