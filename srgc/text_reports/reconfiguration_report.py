"""What a design changes of the existing robot of its task, as text."""

from __future__ import annotations

from compiler.robots.family import family_of
from compiler.robots.reconfiguration import Reconfiguration, reconfiguration
from grammar_lang import ir
from solvers.search.design import Design


def change_of(program: ir.Program, task: ir.Task, design: Design | None) -> Reconfiguration | None:
    """The way from the existing robot of a task to a design; None without one or the other."""
    if design is None or task.origin is None:
        return None
    rules = family_of(program, task).language.srg
    return reconfiguration(rules, task.origin.word, design.derivation.word)


def change_lines(change: Reconfiguration) -> list[str]:
    """The number of modules that change, and the configurations on the way."""
    words = [" ".join(word) for word in change.configurations]
    if len(words) == 1:
        return ["change:  none, this is the existing robot"]
    added, removed = len(change.aligned.added), len(change.aligned.removed)
    edges = "" if added or removed else ", other edges"
    many = "module" if added == 1 else "modules"
    first = f"change:  {added} {many} added, {removed} removed{edges}"
    return [first, *(f"         {step}: {word}" for step, word in enumerate(words))]
