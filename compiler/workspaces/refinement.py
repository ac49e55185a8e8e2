"""Cutting cells of a partition in two, with the facets of what is left; exact and local.

Source: Clarke, Grumberg, Jha, Lu & Veith, *Counterexample-guided abstraction refinement* (2003):
a cell that is too coarse is split, the others stay.  Only the facets of a cell that is cut are
computed anew.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from itertools import pairwise

from compiler.workspaces.adjacency import Pair
from compiler.workspaces.double_description import IntRow, Point, integer_row, value
from compiler.workspaces.hull import around, on_lattice
from compiler.workspaces.polytope import Polytope
from grammar_lang.ir import HalfSpace


@dataclass(frozen=True, slots=True)
class Cut:
    """Halve cell number ``cell`` by a hyperplane that meets its interior.

    The part in ``half_space`` keeps the number; the other one gets the next number after all cells
    there are at that time.
    """

    cell: int
    half_space: HalfSpace


@dataclass(frozen=True, slots=True)
class Pieces:
    """The polytopes after some cuts, their facets by pairs i < j, and of each the cell it is of."""

    polytopes: tuple[Polytope, ...]
    facets: Mapping[Pair, tuple[Point, ...]]
    origins: tuple[int, ...]


def split_cells(
    polytopes: Sequence[Polytope], facets: Mapping[Pair, tuple[Point, ...]], cuts: Iterable[Cut]
) -> Pieces:
    """The cuts in turn, on irredundant cells with interior and their common facets.

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
    """Give the facets of a cell that is cut to its two parts; the last cell is the outer one."""
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
    """The corners of the parts of a facet on the two sides of a plane, none where it is empty.

    The plane is not that of the facet.
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
