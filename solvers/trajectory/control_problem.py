"""What a control synthesis is asked, how hard it is to try, and what it answers."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from solvers.trajectory.convex_step import ConvexStep, StepMaker
from solvers.trajectory.linear_model import PositionRows
from solvers.trajectory.task_limits import InputGroup, MotionLimits, effort_scale
from solvers.trajectory.trajectory import Trajectory

RowsOf = Callable[[Array], PositionRows]
"""Position rows for the positions (k + 1, m, d) of a reference trajectory."""

ROUNDING = 1e-7
"""Inputs that leave their bounds by no more, relatively, have left them by rounding."""


@dataclass(frozen=True, slots=True)
class ControlProblem:
    """A robot, its limits and its time grid; positions are constrained by ``rows_of``.

    ``steps`` makes what solves the convex steps.
    """

    numeric: NumericRobot
    dt: float
    substeps: int
    limits: MotionLimits
    groups: tuple[InputGroup, ...]
    rows_of: RowsOf
    steps: StepMaker = field(default=ConvexStep)

    @property
    def scale(self) -> float:
        """The unit in which defects are weighed."""
        return effort_scale(self.groups)


@dataclass(frozen=True, slots=True)
class IterationBudget:
    """How hard to try: iterations, the relative gain that ends them, accuracy, polishing.

    A polishing step is a convex step that hardly moves: it leaves defects of second order only.
    The iteration ends when so many steps in a row have gained nothing (``quiet``), moves being
    cheaper from one to the next: while they are dear, a small gain says little.  Nor is it the end
    while steps cause defects beyond ``calm``, relative to the effort bound.  With violations that
    remain, it ends after one more.
    """

    iterations: int
    tolerance: float
    accuracy: float
    polish_steps: int
    quiet: int = 1
    calm: float = 0.05


FULL = IterationBudget(60, 1e-5, 1e-9, 6, 2, 2e-3)
SURVEY = IterationBudget(8, 2e-3, 1e-6, 2)
"""Enough to compare parameters with each other."""


@dataclass(frozen=True, slots=True)
class ControlOutcome:
    """Where the iteration ended.

    ``robustness`` is rho where ``feasible``, else minus the largest violation in units of effort;
    ``fictitious`` (k,) is the largest component of each v_i, ``excess`` the position excess (m),
    ``defect`` the largest one that convex steps left (SI), before the motion was simulated.
    """

    trajectory: Trajectory
    feasible: bool
    robustness: float
    effort_peak: float
    fictitious: Array
    excess: float
    iterations: int
    status: str
    defect: float = 0.0


def input_margin(groups: tuple[InputGroup, ...], u: Array) -> float:
    """The least margin over all steps and groups."""
    return min((group.margin(u) for group in groups), default=0.0)


def effort_peak(groups: tuple[InputGroup, ...], u: Array) -> float:
    """The largest effort over all steps, of whichever group attains it."""
    return max(
        (
            float(np.max(np.linalg.norm(u[:, list(g.inputs)], axis=1), initial=0.0))
            if g.norm2
            else float(np.max(np.abs(u[:, list(g.inputs)]), initial=0.0))
            for g in groups
            if g.effort
        ),
        default=0.0,
    )


def within_bounds(groups: tuple[InputGroup, ...], u: Array) -> Array:
    """Inputs (k, m) with what rounding left outside their bounds put back on them."""
    kept = u.copy()
    for group in groups:
        columns = list(group.inputs)
        if group.norm2:
            continue
        clipped = np.clip(u[:, columns], group.lower, group.upper)
        near = np.abs(clipped - u[:, columns]) <= ROUNDING * (1 + abs(group.upper))
        kept[:, columns] = np.where(near, clipped, u[:, columns])
    return kept
