"""Paths of one effector that visit some cells are forbidden, by clauses that grow with the paths.

Other cells may lie between.  In turn: a ladder of literals per cell but the last, "this one and
those before it were visited in turn by position p", which only ever become true.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from compiler.tasks.formula_clauses import Clauses
from compiler.tasks.places import Places


@dataclass(slots=True)
class _Sequence:
    """Cells, and per cell but the last the literals by position."""

    cells: tuple[int, ...]
    ladders: list[list[int]] = field(default_factory=list[list[int]])


class CellSequences:
    """What paths of an effector must not visit.

    Args:
        clauses: what the clauses are added to.
        who: what the effector is called.
    """

    def __init__(self, clauses: Clauses, who: str) -> None:
        self._clauses = clauses
        self._who = who
        self._sequences: list[_Sequence] = []
        self._visited: dict[int, int] = {}

    def forbid(self, cells: Sequence[int], places: Places, *, ordered: bool) -> None:
        """No path visits all these cells; ``ordered``: none in turn.  ``places`` are there already.

        No cell at all forbids every path.
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
        """Paths may be at new places."""
        for sequence in self._sequences:
            self._in_turn(sequence, new)
        self._visits(new, tuple(self._visited))

    def _visits(self, places: Places, cells: Sequence[int]) -> None:
        """Who is at a place visits its cell."""
        for cell in cells:
            for variable in places.variables[places.cells == cell].tolist():
                self._clauses.clause([-variable, self._visited[cell]])

    def _in_turn(self, sequence: _Sequence, places: Places) -> None:
        """Who is at a place of the next cell of a sequence has visited that one in turn, too."""
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
        """The literal that the first cells of a sequence were visited in turn by a position."""
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
