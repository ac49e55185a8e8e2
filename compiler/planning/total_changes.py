"""The sum of the changes of several paths, counted in unary.

Source: the totalizer (Bailleux & Boufkhad, *Efficient CNF encoding of Boolean cardinality
constraints*, 2003); the numbers are unary already.
"""

from __future__ import annotations

from collections.abc import Sequence

from compiler.planning.clauses import TRUE, Clauses
from compiler.planning.position_paths import PositionPaths


class TotalChanges:
    """``above(b)``: assumed false, the paths have at most b changes together."""

    def __init__(self, clauses: Clauses, paths: Sequence[PositionPaths]) -> None:
        self._clauses = clauses
        self._paths = paths
        self._known: dict[tuple[int, int], int] = {}

    def above(self, bound: int) -> int:
        """A literal that holds if the paths have more than ``bound`` changes."""
        return self._at_least(len(self._paths), bound + 1)

    def _at_least(self, count: int, number: int) -> int:
        """A literal that holds if the first paths have so many changes together."""
        if number <= 0:
            return TRUE
        if count == 1:
            return self._paths[0].exists(number)
        key = (count, number)
        if key not in self._known:
            literal = self._clauses.one(f"{number} changes of {count} effectors")
            self._known[key] = literal
            for own in range(number + 1):
                others = self._at_least(count - 1, number - own)
                mine = self._paths[count - 1].exists(own)
                self._clauses.clause([-others, -mine, literal])
        return self._known[key]
