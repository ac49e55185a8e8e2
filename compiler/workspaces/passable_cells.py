"""The cells between which a point may move that keeps out of some regions.

A point that moves continuously within the bounds, and never enters certain closed regions, is at
every instant in a cell that is inside none of them.  The instants at which it is in a given closed
cell are a closed set, so that it gets from one set of cells to the others only through a point that
is in both: from cell to touching cell, where a common corner is contact, too.
"""

from __future__ import annotations

from collections.abc import Collection, Sequence
from dataclasses import dataclass, field
from functools import cached_property

from compiler.workspaces.abstraction import Abstraction
from compiler.workspaces.polytope import Polytope, polytope_of
from grammar_lang import ir


@dataclass(frozen=True)
class PassableCells:
    """The cells of a workspace, and which of them meet what."""

    abstraction: Abstraction
    workspace: ir.Workspace
    _meeting: dict[str, frozenset[int]] = field(default_factory=dict[str, frozenset[int]])

    def free(self, avoided: Collection[str]) -> frozenset[int]:
        """The cells that are inside no avoided region."""
        inside = self.abstraction.within(avoided)
        return frozenset(range(len(self.abstraction.cells))) - frozenset(inside)

    def meeting(self, region: str) -> frozenset[int]:
        """The closed cells that have a point in common with a region."""
        if region not in self._meeting:
            bounds, shape = (
                polytope_of(r.shape, self.workspace.dimension)
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
        """Per cell those that it has a point in common with."""
        found: list[list[int]] = [[] for _ in self.abstraction.cells]
        for i, j in self.abstraction.touches:
            found[i].append(j)
            found[j].append(i)
        return found

    def cut_off(self, source: str, target: str, avoided: Collection[str]) -> bool:
        """Whether no chain of touching cells leads from region to region."""
        free = self.free(avoided)
        first, last = self.meeting(source) & free, self.meeting(target) & free
        if connected(first, self.abstraction.neighbours, free) & last:
            return False  # without asking which cells touch at corners
        return not connected(first, self.touching, free) & last


def _near(one: Polytope, other: Polytope) -> bool:
    """Whether the boxes about two bounded polytopes meet; they do if the polytopes do."""
    (low, high), (lower, upper) = one.box, other.box
    return bool((low <= upper).all() and (lower <= high).all())


def connected(
    cells: Collection[int], beside: Sequence[Collection[int]], free: Collection[int]
) -> frozenset[int]:
    """The free cells that chains of free cells lead to."""
    reached, pending = set(cells), list(cells)
    while pending:
        for cell in beside[pending.pop()]:
            if cell in free and cell not in reached:
                reached.add(cell)
                pending.append(cell)
    return frozenset(reached)
