"""Formulas that ask for nothing, or a part of which has no influence: warnings before any search.

A part has no influence if the task entails the formula with the worst constant in its place: false
for a part that it helps to have, true for one that it helps not to have (Beer, Ben-David, Eisner &
Rodeh, *Efficient detection of vacuity in temporal model checking*, 2001; Kupferman & Vardi,
*Vacuity detection in temporal model checking*, 2003).  What holds of a part holds of all that is in
it, so that the largest parts are told.  There is no model here but all motions: what the task
demands of them (in ``compiler``) is necessary only, so that what is told is
true, and much is not told.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import islice

from compiler.tasks.formula_parts import Occurrence, atoms, occurrences, strengthened
from compiler.tasks.formula_slots import TooManySlotsError
from compiler.tasks.formula_text import formula_text
from compiler.tasks.necessary_conditions import (
    NecessaryCondition,
    NecessaryConditions,
    conjuncts,
    necessary_conditions,
)
from grammar_lang import ir
from grammar_lang.diagnostics.codes import Code
from grammar_lang.diagnostics.diagnostic import Diagnostic, Severity, Sink
from grammar_lang.source import Span
from solvers.conflicts.contradiction import ConditionConflicts, contradictions_among

EXTRA_CLAUSES = 40_000
"""After so many clauses for this, nothing more is said of the formulas of a task."""
QUOTED = 40
"""A part whose text is longer is not quoted."""


def vacuities(
    task: ir.Task, asked: NecessaryConditions, conflicts: ConditionConflicts
) -> tuple[Diagnostic, ...]:
    """Warnings about the formulas of a task that does not contradict itself, one each at most."""
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
    """What the demands of a task entail, as far as ``EXTRA_CLAUSES`` for all questions go."""

    asked: NecessaryConditions
    conflicts: ConditionConflicts
    spent: int = 0

    def holds(self, formula: ir.Formula) -> bool:
        """Whether all demands are known to entail a formula.

        Raises:
            TooManySlotsError: the clauses are used up; also from ``reasons``.
        """
        return self.conflicts.exclude([*self.asked.demands, self._denial(formula)])

    def reasons(
        self, formula: ir.Formula, demands: Sequence[NecessaryCondition]
    ) -> tuple[NecessaryCondition, ...] | None:
        """A least part of some demands that entails a formula; None if it is not known to be."""
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
    """The largest part of a conjunct that has no influence, and due to what.

    Args:
        formula: the conjunct.
        number: that of its formula among those of the task.
        entailment: by the demands of the task.
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
    """The parts that have a place of their own in the text: the pieces of a map have none."""
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
    end = f"{float(task.steps * task.step):g} s"
    return Diagnostic(
        Code.VACUOUS_FORMULA,
        Severity.WARNING,
        f"this formula asks for nothing: it holds of every motion {whose}",
        formula.span,
        f"remove it, or check its regions, its windows and the horizon, which ends at {end}",
        _notes(because),
    )


def _idle(task: ir.Task, part: Occurrence, because: Sequence[NecessaryCondition]) -> Diagnostic:
    text = formula_text(part.formula)
    # A piece of a map has a name that is written nowhere, with a point.
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
    """Per place what is asked there."""
    texts: dict[Span, list[str]] = {}
    for demand in sorted(because, key=lambda demand: (demand.span.file, demand.span)):
        texts.setdefault(demand.span, []).append(demand.text)
    return tuple((span, ", ".join(parts)) for span, parts in texts.items())


# --- The checks of the formulas of tasks that need a SAT solver -----------------------------------


def formula_diagnostics(program: ir.Program, sink: Sink) -> None:
    """Report formulas that contradict themselves or their task; if there are no errors, idle ones.

    A program with errors may lack the very clauses that give a formula its sense.  Maps are
    obstacles already.
    """
    warn = not sink.has_errors
    for task in program.tasks.values():
        if task.satisfy:
            sink.found.extend(formula_findings(program, task, warn=warn))


def formula_findings(
    program: ir.Program, task: ir.Task, *, warn: bool = True
) -> tuple[Diagnostic, ...]:
    """Errors about the formulas of a task; without any, warnings if they are wanted."""
    asked = necessary_conditions(program, task)
    if asked is None:
        return ()
    conflicts = ConditionConflicts(asked)
    try:
        errors = contradictions_among(task, asked.demands, conflicts)
        return errors if errors or not warn else vacuities(task, asked, conflicts)
    finally:
        conflicts.close()
