"""CaDiCaL 1.9.5 through python-sat: incremental, with a deterministic budget.

Source: Biere, Fazekas, Fleury & Heisinger, *CaDiCaL, Kissat, Paracooba, Plingeling and Treengeling
entering the SAT Competition 2020*. The budget counts conflicts, never seconds, so that the same
clauses give the same answer on every machine.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from pysat.solvers import Cadical195

from solvers.verdict import Answer, Fails, Holds, Reason, Unknown


@dataclass(frozen=True, slots=True, eq=False)
class Model:
    """A satisfying assignment: ``true[v]`` for the variables v = 1, 2, ...; entry 0 is unused."""

    true: NDArray[np.bool_]


@dataclass(frozen=True, slots=True)
class Core:
    """Unsatisfiable under assumptions; these suffice (if empty, the clauses alone do)."""

    assumptions: tuple[int, ...]


class SatSolver:
    """A growing set of clauses over the variables 1, 2, ... (DIMACS literals)."""

    def __init__(self) -> None:
        self._solver = Cadical195()
        self._variables = 0
        self._clauses: dict[int, list[NDArray[np.int64]]] = {}

    def add(self, clauses: NDArray[np.int64]) -> None:
        """Add clauses of equal length, shape (clauses, literals).

        Raises:
            ValueError: a clause is empty, or 0 is among the literals.
        """
        count, length = clauses.shape
        if not count:
            return
        if not length or not clauses.all():
            raise ValueError("a clause has at least one literal, and 0 is none")
        self._variables = max(self._variables, int(np.abs(clauses).max()))
        self._clauses.setdefault(length, []).append(clauses)
        self._solver.append_formula(clauses.tolist())

    def solve(self, assumptions: Sequence[int] = (), *, conflicts: int) -> Answer[Model, Core]:
        """Decide the clauses under assumptions within a number of conflicts.

        ``Unknown`` means either that the budget ran out, and another call continues with what was
        learnt, or that the solver failed, for example with a model that violates a clause.

        Raises:
            ValueError: ``conflicts`` is not positive.
        """
        if conflicts < 1:
            raise ValueError("a budget is at least one conflict")
        self._variables = max([self._variables, *map(abs, assumptions)])
        self._solver.conf_budget(conflicts)
        try:
            answer = self._solver.solve_limited(assumptions=list(assumptions))
            if answer is None:
                return Unknown(Reason.CONFLICT_LIMIT, f"after {conflicts} conflicts")
            if not answer:
                return self._core(assumptions)
            return self._model(np.array(self._solver.get_model(), dtype=np.int64), assumptions)
        except Exception as error:
            return Unknown(Reason.FAILED, f"{type(error).__name__}: {error}")

    def _core(self, assumptions: Sequence[int]) -> Answer[Model, Core]:
        core = tuple(sorted(self._solver.get_core() or ()))
        if not set(core) <= set(assumptions):
            return Unknown(Reason.FAILED, "a core of what was not assumed")
        return Fails(Core(core))

    def _model(
        self, literals: NDArray[np.int64], assumptions: Sequence[int]
    ) -> Answer[Model, Core]:
        true = np.zeros(self._variables + 1, dtype=bool)
        true[literals[(literals > 0) & (literals <= self._variables)]] = True
        units = np.array(assumptions, dtype=np.int64).reshape(-1, 1)
        for length, parts in self._clauses.items():
            self._clauses[length] = [np.concatenate(parts)]
        every = [units, *(parts[0] for parts in self._clauses.values())]
        for clauses in every:
            if not np.any(true[np.abs(clauses)] == (clauses > 0), axis=1).all():
                return Unknown(Reason.FAILED, "a model that breaks a clause")
        return Holds(Model(true))

    def close(self) -> None:
        """Free the memory now instead of when the object is deleted."""
        self._solver.delete()
