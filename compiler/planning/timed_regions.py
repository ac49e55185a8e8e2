"""Literals of a formula at samples, by the position that an effector is at."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from compiler.planning.clauses import TRUE, Clauses, Ints
from compiler.planning.entry_samples import EntrySamples
from compiler.planning.places import Places
from compiler.planning.region_links import RegionLinks
from compiler.specifications.sampled_formula import Literal


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
