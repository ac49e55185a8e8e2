"""When the positions of a path are entered: an order encoding.

Source: Tamura, Taga, Kitagawa & Banbara, *Compiling finite linear CSP into SAT* (2009), an
integer by the comparisons with it.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from compiler.planning.clauses import TRUE, Clauses, Ints
from compiler.planning.position_paths import PositionPaths


class EntrySamples:
    """Position p is entered at a sample up to ``steps``, after position p - 1; position 0 at 0."""

    def __init__(self, clauses: Clauses, paths: PositionPaths, steps: int, who: str) -> None:
        self._clauses = clauses
        self._paths = paths
        self._steps = steps
        self._who = who
        self._rows = [np.full(steps + 1, TRUE, dtype=np.int64)]

    def row(self, position: int) -> Ints:
        """Per sample the literal that the position is entered by then; shape (steps + 1,)."""
        while len(self._rows) <= position:
            self._add_row(len(self._rows))
        return self._rows[position]

    def entries(self, count: int, true: NDArray[np.bool_]) -> tuple[int, ...]:
        """The samples at which a model enters the first positions."""
        return tuple(int(np.argmax((row > 0) & true[np.abs(row)])) for row in self._rows[:count])

    def literals(self, entries: Sequence[int]) -> list[int]:
        """What is false unless the positions are entered at these samples exactly."""
        found = []
        for position, sample in enumerate(entries):
            row = self.row(position)
            found.append(int(row[sample]))
            found += [-int(row[sample - 1])] if sample else []
        return found

    def _add_row(self, position: int) -> None:
        """``row[j]`` implies ``row[j + 1]``, and ``row[j - 1]`` of the position before."""
        first, exists = min(position, self._steps + 1), self._paths.exists(position)
        row = np.full(self._steps + 1, -TRUE, dtype=np.int64)
        row[first:] = self._clauses.fresh(
            self._steps + 1 - first,
            lambda i: f"{self._who} is at position {position} by sample {first + i}",
        )
        own = row[first:]
        self._clauses.add(np.column_stack([-own[:-1], own[1:]]))
        if position > 1:
            before = self._rows[-1][first - 1 : self._steps]
            self._clauses.add(np.column_stack([-own, before]))
        for literal in own[-1:].tolist() or [-TRUE]:
            self._clauses.clause([-exists, literal])
            self._clauses.clause([exists, -literal])
        self._rows.append(row)
