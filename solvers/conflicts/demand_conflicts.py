"""Which demands of a task exclude each other, by a SAT solver.

The demands (in ``compiler``) are assumed; of an unsatisfiable core as many
are left out as can be (deletion-based extraction of a minimal core, Chinneck & Dravnieks 1991).
Nothing is said where the solver's budget runs out.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from itertools import groupby

import numpy as np

from compiler.tasks.formula_slots import Clause
from compiler.tasks.necessary_conditions import Demand, Demands
from solvers.backends.sat import SatSolver
from solvers.verdict import Fails

CONFLICTS = 20_000


class DemandConflicts:
    """The demands of a task in a solver, to which others may be added."""

    def __init__(self, asked: Demands) -> None:
        self._solver = SatSolver()
        self._by_selector = {demand.selector: demand for demand in asked.demands}
        self._write(asked.clauses)

    def _write(self, clauses: Iterable[Clause]) -> None:
        for _, group in groupby(sorted(clauses, key=len), key=len):
            self._solver.add(np.array(list(group), dtype=np.int64))

    def add(self, demand: Demand, clauses: Iterable[Clause]) -> None:
        """One more demand, with the clauses that it needs."""
        self._by_selector[demand.selector] = demand
        self._write(clauses)

    def exclude(self, demands: Iterable[Demand]) -> bool:
        """Whether the demands are known to exclude each other."""
        return self._refuted([demand.selector for demand in demands]) is not None

    def core(self, demands: Iterable[Demand]) -> tuple[Demand, ...] | None:
        """Demands that exclude each other and of which none can be spared; None if unknown."""
        core = self._refuted([demand.selector for demand in demands])
        if core is None:
            return None
        needed: list[int] = []
        while core:
            candidate = core.pop()
            smaller = self._refuted([*core, *needed])
            if smaller is None:
                needed.append(candidate)
            else:
                core = [selector for selector in core if selector in smaller]
        return tuple(self._by_selector[selector] for selector in sorted(needed))

    def _refuted(self, selectors: Sequence[int]) -> list[int] | None:
        """Those of the selectors that suffice for a contradiction; None if none is found."""
        answer = self._solver.solve(selectors, conflicts=CONFLICTS)
        return list(answer.counterexample.assumptions) if isinstance(answer, Fails) else None

    def close(self) -> None:
        """Free the memory of the solver."""
        self._solver.close()
