"""Tasks that no motion can fulfil, whatever the robot: which clauses exclude each other."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from itertools import groupby

import numpy as np

from compiler.tasks.formula_slots import Clause
from compiler.tasks.necessary_conditions import (
    NecessaryCondition,
    NecessaryConditions,
    necessary_conditions,
)
from grammar_lang import ir
from grammar_lang.diagnostics.codes import Code
from grammar_lang.diagnostics.diagnostic import Diagnostic, Severity
from grammar_lang.source import Span
from solvers.backends.cadical import SatSolver
from solvers.verdict import Fails

# --- Which demands of a task exclude each other, by a SAT solver ----------------------------------
#
# The demands (in ``compiler``) are assumed; of an unsatisfiable core as many are left out as can be
# (deletion-based extraction of a minimal core, Chinneck & Dravnieks 1991). Nothing is said where
# the solver's budget runs out.


CONFLICTS = 20_000


class ConditionConflicts:
    """The demands of a task in a solver, to which others may be added."""

    def __init__(self, asked: NecessaryConditions) -> None:
        self._solver = SatSolver()
        self._by_selector = {demand.selector: demand for demand in asked.demands}
        self._write(asked.clauses)

    def _write(self, clauses: Iterable[Clause]) -> None:
        for _, group in groupby(sorted(clauses, key=len), key=len):
            self._solver.add(np.array(list(group), dtype=np.int64))

    def add(self, demand: NecessaryCondition, clauses: Iterable[Clause]) -> None:
        """One more demand, with the clauses that it needs."""
        self._by_selector[demand.selector] = demand
        self._write(clauses)

    def exclude(self, demands: Iterable[NecessaryCondition]) -> bool:
        """Whether the demands are known to exclude each other."""
        return self._refuted([demand.selector for demand in demands]) is not None

    def core(self, demands: Iterable[NecessaryCondition]) -> tuple[NecessaryCondition, ...] | None:
        """Conditions that exclude each other, none of which can be spared; None if unknown."""
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


# --- Tasks that no motion can fulfil, whatever the robot: which clauses exclude each other --------


def contradictions(program: ir.Program, task: ir.Task) -> tuple[Diagnostic, ...]:
    """Errors about the formulas of a task: each contradicts itself, or others and other clauses."""
    asked = necessary_conditions(program, task)
    if asked is None:
        return ()
    conflicts = ConditionConflicts(asked)
    try:
        return contradictions_among(task, asked.demands, conflicts)
    finally:
        conflicts.close()


def contradictions_among(
    task: ir.Task, demands: Sequence[NecessaryCondition], conflicts: ConditionConflicts
) -> tuple[Diagnostic, ...]:
    """The same for demands that are in a solver."""
    return tuple(_found(task, demands, conflicts))


def _found(
    task: ir.Task, demands: Sequence[NecessaryCondition], conflicts: ConditionConflicts
) -> Iterator[Diagnostic]:
    left = list(demands)
    for number, clause in enumerate(task.satisfy):
        own = [demand for demand in demands if demand.formula == number]
        core = conflicts.core(own)
        if core is not None:
            left = [demand for demand in left if demand.formula != number]
            yield _alone(task, clause.formula.span, core)
    while (core := conflicts.core(left)) is not None:
        formulas = [demand for demand in core if demand.formula is not None]
        if not formulas:
            return  # a start or a target that is avoided: told by the checks of the workspace
        yield _together(task, core)
        left = [demand for demand in left if demand.formula != formulas[-1].formula]


def _alone(task: ir.Task, span: Span, core: Sequence[NecessaryCondition]) -> Diagnostic:
    """A formula that no motion satisfies."""
    other = "parts" if len(core) > 2 else "part"
    notes = tuple((demand.span, f"this excludes the other {other}") for demand in core)
    return Diagnostic(
        Code.CONTRADICTORY_TASK,
        Severity.ERROR,
        "no motion satisfies this formula, whatever the robot",
        span if len(core) > 1 else core[0].span,
        f"check its regions, its windows and the horizon, which ends at {_seconds(task)}",
        notes if len(core) > 1 else (),
    )


def _together(task: ir.Task, core: Sequence[NecessaryCondition]) -> Diagnostic:
    """Clauses that exclude each other, told at the last of them."""
    ordered = sorted(core, key=lambda demand: (demand.span.file, demand.span))
    others: dict[Span, list[str]] = {}
    for demand in ordered:
        others.setdefault(demand.span, []).append(demand.text)
    del others[ordered[-1].span]
    return Diagnostic(
        Code.CONTRADICTORY_TASK,
        Severity.ERROR,
        f"task `{task.name}` contradicts itself: no motion does all this, whatever the robot",
        ordered[-1].span,
        "change or remove one of the clauses",
        tuple((span, ", ".join(texts)) for span, texts in others.items()),
    )


def _seconds(task: ir.Task) -> str:
    total = task.steps * task.step
    return f"{float(total):g} s"
