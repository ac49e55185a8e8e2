"""At most one literal of each group, where groups grow.

Source: the ladder encoding (Gent & Nightingale, *A new encoding of alldifferent into SAT*, 2004): a
literal per member says that it or one before it holds.
"""

from __future__ import annotations

import numpy as np

from compiler.planning.clauses import Clauses, Ints


class Ladders:
    """Groups 0, 1, ... of literals, at first without any."""

    def __init__(self, clauses: Clauses, what: str) -> None:
        self._clauses = clauses
        self._what = what
        self._top = np.zeros(0, dtype=np.int64)

    def extend(self, groups: Ints, literals: Ints) -> None:
        """Add literals to their groups, both of shape (n,)."""
        if not len(groups):
            return
        order = np.argsort(groups, kind="stable")
        groups, literals = groups[order], literals[order]
        missing = int(groups[-1]) + 1 - len(self._top)
        self._top = np.pad(self._top, (0, max(0, missing)))
        first = np.ones(len(groups), dtype=bool)
        first[1:] = groups[1:] != groups[:-1]
        before = self._top[groups]
        # Of the first member of a group the literal itself is the first rung.
        rungs = literals.copy()
        further = ~(first & (before == 0))
        names = groups[further]
        rungs[further] = self._clauses.fresh(
            len(names), lambda i: f"one of {self._what} {names[i]} so far"
        )
        before = np.where(first, before, np.roll(rungs, 1))
        own, rung, lower = literals[further], rungs[further], before[further]
        self._clauses.add(np.column_stack([-own, rung]))
        self._clauses.add(np.column_stack([-lower, rung]))
        self._clauses.add(np.column_stack([-own, -lower]))
        last = np.roll(first, -1)
        self._top[groups[last]] = rungs[last]
