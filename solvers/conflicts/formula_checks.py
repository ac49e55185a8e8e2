"""The checks of the formulas of tasks that need a SAT solver."""

from __future__ import annotations

from compiler.tasks.necessary_conditions import task_demands
from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Diagnostic, Sink
from solvers.conflicts.contradiction import contradictions_among
from solvers.conflicts.demand_conflicts import DemandConflicts
from solvers.conflicts.vacuity import vacuities


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
    asked = task_demands(program, task)
    if asked is None:
        return ()
    conflicts = DemandConflicts(asked)
    try:
        errors = contradictions_among(task, asked.demands, conflicts)
        return errors if errors or not warn else vacuities(task, asked, conflicts)
    finally:
        conflicts.close()
