r"""One convex step: the dynamics and positions linearised about a trajectory.

.. math::
    \max\ (\rho - w_V V) / S - w_\sigma \sigma
    - w_u \lVert u / S \rVert^2 - w_q \lVert q - \hat q \rVert^2
    \quad\text{s.t.}\quad
    x_{i+1} = A_i x_i + B_i u_i + C_i \theta + r_i + B'_i v_i,\quad
    \lVert u_i \rVert \le \bar u - w \rho,\quad \lVert v_i \rVert_\infty \le V,\quad \rho \ge 0

with the path's half-planes (C.1) softened by ``sigma``.  This is Definition 7 of the paper, but the
fictitious input is kept separate from the effort, so that it can never hide in a sum.  S is the
largest margin of any input, and w that of the input in question over S, so that margins are
relative to their maximum; v is in units of w.  The first quadratic term makes the optimum unique.
The second one, about the reference, vanishes at the fixpoint, so that it changes the way and not
the end.  Rates and mobility may also have prices (``reference_step.py`` has all terms).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial
from typing import Protocol, TypeAlias

import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array
from solvers.backends.conic import ConvexProgram, ConvexSolver, NotSolved
from solvers.backends.portfolio import UsualSolver
from solvers.trajectory.linear_model import LinearRows, Model, PositionRows
from solvers.trajectory.step_program import StepProgram
from solvers.trajectory.subproblem import (
    Indices,
    StepLayout,
    StepResult,
    SubproblemSpec,
    TrustRegion,
)
from solvers.trajectory.trajectory import Trajectory

# --------------------------------------------------------------------------------------------------
# The convex steps of one question, one after the other.
#
# Most half-planes are far from anything that moves.  If there are many, a program contains only
# those of a working set.  If its optimum satisfies the others too, it is optimal for all; otherwise
# the violated ones join the set.  The set only grows, so that its sparsity pattern, and with it the
# solver's symbolic factorisation, soon remains the same.


FEW = 800
"""With at most this many half-planes a program contains all of them."""
CLOSE = 0.05
"""Half-planes closer than this share of what the trust region allows join the working set."""
BROKEN = 10.0
"""The others count as violated from this multiple of the accuracy."""


@dataclass(slots=True)
class ConvexStep:
    """Convex steps by ``solver``; programs of the same structure differ only in their numbers."""

    question: SubproblemSpec
    solver: ConvexSolver = field(default_factory=UsualSolver)
    _programs: dict[bool, StepProgram] = field(default_factory=dict[bool, StepProgram])
    _samples: Indices = field(default_factory=lambda: np.zeros(0, dtype=np.int64))
    _working: NDArray[np.bool_] = field(default_factory=lambda: np.zeros(0, dtype=np.bool_))

    @property
    def working(self) -> int:
        """The number of half-planes in the last program."""
        return int(np.count_nonzero(self._working))

    def solve(
        self,
        model: Model,
        rows: PositionRows,
        region: TrustRegion,
        accuracy: float = 1e-8,
        *,
        fictitious: bool = True,
    ) -> StepResult | NotSolved:
        """The optimum of the step about a trajectory.

        Without ``fictitious`` inputs V is 0: an infeasible step may be feasible with them.
        """
        opened = self.opened(model, rows, region, fictitious=fictitious)
        while True:
            optimum = self.solver.solve(opened.program(), accuracy)
            if isinstance(optimum, NotSolved):
                return optimum
            result = opened.result(optimum.point, accuracy)
            if result is not None:
                return result

    def opened(
        self, model: Model, rows: PositionRows, region: TrustRegion, *, fictitious: bool = True
    ) -> OpenStep:
        """The step about a trajectory, for callers that solve its programs themselves."""
        every = LinearRows.of(model, rows)
        reach = CLOSE * region.radius * np.sum(np.abs(every.by_q), axis=1)
        self._begin(every, reach)
        lay = partial(self._program, model, fictitious=fictitious)
        return OpenStep(model, every, region, reach, self._working, lay)

    def _begin(self, every: LinearRows, reach: Array) -> None:
        """Start the working set: the last one, if it still fits, and the close half-planes."""
        close = every.slack < reach if len(reach) > FEW else np.ones(len(reach), dtype=np.bool_)
        if np.array_equal(self._samples, every.sample):
            close |= self._working
        self._samples, self._working = every.sample, close

    def _program(self, model: Model, samples: Indices, *, fictitious: bool) -> StepProgram:
        """The structure for rows at these samples: the last one, if it still fits."""
        known = self._programs.get(fictitious)
        if known is not None and np.array_equal(known.samples, samples):
            return known
        question, about = self.question, model.about
        k, m = about.u.shape
        layout = StepLayout(
            n=question.limits.joints, width=about.x.shape[1], m=m, k=k,
            p=0 if question.theta_box is None else len(about.theta),
            fictitious=fictitious, slacks=question.epsilon is not None,
        )  # fmt: skip
        self._programs[fictitious] = StepProgram(question, layout, samples)
        return self._programs[fictitious]


@dataclass(slots=True)
class OpenStep:
    """One convex step about a trajectory, until the half-planes outside the working set hold.

    ``rows`` are all half-planes (R,).  Those with slack below ``reach`` (R,) are close, and
    ``working`` (R,) are those in the programs.  ``lay`` gives the structure for their samples.
    """

    model: Model
    rows: LinearRows
    region: TrustRegion
    reach: Array
    working: NDArray[np.bool_]
    lay: Callable[[Indices], StepProgram]
    laid: StepProgram = field(init=False)
    """The structure of the last program."""

    def program(self) -> ConvexProgram:
        """The program with the working set.

        If some of the half-planes make it infeasible, so do all.
        """
        working = np.flatnonzero(self.working)
        self.laid = self.lay(self.rows.sample[working])
        return self.laid.program(self.model, self.rows.taken(working), self.region)

    def result(self, point: Array, accuracy: float) -> StepResult | None:
        """The result for the optimum (N,) of the last program.

        None if it violates other half-planes, which have now joined the working set.
        """
        z, layout, about = self.laid.point(point), self.laid.layout, self.model.about
        moved = z[layout.theta] if layout.p else np.zeros_like(about.theta)
        slack = max(0.0, float(z[layout.sigma]))
        left = self.rows.left(z[layout.x[:, : layout.n]], moved) + slack
        if not np.all(self.working | (left >= -BROKEN * accuracy)):
            self.working |= left < self.reach
            return None
        found = Trajectory(about.x + z[layout.x], z[layout.u], about.theta + moved)
        v = z[layout.v] if layout.fictitious else np.zeros_like(found.x[1:])
        largest = float(np.max(np.abs(v), initial=0.0))
        return StepResult(found, v, largest, slack, float(z[layout.rho]))


# --------------------------------------------------------------------------------------------------
# The solvers of convex steps: the sparse programs of this package, or a solver reached by cvxpy.


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
        """The optimum of the step about a trajectory, as in :meth:`ConvexStep.solve`."""
        ...


StepMaker: TypeAlias = Callable[[SubproblemSpec], StepSolver]
"""Makes a solver for the convex steps of a question."""


def step_maker(solver: str | None) -> StepMaker:
    """The maker for a solver, by its name in cvxpy; None means the sparse programs."""
    if solver is None:
        return ConvexStep
    from solvers.trajectory.reference_step import ReferenceStep

    return partial(ReferenceStep, solver=solver)
