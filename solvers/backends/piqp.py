"""A thin adapter to PIQP: for quadratic programs of one pattern only the numbers are updated.

Source: Schwan, Jiang, Kuhn & Jones, *PIQP: A Proximal Interior-Point Quadratic Programming Solver*
(CDC 2023).
"""

from __future__ import annotations

import numpy as np
import piqp
from scipy.sparse import csc_matrix

from solvers.backends.conic import ConvexProgram, NotSolved, Optimum, Status

STATUSES = {
    "PIQP_PRIMAL_INFEASIBLE": Status.INFEASIBLE,
    "PIQP_DUAL_INFEASIBLE": Status.UNBOUNDED,
    "PIQP_MAX_ITER_REACHED": Status.ITERATION_LIMIT,
    "PIQP_NUMERICS": Status.NUMERICS,
}
ITERATIONS = 150
NEARLY_INFINITE = 9e29
"""PIQP treats larger values as infinite and prints a warning."""


class ProximalInteriorPoint:
    """Keeps the solver of the last program's structure, with its ordering and symbolic factors."""

    def __init__(self) -> None:
        self._structure: object = None
        self._solver: piqp.SparseSolver | None = None
        self._diagonal: csc_matrix | None = None

    def solve(self, program: ConvexProgram, tolerance: float) -> Optimum | NotSolved:
        """An optimum, or the reason why there is none; programs with cones are rejected."""
        if program.cones is not None:
            return NotSolved(Status.FAILED, "second-order cones")
        structure, self._structure = self._structure, None  # in case this call fails
        solver = self._prepared(program, tolerance, structure)
        name = solver.solve().name
        if name in ("PIQP_SOLVED", "PIQP_PRIMAL_INFEASIBLE"):
            self._structure = program.structure
        if name != "PIQP_SOLVED":
            return NotSolved(STATUSES.get(name, Status.FAILED), name)
        return Optimum(np.array(solver.result.x), float(solver.result.info.primal_obj))

    def _prepared(
        self, program: ConvexProgram, tolerance: float, structure: object
    ) -> piqp.SparseSolver:
        """The solver with the program's numbers, reused if it has solved one of this structure."""
        solver = self._solver
        if solver is None or program.structure is None or program.structure is not structure:
            solver = piqp.SparseSolver()
            solver.settings.max_iter = ITERATIONS
            steps = np.arange(len(program.linear) + 1)
            self._diagonal = csc_matrix(
                (program.quadratic, steps[:-1], steps), shape=(len(steps) - 1,) * 2
            )
            self._solver = solver
            put = solver.setup
        else:
            put = solver.update
        settings = solver.settings
        settings.eps_abs = settings.eps_duality_gap_abs = tolerance
        settings.eps_rel = settings.eps_duality_gap_rel = tolerance
        diagonal = self._diagonal
        if diagonal is not None:
            diagonal.data = program.quadratic
        put(
            P=diagonal, c=program.linear, A=program.equal, b=program.equal_right, G=program.less,
            h_u=np.clip(program.less_right, -NEARLY_INFINITE, NEARLY_INFINITE),
            x_l=program.lower, x_u=program.upper,
        )  # fmt: skip
        return solver
