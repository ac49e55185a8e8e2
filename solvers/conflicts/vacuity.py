"""Tasks that no motion satisfies, and formulas that demand nothing."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from contextlib import closing
from dataclasses import dataclass
from itertools import groupby, islice

import numpy as np

from compiler.tasks.event_order import order_conditions
from compiler.tasks.necessary_conditions import (
    NecessaryCondition,
    NecessaryConditions,
    conjuncts,
    necessary_conditions,
)
from compiler.tasks.region_slots import Clause, TooManySlotsError
from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code, Diagnostic, Severity, Sink
from grammar_lang.ir.formula_parts import Occurrence, atoms, formula_text, occurrences, strengthened
from grammar_lang.source import Span
from solvers.backends.cadical import SatSolver
from solvers.verdict import Fails

# --- The demands of a task that exclude each other, by a SAT solver -------------------------------
#
# The demands (in ``compiler``) are assumed; from an unsatisfiable core as many as possible are left
# out (deletion-based extraction of a minimal core, Chinneck & Dravnieks 1991). If the solver's
# budget runs out, nothing is reported.


CONFLICTS = 20_000


class ConditionConflicts:
    """The demands of a task in a solver; others may be added."""

    def __init__(self, asked: NecessaryConditions) -> None:
        self._solver = SatSolver()
        self._by_selector = {demand.selector: demand for demand in asked.demands}
        self._write(asked.clauses)

    def _write(self, clauses: Iterable[Clause]) -> None:
        for _, group in groupby(sorted(clauses, key=len), key=len):
            self._solver.add(np.array(list(group), dtype=np.int64))

    def add(self, demand: NecessaryCondition, clauses: Iterable[Clause]) -> None:
        """Add a demand, with the clauses that it needs."""
        self._by_selector[demand.selector] = demand
        self._write(clauses)

    def exclude(self, demands: Iterable[NecessaryCondition]) -> bool:
        """Whether the demands are known to exclude each other."""
        return self._refuted([demand.selector for demand in demands]) is not None

    def core(self, demands: Iterable[NecessaryCondition]) -> tuple[NecessaryCondition, ...] | None:
        """Demands that exclude each other, all of them needed; None if unknown."""
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
        """Selectors among the given ones that suffice for a contradiction; None if not found."""
        answer = self._solver.solve(selectors, conflicts=CONFLICTS)
        return list(answer.counterexample.assumptions) if isinstance(answer, Fails) else None

    def close(self) -> None:
        """Free the memory of the solver."""
        self._solver.close()


# --- Clauses of a task that exclude each other, whatever the robot --------------------------------


def contradictions(program: ir.Program, task: ir.Task) -> tuple[Diagnostic, ...]:
    """Errors about formulas of a task that contradict themselves, each other or other clauses."""
    return formula_findings(program, task, warn=False)


def contradictions_among(
    task: ir.Task,
    demands: Sequence[NecessaryCondition],
    conflicts: ConditionConflicts,
    check: str = "",
) -> tuple[Diagnostic, ...]:
    """The errors, for demands that are already in a solver; ``check`` is what to check."""
    return tuple(_found(task, demands, conflicts, check))


def _found(
    task: ir.Task,
    demands: Sequence[NecessaryCondition],
    conflicts: ConditionConflicts,
    check: str,
) -> Iterator[Diagnostic]:
    left = list(demands)
    for number, clause in enumerate(task.satisfy):
        own = [demand for demand in demands if demand.formula == number]
        core = conflicts.core(own)
        if core is not None:
            left = [demand for demand in left if demand.formula != number]
            yield _alone(clause.formula.span, core, check)
    while (core := conflicts.core(left)) is not None:
        formulas = [demand for demand in core if demand.formula is not None]
        if not formulas:
            return  # the workspace checks report an avoided start or target
        yield _together(task, core)
        left = [demand for demand in left if demand.formula != formulas[-1].formula]


def _alone(span: Span, core: Sequence[NecessaryCondition], check: str) -> Diagnostic:
    """A formula that no motion satisfies."""
    other = "parts" if len(core) > 2 else "part"
    notes = tuple((demand.span, f"this excludes the other {other}") for demand in core)
    return Diagnostic(
        Code.CONTRADICTORY_TASK,
        Severity.ERROR,
        "no motion satisfies this formula, whatever the robot",
        span if len(core) > 1 else core[0].span,
        f"check {check}",
        notes if len(core) > 1 else (),
    )


def _together(task: ir.Task, core: Sequence[NecessaryCondition]) -> Diagnostic:
    """Clauses that exclude each other, reported at the last of them."""
    ordered = sorted(core, key=lambda demand: (demand.span.file, demand.span))
    others: dict[Span, list[str]] = {}
    for demand in ordered:
        others.setdefault(demand.span, []).append(demand.text)
    del others[ordered[-1].span]
    return Diagnostic(
        Code.CONTRADICTORY_TASK,
        Severity.ERROR,
        f"task `{task.name}` contradicts itself: no motion satisfies all this, whatever the robot",
        ordered[-1].span,
        "change or remove one of the clauses",
        tuple((span, ", ".join(texts)) for span, texts in others.items()),
    )


def _what_to_check(task: ir.Task) -> str:
    if task.repeat:
        return "its regions and its windows; the motion goes on for ever"
    end = float(task.steps * task.step)
    late = " at the latest" if task.at_most else ""
    return f"its regions, its windows and the horizon, which ends at {end:g} s{late}"


# --------------------------------------------------------------------------------------------------
# Formulas that demand nothing, or that have a part without influence: warnings before any search.
#
# A part has no influence if the task entails the formula with the worst constant in its place:
# false for a part in positive position, true for one in negative position (Beer, Ben-David, Eisner
# & Rodeh, *Efficient detection of vacuity in temporal model checking*, 2001; Kupferman & Vardi,
# *Vacuity detection in temporal model checking*, 2003). What holds for a part holds for everything
# in it, so the largest parts are reported. There is no model here except all motions. The demands
# of the task on them (in ``compiler``) are only necessary, so every report is true, but much is not
# reported.


EXTRA_CLAUSES = 40_000
"""The most clauses for these questions; beyond them the formulas of a task are not examined."""
QUOTED = 40
"""The most characters of a part that is quoted."""


def vacuities(
    task: ir.Task, asked: NecessaryConditions, conflicts: ConditionConflicts
) -> tuple[Diagnostic, ...]:
    """Warnings about the formulas of a task without contradictions, at most one for each."""
    found: list[Diagnostic] = []
    entailment = Entailment(asked, conflicts)
    try:
        for number in range(len(task.satisfy)):
            found.extend(_diagnostics(task, number, entailment))
    except TooManySlotsError:
        pass
    return tuple(found)


@dataclass(slots=True)
class Entailment:
    """What the demands of a task entail; all questions together use up to ``EXTRA_CLAUSES``."""

    asked: NecessaryConditions
    conflicts: ConditionConflicts
    spent: int = 0

    def holds(self, formula: ir.Formula) -> bool:
        """Whether all demands are known to entail a formula.

        Raises:
            TooManySlotsError: the clauses are used up; ``reasons`` raises it, too.
        """
        return self.conflicts.exclude([*self.asked.demands, self._denial(formula)])

    def reasons(
        self, formula: ir.Formula, demands: Sequence[NecessaryCondition]
    ) -> tuple[NecessaryCondition, ...] | None:
        """A minimal set among some demands that entails a formula; None if none is known."""
        denial = self._denial(formula)
        core = self.conflicts.core([*demands, denial])
        return None if core is None else tuple(demand for demand in core if demand is not denial)

    def _denial(self, formula: ir.Formula) -> NecessaryCondition:
        denial, clauses = self.asked.denial(formula)
        self.spent += len(clauses)
        if self.spent > EXTRA_CLAUSES:
            raise TooManySlotsError
        self.conflicts.add(denial, clauses)
        return denial


def _diagnostics(task: ir.Task, number: int, entailment: Entailment) -> Iterator[Diagnostic]:
    formula = task.satisfy[number].formula
    parts = list(conjuncts(formula))
    reasons = [(part, always_holds(part, entailment)) for part in parts]
    holding = [(part, because) for part, because in reasons if because is not None]
    if len(holding) == len(parts):
        yield _always(task, formula, [demand for _, because in holding for demand in because])
    elif holding:
        yield _always(task, *holding[0])
    else:
        idle = (without_influence(part, number, entailment) for part in parts)
        yield from (_idle(task, *found) for found in islice(filter(None, idle), 1))


def always_holds(
    formula: ir.Formula, entailment: Entailment
) -> tuple[NecessaryCondition, ...] | None:
    """The clauses of a task other than ``satisfy`` that entail a formula; None if not known."""
    frame = [demand for demand in entailment.asked.demands if demand.formula is None]
    return entailment.reasons(formula, frame)


def without_influence(
    formula: ir.Formula, number: int, entailment: Entailment
) -> tuple[Occurrence, tuple[NecessaryCondition, ...]] | None:
    """The largest part of a conjunct without influence, and the demands that cause this.

    Args:
        formula: the conjunct.
        number: the number of its formula among those of the task.
        entailment: the entailment by the demands of the task.
    """
    parts = {found.path: found for found in written(formula)}
    inner = {path[:-1] for path in parts if path}
    best: Occurrence | None = None
    for path in [path for path in parts if path not in inner]:
        while path and entailment.holds(strengthened(formula, parts[path])):
            if best is None or len(path) < len(best.path):
                best = parts[path]
            path = path[:-1]  # noqa: PLW2901
    if best is None:
        return None
    core = entailment.reasons(strengthened(formula, best), entailment.asked.demands) or ()
    own = (number, formula.span)
    return best, tuple(demand for demand in core if (demand.formula, demand.span) != own)


def written(formula: ir.Formula) -> Iterator[Occurrence]:
    """The parts with a place of their own in the text, which the pieces of a map do not have."""
    spans: dict[tuple[int, ...], Span] = {(): ir.NOWHERE}
    for found in occurrences(formula):
        span = found.formula.span
        if found.path[:-1] in spans and (span == ir.NOWHERE or span != spans[found.path[:-1]]):
            spans[found.path] = span
            yield found


def _always(
    task: ir.Task, formula: ir.Formula, because: Sequence[NecessaryCondition]
) -> Diagnostic:
    whose = "that does the rest of the task" if because else "whatever the robot"
    return Diagnostic(
        Code.VACUOUS_FORMULA,
        Severity.WARNING,
        f"this formula requires nothing: it holds for every motion {whose}",
        formula.span,
        f"remove it, or check {_what_to_check(task)}",
        _notes(because),
    )


def _idle(task: ir.Task, part: Occurrence, because: Sequence[NecessaryCondition]) -> Diagnostic:
    text = formula_text(part.formula)
    # The name of a piece of a map contains a point and does not occur in the text.
    quoted = len(text) <= QUOTED and not any("." in atom.region for atom in atoms(part.formula))
    named = f"`{text}`" if quoted else "this part of the formula"
    truth = "never" if part.positive else "always"
    return Diagnostic(
        Code.VACUOUS_FORMULA,
        Severity.WARNING,
        f"{named} has no influence: the task asks for the same if it is {truth} true",
        part.formula.span,
        f"leave it out of the formula, or check the other clauses of task `{task.name}`",
        _notes(because),
    )


def _notes(because: Sequence[NecessaryCondition]) -> tuple[tuple[Span, str], ...]:
    """The demands at each place."""
    texts: dict[Span, list[str]] = {}
    for demand in sorted(because, key=lambda demand: (demand.span.file, demand.span)):
        texts.setdefault(demand.span, []).append(demand.text)
    return tuple((span, ", ".join(parts)) for span, parts in texts.items())


# --- The checks of formulas that need a SAT solver ------------------------------------------------


def formula_diagnostics(program: ir.Program, sink: Sink) -> None:
    """Report formulas that contradict themselves or their task; without errors, vacuous ones.

    A program with errors may lack the very clauses that give a formula its meaning. Maps are
    already expanded to obstacles. Nothing more is reported about a formula that the start of an
    endless motion already violates.
    """
    warn = not sink.has_errors
    starts = [each.span for each in sink.found if each.code is Code.START_OUTSIDE_LOOP]
    for task in program.tasks.values():
        spans = [clause.formula.span for clause in task.satisfy]
        told = any(
            span.to(start) == span and span.file == start.file for start in starts for span in spans
        )
        if task.satisfy and not told:
            sink.found.extend(formula_findings(program, task, warn=warn))


def formula_findings(
    program: ir.Program, task: ir.Task, *, warn: bool = True
) -> tuple[Diagnostic, ...]:
    """Errors about the formulas of a task; if there are none, warnings if ``warn``."""
    warnings: tuple[Diagnostic, ...] = ()
    for conditions, check in (
        (necessary_conditions, _what_to_check(task)),
        (order_conditions, "the order in which it asks for its regions"),
    ):
        asked = conditions(program, task)
        if asked is None:
            continue
        with closing(ConditionConflicts(asked)) as conflicts:
            errors = contradictions_among(task, asked.demands, conflicts, check)
            if errors:
                return errors
            if warn and not warnings:
                warnings = vacuities(task, asked, conflicts)
    return warnings
