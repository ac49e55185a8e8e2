"""Clauses that forbid paths of one effector that visit certain cells; they grow with the paths.

Other cells may lie between. If order matters, each cell except the last has a ladder of literals,
"this cell and those before it were visited in order by position p"; once true, they stay true.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from compiler.tasks.formula_clauses import Clauses
from compiler.tasks.places import Places


@dataclass(slots=True)
class _Sequence:
    """Cells, and for each cell except the last its literals by position."""

    cells: tuple[int, ...]
    ladders: list[list[int]] = field(default_factory=list[list[int]])


class CellSequences:
    """The forbidden visits of paths of an effector.

    Args:
        clauses: the clauses to which new ones are added.
        who: the name of the effector.
    """

    def __init__(self, clauses: Clauses, who: str) -> None:
        self._clauses = clauses
        self._who = who
        self._sequences: list[_Sequence] = []
        self._visited: dict[int, int] = {}

    def forbid(self, cells: Sequence[int], places: Places, *, ordered: bool) -> None:
        """Forbid paths that visit all these cells (``ordered``: in order); ``places`` exist by now.

        An empty list of cells forbids every path.
        """
        if ordered or len(cells) < 2:
            made = _Sequence(tuple(cells), [[] for _ in cells[1:]])
            self._sequences.append(made)
            if not cells:
                self._clauses.clause([])
            self._in_turn(made, places)
            return
        for cell in cells:
            if cell not in self._visited:
                self._visited[cell] = self._clauses.one(f"{self._who} visits cell {cell}")
                self._visits(places, (cell,))
        self._clauses.clause([-self._visited[cell] for cell in cells])

    def extend(self, new: Places) -> None:
        """Account for the new places that paths may visit."""
        for sequence in self._sequences:
            self._in_turn(sequence, new)
        self._visits(new, tuple(self._visited))

    def _visits(self, places: Places, cells: Sequence[int]) -> None:
        """An effector at a place visits the cell of that place."""
        for cell in cells:
            for variable in places.variables[places.cells == cell].tolist():
                self._clauses.clause([-variable, self._visited[cell]])

    def _in_turn(self, sequence: _Sequence, places: Places) -> None:
        """At a place of the next cell of a sequence, that cell has been visited in order, too."""
        last = len(sequence.cells) - 1
        for stage, cell in enumerate(sequence.cells):
            at = places.cells == cell
            pairs = zip(places.layers[at].tolist(), places.variables[at].tolist(), strict=True)
            for position, variable in pairs:
                clause = [-variable]
                if stage:
                    if not position:
                        continue
                    clause.append(-self._rung(sequence, stage - 1, position - 1))
                if stage < last:
                    clause.append(self._rung(sequence, stage, position))
                self._clauses.clause(clause)

    def _rung(self, sequence: _Sequence, stage: int, position: int) -> int:
        """The literal that the first cells of a sequence were visited in order by a position."""
        ladder = sequence.ladders[stage]
        while len(ladder) <= position:
            ladder.append(
                self._clauses.one(
                    f"{self._who} visits {sequence.cells[: stage + 1]} by position {len(ladder)}"
                )
            )
            if len(ladder) > 1:
                self._clauses.clause([-ladder[-2], ladder[-1]])
        return ladder[position]
