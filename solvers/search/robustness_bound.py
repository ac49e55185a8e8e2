"""The search for an upper bound on the share of their bounds that a design's inputs leave free.

A design whose inputs leave the share s free also does the task with bounds reduced by s.  If all
structures are refuted in that task, there is no such design.  Shares are multiples of 1 / ``GRID``.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from compiler.robots.normal_form import RobotFamily
from compiler.tasks.tightened import tightened
from grammar_lang import ir
from solvers.impossibility.drive_search import AFTER_MOTIONS, DriveEffort
from solvers.run_context import RunContext
from solvers.search.narrowed_family import NarrowedFamily, NoBoundError, Tried, narrowed_family

GRID = 10_000
"""Shares are multiples of 1 / ``GRID``: they are stated with four decimals."""
FINER = DriveEffort((1024,), 16)
"""The effort if a bound leaves a larger gap than was asked for."""


@dataclass(frozen=True, slots=True)
class RobustnessBound:
    """No robot leaves more than ``share`` free; ``evidence`` is about the reduced bounds."""

    share: Fraction
    evidence: NarrowedFamily


@dataclass(frozen=True, slots=True)
class _Shares:
    """Reduce the bounds of inputs by 1 / ``GRID`` per step."""

    most: int = GRID - 1
    name: str = "bound"
    none: str = "no share is shown to be too much"
    reason: str = "its inputs cannot keep this share"

    def at(self, program: ir.Program, task: ir.Task, step: int) -> tuple[ir.Program, ir.Task]:
        """The program and its task with bounds reduced by a share."""
        return tightened(program, task, Fraction(step, GRID))


def robustness_bound(
    family: RobotFamily,
    task: ir.Task,
    context: RunContext,
    tried: Tried,
    best: float,
    effort: DriveEffort = AFTER_MOTIONS,
) -> RobustnessBound:
    """A bound on the share of all designs of a family, up to the task's bound on modules.

    Args:
        family: the whole family of the task, without maps.
        task: the task, without maps; without a bound on modules and with an infinite language, the
            bound is about ``DEFAULT_MODULES``.
        context: how to search; its journal avoids repeating questions.
        tried: what is known of the family.
        best: the share of a design; no bound below it is possible.
        effort: how hard to try to show that drives are too weak.

    Raises:
        NoBoundError: if no bound was found.
    """
    first = int(best * GRID) + 1
    if not first < GRID:
        raise NoBoundError("the design leaves nothing to gain")
    found = narrowed_family(family, task, context, tried, _Shares(), first, effort)
    return RobustnessBound(Fraction(found.step, GRID), found)
