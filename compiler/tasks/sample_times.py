"""When the positions of a path are entered: an order encoding.

Source: Tamura, Taga, Kitagawa & Banbara, *Compiling finite linear CSP into SAT* (2009), an
integer by the comparisons with it.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
from numpy.typing import NDArray

from compiler.tasks.clauses import TRUE, Clauses, Ints
from compiler.tasks.places import Places, RegionLinks
from compiler.tasks.position_paths import PositionPaths
from compiler.tasks.sampled_formula import Literal


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


# --- Literals of a formula at samples, by the position that an effector is at ---------------------


class TimedRegions:
    """Variables that imply literals at samples.

    Args:
        clauses: what the clauses are added to.
        propositions: per cell the regions it lies in.
        entries: by effector (from 1) when it enters its positions.
        steps: the last sample, and the last position.
    """

    def __init__(
        self,
        clauses: Clauses,
        propositions: Sequence[frozenset[str]],
        entries: Mapping[int, EntrySamples],
        steps: int,
    ) -> None:
        self._clauses = clauses
        self._entries = entries
        self._steps = steps
        self._links = RegionLinks(clauses, propositions, steps)
        self._asked: dict[Literal, Ints] = {}
        self._positions = dict.fromkeys(entries, -1)

    def ask(self, literal: Literal, layer: int, variable: int) -> None:
        """The variable is to imply the literal at that sample; before any place is linked."""
        if literal not in self._asked:
            self._asked[literal] = np.zeros(self._steps + 1, dtype=np.int64)
        self._asked[literal][layer] = variable

    def link(self, effector: int, new: Places, last: int) -> None:
        """Link new places of an effector (from 1), whose positions are laid out up to ``last``."""
        for position in range(self._positions[effector] + 1, min(last, self._steps) + 1):
            self._positions[effector] = position
            for literal, variables in self._asked.items():
                if literal.effector == effector:
                    self._at_position(literal, variables, position)
        self._links.link(effector, new)

    def _at_position(self, literal: Literal, variables: Ints, position: int) -> None:
        """At each sample asked for: if the effector is at the position, the literal holds there."""
        sign = "" if literal.positive else "not "
        there = self._clauses.one(
            f"{sign}{literal.region} by effector {literal.effector} at position {position}"
        )
        self._links.ask(literal, position, there)
        entered = self._entries[literal.effector].row(position)
        left = self._entries[literal.effector].row(position + 1)
        due = (variables > 0) & (entered != -TRUE)
        for own, here, gone in zip(variables[due], entered[due], left[due], strict=True):
            self._clauses.clause([-int(own), -int(here), int(gone), there])
