"""The way of a task through the cells of its workspace."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

from srgc.api.program import Program
from srgc.api.spoken_faults import spoken
from srgc.faults import UsageFault
from srgc.session import chosen, refuse_unsupported

if TYPE_CHECKING:
    from srgc.text_reports.plan_report import PlanReport


@dataclass(frozen=True, slots=True)
class Plan:
    """The cells that effectors go through, or why there is no such way; it draws itself.

    Attributes:
        report: the answer with its cells; not a stable interface.
        title: what stands above the picture.
    """

    report: PlanReport
    title: str

    @property
    def verdict(self) -> Literal["found", "impossible", "unknown"]:
        """Whether there is a plan."""
        return self.report.verdict

    @property
    def cells(self) -> tuple[str, ...]:
        """The names of all cells of the workspace."""
        return tuple(cell.name for cell in self.report.cells.cells)

    @property
    def paths(self) -> dict[int, tuple[str, ...]]:
        """By the number of the effector, from 1, the cells that it goes through, in order."""
        plan, cells = self.report.plan, self.report.cells.cells
        paths = () if plan is None else plan.paths
        return {p.effector + 1: tuple(cells[cell].name for cell in p.cells) for p in paths}

    @property
    def svg(self) -> str:
        """The cells, their labels and adjacency, and the path if there is one."""
        return self.report.picture(self.title)

    def __repr__(self) -> str:
        ways = "; ".join(" > ".join(path) for path in self.paths.values())
        return f"<Plan: {ways or self.report.text}>"

    def __str__(self) -> str:
        return self.report.text

    def _repr_html_(self) -> str:
        from srgc.api.displays import plan_html

        return plan_html(self.report, self.title)


@spoken
def plan(program: Program, task: str | None = None, *, cells: int | None = None) -> Plan:
    """Plan the cells that a task's effectors go through, with the fewest changes.

    A plan is not about robots: ``synthesize`` finds one that follows it.

    Args:
        program: the specification.
        task: which one; may be left out where there is one.
        cells: begin with at least so many cells.

    Raises:
        SrgcError: there is no such task, or it has a clause that is not supported.
    """
    from srgc.text_reports.plan_report import plan_report

    if cells is not None and cells < 1:
        raise UsageFault("`cells` counts from 1")
    chosen_task = chosen(program.ir.tasks, task, "task")
    refuse_unsupported(program.ir, chosen_task)
    report = plan_report(program.ir, chosen_task, cells)
    return Plan(report, f"{program.name}, task {chosen_task.name}")
