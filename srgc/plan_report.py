"""``srgc plan``: the first cell path of a task."""

from __future__ import annotations

from typing import Literal

from compiler.geometry.abstraction import abstract
from grammar_lang import ir
from solvers.planner import path_planner
from solvers.verdict import Holds, Unknown


def plan_text(
    program: ir.Program, task: ir.Task
) -> tuple[Literal["found", "impossible", "unknown"], str]:
    """The path with the fewest region changes, one cell a line; or why there is none."""
    abstraction = abstract(program.workspaces[task.workspace])
    planner = path_planner(abstraction, task)
    match planner.next_path():
        case Holds(witness=path):
            return "found", "\n".join(abstraction.cells[cell].name for cell in path.cells)
        case Unknown(reason=reason):
            return "unknown", f"unknown: {reason.value}"
        case _:
            return "impossible", (
                "no path: no sequence of neighbouring cells leads from the start to the target"
            )
