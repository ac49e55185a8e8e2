"""A task together with its program, and copies of both with changes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from compiler.tasks.obstacle_pieces import expanded
from grammar_lang import ir


@dataclass(frozen=True, slots=True)
class PosedTask:
    """A task of a program. A change to one of them is made in both."""

    program: ir.Program
    task: ir.Task

    @property
    def workspace(self) -> ir.Workspace:
        """The workspace of the task."""
        return self.program.workspaces[self.task.workspace]

    @property
    def modules(self) -> tuple[ir.Module, ...]:
        """The modules that the grammar of the task mentions, as declared."""
        productions = self.program.grammars[self.task.grammar].productions
        named = {symbol.name for production in productions for symbol in production.right}
        return tuple(module for name, module in self.program.modules.items() if name in named)

    def with_task(self, **changes: Any) -> PosedTask:
        """A copy with fields of the task replaced."""
        task = replace(self.task, **changes)
        tasks = {**self.program.tasks, task.name: task}
        return PosedTask(replace(self.program, tasks=tasks), task)

    def with_workspace(self, workspace: ir.Workspace) -> PosedTask:
        """A copy with another workspace of the same name."""
        workspaces = {**self.program.workspaces, workspace.name: workspace}
        return PosedTask(replace(self.program, workspaces=workspaces), self.task)

    def with_module(self, module: ir.Module) -> PosedTask:
        """A copy with another module of the same name."""
        modules = {**self.program.modules, module.name: module}
        return PosedTask(replace(self.program, modules=modules), self.task)

    def with_domain(self, module: str, name: str, domain: ir.Interval | ir.Choices) -> PosedTask:
        """A copy with another range of a parameter."""
        old = self.program.modules[module]
        parameters = tuple(
            replace(each, domain=domain) if each.name == name else each for each in old.parameters
        )
        return self.with_module(replace(old, parameters=parameters))

    def with_dof(self, module: str, name: str, **changes: Any) -> PosedTask:
        """A copy with a degree of freedom of a module changed."""
        old = self.program.modules[module]
        dofs = tuple(replace(d, **changes) if d.name == name else d for d in old.dofs)
        return self.with_module(replace(old, dofs=dofs))

    def without_avoided(self, clause: int, region: str) -> PosedTask:
        """A copy with a region removed from an ``avoid``."""
        old = self.task.avoid[clause]
        kept = tuple(name for name in old.regions if name != region)
        avoid = list(self.task.avoid)
        avoid[clause] = replace(old, regions=kept)
        return self.with_task(avoid=tuple(avoid))

    def expanded(self) -> PosedTask:
        """A copy with maps as regions, as the solvers need it.

        Raises:
            MapFault: a map of obstacles cannot be used.
        """
        return PosedTask(*expanded(self.program, self.task))
