"""The graph of cells, and the position of an effector in it at a layer, as Boolean variables."""

from __future__ import annotations

from collections import deque
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, field
from typing import Final

import numpy as np
from numpy.typing import NDArray

from compiler.tasks.formula_clauses import Clauses, Ints
from compiler.tasks.sampled_formula import Literal

# --- Cells and their neighbours as arrays, and distances in numbers of changes --------------------


UNREACHABLE = np.iinfo(np.int64).max // 4


@dataclass(frozen=True, slots=True, eq=False)
class Edges:
    """The directed edges ``tails[k] -> heads[k]``, ordered by tail; shapes (edges,)."""

    count: int
    tails: Ints
    heads: Ints
    first: Ints

    def of(self, cells: Ints) -> tuple[Ints, Ints]:
        """The edges out of cells (c,): indices into ``cells`` and heads, shapes (found,)."""
        degrees = self.first[cells + 1] - self.first[cells]
        owners = np.repeat(np.arange(len(cells)), degrees)
        ends = np.cumsum(degrees)
        within = np.arange(len(owners)) - np.repeat(ends - degrees, degrees)
        return owners, self.heads[self.first[cells][owners] + within]


def edges(neighbours: Sequence[Sequence[int]]) -> Edges:
    """The edges of a graph, given the neighbours of each cell."""
    degrees = np.array([len(cells) for cells in neighbours], dtype=np.int64)
    heads = np.fromiter((c for cells in neighbours for c in cells), np.int64, int(degrees.sum()))
    tails = np.repeat(np.arange(len(neighbours)), degrees)
    first = np.concatenate([np.zeros(1, dtype=np.int64), np.cumsum(degrees)])
    return Edges(len(neighbours), tails, heads, first)


def distances(
    neighbours: Sequence[Sequence[int]], sources: Iterable[int], allowed: NDArray[np.bool_]
) -> Ints:
    """The least number of steps from the sources within the allowed cells, shape (n,)."""
    usable = allowed.tolist()
    found = [UNREACHABLE] * len(neighbours)
    waiting = deque(cell for cell in sorted(set(sources)) if usable[cell])
    for cell in waiting:
        found[cell] = 0
    while waiting:
        cell = waiting.popleft()
        further = found[cell] + 1
        for following in neighbours[cell]:
            if usable[following] and found[following] == UNREACHABLE:
                found[following] = further
                waiting.append(following)
    return np.array(found, dtype=np.int64)


# --- Variables that say that an effector is in a cell at a layer ----------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class Places:
    """Each variable is for a cell at a layer, a position or a sample; shapes (n,)."""

    cells: Ints
    layers: Ints
    variables: Ints

    def with_more(self, new: Places) -> Places:
        """The union of these places and others."""
        return Places(
            np.concatenate([self.cells, new.cells]),
            np.concatenate([self.layers, new.layers]),
            np.concatenate([self.variables, new.variables]),
        )


_NONE = np.zeros(0, dtype=np.int64)
NOWHERE: Final = Places(_NONE, _NONE, _NONE)


# --- Cell traces of an effector, without repetitions -------------------------------------------


@dataclass(frozen=True, slots=True)
class Word:
    """The cells of an effector (from 0) in order, and the samples of their entry or None."""

    effector: int
    cells: tuple[int, ...]
    entries: tuple[int, ...] | None


# --------------------------------------------------------------------------------------------------
# Literals of a formula at places: in a cell, an effector is exactly in the regions of the cell.


@dataclass(slots=True)
class _Region:
    """A literal's variables by layer, 0 where not asked for, and the cells that contradict it."""

    against: NDArray[np.bool_]
    variables: Ints
    asked: list[int] = field(default_factory=list)


class RegionLinks:
    """Variables that imply literals, at layers 0 .. ``last`` of places.

    ``propositions`` holds the regions that each cell lies in.
    """

    def __init__(self, clauses: Clauses, propositions: Sequence[frozenset[str]], last: int) -> None:
        self._clauses = clauses
        self._propositions = propositions
        self._last = last
        self._regions: dict[Literal, _Region] = {}
        self._places: dict[int, Places] = {}

    def ask(self, literal: Literal, layer: int, variable: int) -> None:
        """Make the variable imply the literal at that layer."""
        if literal not in self._regions:
            inside = np.array([literal.region in names for names in self._propositions], dtype=bool)
            against = ~inside if literal.positive else inside
            self._regions[literal] = _Region(against, np.zeros(self._last + 1, dtype=np.int64))
        region = self._regions[literal]
        region.variables[layer] = variable
        region.asked.append(layer)

    def link(self, effector: int, new: Places) -> None:
        """Link what was asked since the last call, and new places of an effector (from 1)."""
        old = self._places.get(effector, NOWHERE)
        self._places[effector] = old.with_more(new)
        for literal, region in self._regions.items():
            if literal.effector != effector:
                continue
            asked = np.zeros(self._last + 1, dtype=bool)
            asked[region.asked] = True
            region.asked.clear()
            for places, layers in ((old, asked), (new, region.variables > 0)):
                hit = layers[places.layers] & region.against[places.cells]
                said = region.variables[places.layers[hit]]
                self._clauses.add(np.column_stack([-places.variables[hit], -said]))
