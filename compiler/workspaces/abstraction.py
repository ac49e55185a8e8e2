"""WS.Abstraction: the workspace as labelled convex cells with adjacency.

Source: Sections 3 and 4.2 of the paper, W = (P, H, N).  The cells partition the bounds and refine
every region, so all inner points of a cell have the same propositions.  Only cells that meet a
region are cut, along its facets; pieces with equal propositions are then merged into few large
ones.
"""

from __future__ import annotations

from collections import Counter
from collections.abc import Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from functools import cached_property
from typing import Final, Literal, TypeAlias

import numpy as np
from numpy.typing import ArrayLike, NDArray

from compiler.arrays import Array
from compiler.time_limits.time_limit import check_time
from compiler.workspaces.adjacency import shared_facets, touching
from compiler.workspaces.convex_pieces import coarsened
from compiler.workspaces.hull import Point
from compiler.workspaces.overlaps import Pair
from compiler.workspaces.partition import Cut, divide, split_cells
from compiler.workspaces.polytope import Polytope, polytope_of, refuting_polytope
from grammar_lang import ir
from grammar_lang.ir import Region, Round, Workspace

CellKind: TypeAlias = Literal["obstacle", "target", "region", "free"]
FREE: Final = "free"
OUTSIDE = 1e-9
"""The distance (m) at which a point outside all cells still counts as on their boundary."""


@dataclass(frozen=True, slots=True)
class Cell:
    """A closed convex cell; it is named after ``region``, whose kind is ``kind``."""

    name: str
    kind: CellKind
    polytope: Polytope
    propositions: frozenset[str]
    region: str

    @property
    def volume(self) -> Fraction:
        """The area (m^2) in the plane, the volume (m^3) in space; exact."""
        return self.polytope.volume


@dataclass(frozen=True)
class Abstraction:
    """The cells in order of their regions, and the facets that neighbours share.

    ``facets`` maps every pair i < j of neighbours to the corners of their common facet.  ``cuts``
    are those made since ``abstract``, in the cell numbers of that time and those added since.
    ``numbers`` has this number of every cell; it is empty if nothing has been cut.
    """

    dimension: int
    cells: tuple[Cell, ...]
    facets: Mapping[Pair, tuple[Point, ...]]
    cuts: tuple[Cut, ...] = ()
    numbers: tuple[int, ...] = ()

    @property
    def adjacency(self) -> tuple[Pair, ...]:
        """The neighbouring pairs i < j, sorted (N is symmetric, and staying is always allowed)."""
        return tuple(self.facets)

    @cached_property
    def neighbours(self) -> tuple[tuple[int, ...], ...]:
        """The neighbours of each cell, ascending, without itself."""
        found: list[list[int]] = [[] for _ in self.cells]
        for i, j in self.facets:
            found[i].append(j)
            found[j].append(i)
        return tuple(tuple(sorted(cells)) for cells in found)

    @cached_property
    def touches(self) -> tuple[Pair, ...]:
        """The pairs i < j of cells that meet at all, corner contacts included, sorted."""
        return touching([cell.polytope for cell in self.cells])

    def index(self, name: str) -> int:
        """The index of the cell with that name; KeyError if there is none."""
        return self._indices[name]

    def within(self, regions: Iterable[str]) -> tuple[int, ...]:
        """The cells inside at least one of the regions, ascending."""
        wanted = frozenset(regions)
        return tuple(i for i, cell in enumerate(self.cells) if cell.propositions & wanted)

    def cells_of(self, region: str) -> tuple[int, ...]:
        """The cells inside a region, ascending."""
        return self.within((region,))

    def refined(self, cuts: Iterable[Cut]) -> tuple[Abstraction, tuple[tuple[int, ...], ...]]:
        """The abstraction after applying cuts in turn, and the new cells of each cell of this one.

        A cut uses the cell numbers of this abstraction; each cut adds the next number, starting
        with ``len(self.cells)``.  Cells are renamed at the end, so the result is the same as if all
        ``cuts`` ever made had been applied to the first abstraction at once.

        Raises:
            ValueError: a cut names no cell, or misses the interior of its cell.
        """
        made = tuple(cuts)
        if not made:
            return self, tuple((i,) for i in range(len(self.cells)))
        split = split_cells([cell.polytope for cell in self.cells], self.facets, made)
        order = list(dict.fromkeys(cell.region for cell in self.cells))
        ranks = {region: rank for rank, region in enumerate(order)}
        parents = [self.cells[origin] for origin in split.origins]
        sequence = sorted(
            range(len(parents)),
            key=lambda i: (ranks[parents[i].region], split.polytopes[i].centre, i),
        )
        cells = _numbered(
            (parents[i].region, parents[i].kind, split.polytopes[i], parents[i].propositions)
            for i in sequence
        )
        places = {number: place for place, number in enumerate(sequence)}
        pairs = (((places[i], places[j]), corners) for (i, j), corners in split.facets.items())
        facets = dict(sorted(((min(pair), max(pair)), corners) for pair, corners in pairs))
        children: list[list[int]] = [[] for _ in self.cells]
        for place, number in enumerate(sequence):
            children[split.origins[number]].append(place)
        before = (*(self.numbers or range(len(self.cells))), *range(len(self.cells), len(cells)))
        history = tuple(Cut(before[cut.cell], cut.half_space) for cut in made)
        numbers = tuple(before[number] for number in sequence)
        finer = Abstraction(self.dimension, cells, facets, (*self.cuts, *history), numbers)
        return finer, tuple(map(tuple, children))

    def cut(self, cuts: Iterable[Cut]) -> Abstraction:
        """The abstraction after applying cuts; see ``refined``."""
        return self.refined(cuts)[0]

    def containing(self, point: Sequence[Fraction]) -> tuple[int, ...]:
        """All closed cells that contain a rational point, ascending; exact."""
        return tuple(i for i, cell in enumerate(self.cells) if cell.polytope.contains_point(point))

    def locate(self, point: ArrayLike) -> int | None:
        """The cell in which a point (d,) lies deepest, the first on a tie; None outside the bounds.

        Computed in floats: near a common facet the answer may be either of its cells.
        """
        normals, offsets, starts = self._stacked
        excess = np.maximum.reduceat(normals @ np.asarray(point, dtype=float) - offsets, starts)
        best = int(np.argmin(excess))
        return best if excess[best] <= OUTSIDE else None

    def facet_centre(self, first: int, second: int) -> Array:
        """The mean of the corners of the facet that two neighbours share, shape (d,), in metres.

        Raises:
            KeyError: they are not neighbours.
        """
        corners = self.facets[min(first, second), max(first, second)]
        return np.array(
            [float(sum(c, Fraction(0)) / len(corners)) for c in zip(*corners, strict=True)]
        )

    def describe(self) -> dict[str, list[str]]:
        """The inequalities of every cell as text with rationals, by name."""
        return {cell.name: cell.polytope.inequalities() for cell in self.cells}

    @cached_property
    def _indices(self) -> dict[str, int]:
        return {cell.name: i for i, cell in enumerate(self.cells)}

    @cached_property
    def _stacked(self) -> tuple[Array, Array, NDArray[np.intp]]:
        """All rows of all cells, (M, d) and (M,), and the index of each cell's first row."""
        sizes = [len(cell.polytope.b) for cell in self.cells]
        return (
            np.concatenate([cell.polytope.A for cell in self.cells]),
            np.concatenate([cell.polytope.b for cell in self.cells]),
            np.cumsum([0, *sizes[:-1]]),
        )


def abstract(workspace: Workspace) -> Abstraction:
    """The coarse partition of the bounds that refines every region.

    A region without interior inside the bounds makes no cell.

    Raises:
        ValueError: the bounds are empty, flat or unbounded, or there are maps.  Maps must become
            regions first (:mod:`compiler.tasks.obstacle_pieces`), so that no obstacle is left out.
    """
    if workspace.maps:
        raise ValueError("the maps of a workspace become regions before it is divided")
    bounds = polytope_of(workspace.bounds.shape, workspace.dimension)
    if not bounds.is_bounded:
        raise ValueError("the bounds of a workspace are bounded")
    shapes: list[tuple[Polytope, str]] = []
    for region in workspace.regions:
        shape = bounds.intersection(polytope_of(region.shape, workspace.dimension))
        if shape.has_interior:
            shapes.append((shape.irredundant(), region.name))
    if workspace.dimension == 3:
        # Pieces are not divided anew in space; fewer pieces are cut if large regions go first.
        shapes.sort(key=lambda shape: (-shape[0].volume, shape[0].centre))
    pieces: list[tuple[Polytope, frozenset[str]]] = [(bounds.irredundant(), frozenset())]
    for shape, name in shapes:
        pieces = _refine(pieces, shape, name)
    named = _named(_coarse(pieces), workspace.regions)
    return Abstraction(workspace.dimension, named, shared_facets([cell.polytope for cell in named]))


def _refine(
    pieces: Sequence[tuple[Polytope, frozenset[str]]], shape: Polytope, name: str
) -> list[tuple[Polytope, frozenset[str]]]:
    """Cut the pieces that meet the interior of a region; their common parts get its proposition."""
    boxes = np.array([piece.box for piece, _ in pieces])
    lower, upper = shape.box
    near = (boxes[:, 0] <= upper).all(axis=1) & (boxes[:, 1] >= lower).all(axis=1)
    refined: list[tuple[Polytope, frozenset[str]]] = []
    for (piece, propositions), may_meet in zip(pieces, near, strict=True):
        check_time()
        if not may_meet:
            refined.append((piece, propositions))
            continue
        outside, inside = divide(piece, shape)
        refined.extend((part, propositions) for part in outside)
        if inside is not None:
            refined.append((inside, propositions | {name}))
    return refined


def _coarse(
    pieces: Sequence[tuple[Polytope, frozenset[str]]],
) -> list[tuple[Polytope, frozenset[str]]]:
    groups: dict[frozenset[str], list[Polytope]] = {}
    for piece, propositions in pieces:
        groups.setdefault(propositions, []).append(piece)
    return [(part, names) for names, parts in groups.items() for part in coarsened(parts)]


def _named(
    pieces: Sequence[tuple[Polytope, frozenset[str]]], regions: Sequence[Region]
) -> tuple[Cell, ...]:
    """Cells by the rank of their region (obstacles, targets, regions, free), then by position."""
    ranked: list[tuple[str, CellKind]] = [
        (region.name, kind)
        for kind in ("obstacle", "target", "region")
        for region in regions
        if region.kind == kind
    ]
    ranked.append((FREE, FREE))
    ranks = {name: rank for rank, (name, _) in enumerate(ranked[:-1])}
    keyed = sorted(
        (min((ranks[name] for name in names), default=len(ranks)), piece.centre, number)
        for number, (piece, names) in enumerate(pieces)
    )
    return _numbered((*ranked[rank], *pieces[number]) for rank, _, number in keyed)


def _numbered(
    sorted_cells: Iterable[tuple[str, CellKind, Polytope, frozenset[str]]],
) -> tuple[Cell, ...]:
    """The cells with names, given their region, kind, polytope and propositions in order."""
    ordered = list(sorted_cells)
    total = Counter(region for region, _, _, _ in ordered)
    used = Counter[str]()
    cells: list[Cell] = []
    for region, kind, polytope, propositions in ordered:
        used[region] += 1
        name = region if total[region] == 1 else f"{region}.{used[region]}"
        cells.append(Cell(name, kind, polytope, propositions, region))
    return tuple(cells)


# --- The cells between which a point may move that avoids some regions ----------------------------
#
# A point that moves continuously within the bounds, and never enters certain closed regions, is at
# every instant in a cell outside all of them.  The instants at which it is in a given closed cell
# form a closed set.  So it gets from one set of cells to another only through a point that is in
# both: from cell to touching cell, where a common corner counts as contact.


@dataclass(frozen=True)
class PassableCells:
    """The cells of a workspace, and which cells and regions meet."""

    abstraction: Abstraction
    workspace: ir.Workspace
    _meeting: dict[str, frozenset[int]] = field(default_factory=dict[str, frozenset[int]])

    def free(self, avoided: Collection[str]) -> frozenset[int]:
        """The cells that may be outside all avoided regions; cells of a round region may be."""
        regions = map(self.workspace.region, avoided)
        sure = [region.name for region in regions if not isinstance(region.shape, Round)]
        inside = self.abstraction.within(sure)
        return frozenset(range(len(self.abstraction.cells))) - frozenset(inside)

    def meeting(self, region: str) -> frozenset[int]:
        """The closed cells that have a point in common with a region."""
        if region not in self._meeting:
            bounds, shape = (
                refuting_polytope(r.shape, self.workspace.dimension)
                for r in (self.workspace.bounds, self.workspace.region(region))
            )
            part = bounds.intersection(shape)
            self._meeting[region] = frozenset(
                i
                for i, cell in enumerate(self.abstraction.cells)
                if not part.is_empty and _near(part, cell.polytope) and cell.polytope.meets(part)
            )
        return self._meeting[region]

    @cached_property
    def touching(self) -> list[list[int]]:
        """For each cell, the cells that it has a common point with."""
        found: list[list[int]] = [[] for _ in self.abstraction.cells]
        for i, j in self.abstraction.touches:
            found[i].append(j)
            found[j].append(i)
        return found

    def cut_off(self, source: str, target: str, avoided: Collection[str]) -> bool:
        """Whether no chain of touching free cells leads from one region to the other."""
        free = self.free(avoided)
        first, last = self.meeting(source) & free, self.meeting(target) & free
        if connected(first, self.abstraction.neighbours, free) & last:
            return False  # no need to ask which cells touch at corners
        return not connected(first, self.touching, free) & last


def _near(one: Polytope, other: Polytope) -> bool:
    """Whether the boxes of two bounded polytopes meet; they do if the polytopes do."""
    (low, high), (lower, upper) = one.box, other.box
    return bool((low <= upper).all() and (lower <= high).all())


def connected(
    cells: Collection[int], beside: Sequence[Collection[int]], free: Collection[int]
) -> frozenset[int]:
    """The free cells that can be reached through chains of free cells."""
    reached, pending = set(cells), list(cells)
    while pending:
        for cell in beside[pending.pop()]:
            if cell in free and cell not in reached:
                reached.add(cell)
                pending.append(cell)
    return frozenset(reached)
