"""The search for a number of steps in which no robot of a family does its task."""

from __future__ import annotations

from dataclasses import dataclass

from compiler.robots.normal_form import RobotFamily
from compiler.tasks.tightened import shortened
from grammar_lang import ir
from solvers.impossibility.drive_search import AFTER_MOTIONS
from solvers.run_context import RunContext
from solvers.search.narrowed_family import NarrowedFamily, Tried, narrowed_family


@dataclass(frozen=True, slots=True)
class TimeBound:
    """No robot does the task in at most ``steps`` steps; ``evidence`` is about that task."""

    steps: int
    evidence: NarrowedFamily


@dataclass(frozen=True, slots=True)
class _Horizons:
    """Reduce the horizon of ``longest`` steps by one sample per step."""

    longest: int
    fewest: int
    name: str = "time"
    none: str = "no time is shown to be too short"
    reason: str = "it cannot do the task in so few steps"

    @property
    def most(self) -> int:
        """The step at which the horizon is the fewest steps that a motion may take."""
        return self.longest - self.fewest

    def at(self, program: ir.Program, task: ir.Task, step: int) -> tuple[ir.Program, ir.Task]:
        """The same program, with the task's horizon reduced by ``step`` samples."""
        return program, shortened(task, self.longest - step)


def time_bound(
    family: RobotFamily, task: ir.Task, context: RunContext, tried: Tried, best: int
) -> TimeBound:
    """A number of steps, fewer than the ``best`` of any design, in which no robot does the task.

    The task must allow motions of fewer steps than ``best``.

    Raises:
        NoBoundError: if no bound was found.
    """
    horizons = _Horizons(task.steps, task.fewest_steps)
    first = task.steps - (best - 1)
    found = narrowed_family(family, task, context, tried, horizons, first, AFTER_MOTIONS)
    return TimeBound(task.steps - found.step, found)
