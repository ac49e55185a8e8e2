"""Who solves convex steps: the sparse programs of this package, or a solver that cvxpy reaches."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Protocol, TypeAlias

from solvers.backends.conic import NotSolved
from solvers.trajectory.convex_step import ConvexStep
from solvers.trajectory.linear_model import Model, PositionRows
from solvers.trajectory.subproblem import StepQuestion, StepResult, TrustRegion


class StepSolver(Protocol):
    """Solves the convex steps of one question, one after the other."""

    def solve(
        self,
        model: Model,
        rows: PositionRows,
        region: TrustRegion,
        accuracy: float = ...,
        *,
        fictitious: bool = ...,
    ) -> StepResult | NotSolved:
        """The optimum of the step about a trajectory, as :meth:`ConvexStep.solve` gives it."""
        ...


StepMaker: TypeAlias = Callable[[StepQuestion], StepSolver]
"""From a question to what solves its convex steps."""


def step_maker(solver: str | None) -> StepMaker:
    """That of a solver by its name in cvxpy; None means the sparse programs."""
    if solver is None:
        return ConvexStep
    from solvers.trajectory.reference_step import ReferenceStep

    return partial(ReferenceStep, solver=solver)
