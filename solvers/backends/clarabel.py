"""A thin adapter to Clarabel: convex programs, second-order cones included.

Source: Goulart & Chen, *Clarabel: An interior-point solver for conic programs with quadratic
objectives*.
"""

from __future__ import annotations

from dataclasses import dataclass

import clarabel
import numpy as np
from scipy.sparse import csc_matrix, identity, vstack

from compiler.arrays import Array
from solvers.backends.conic import ConvexProgram, NotSolved, Optimum, Status

STATUSES = {
    "PrimalInfeasible": Status.INFEASIBLE,
    "AlmostPrimalInfeasible": Status.NUMERICS,
    "DualInfeasible": Status.UNBOUNDED,
    "AlmostDualInfeasible": Status.NUMERICS,
    "AlmostSolved": Status.INACCURATE,
    "MaxIterations": Status.ITERATION_LIMIT,
    "MaxTime": Status.TIME_LIMIT,
    "NumericalError": Status.NUMERICS,
    "InsufficientProgress": Status.NUMERICS,
}


@dataclass(frozen=True, slots=True)
class Clarabel:
    """Clarabel on one thread; ``scaled`` says whether it equilibrates the matrices first."""

    scaled: bool = True

    def solve(self, program: ConvexProgram, tolerance: float) -> Optimum | NotSolved:
        """An optimum, or the reason why there is none: only ``Solved`` counts as an optimum."""
        matrix, right, below = _stacked(program)
        sizes = () if program.cones is None else program.cones.sizes
        cones: list[object] = [
            clarabel.ZeroConeT(len(program.equal_right)),
            clarabel.NonnegativeConeT(below),
        ]
        cones += [clarabel.SecondOrderConeT(size) for size in sizes]
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        settings.max_threads = 1
        settings.equilibrate_enable = self.scaled
        settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = tolerance
        steps = np.arange(len(program.linear) + 1)
        shape = (len(steps) - 1,) * 2
        quadratic = csc_matrix((program.quadratic, steps[:-1], steps), shape=shape)
        solver = clarabel.DefaultSolver(quadratic, program.linear, matrix, right, cones, settings)
        solution = solver.solve()
        name = str(solution.status)
        if name != "Solved":
            return NotSolved(STATUSES.get(name, Status.FAILED), name)
        return Optimum(np.asarray(solution.x), float(solution.obj_val))


def _stacked(program: ConvexProgram) -> tuple[csc_matrix, Array, int]:
    """All rows with their right sides, and the number of inequalities including bounds."""
    unit = identity(len(program.linear), format="csr")
    above, below = np.isfinite(program.upper), np.isfinite(program.lower)
    blocks = [program.equal, program.less, unit[above], -unit[below]]
    right = [program.equal_right, program.less_right, program.upper[above], -program.lower[below]]
    inequalities = sum(len(part) for part in right[1:])
    if program.cones is not None:
        blocks.append(program.cones.matrix)
        right.append(program.cones.right)
    return csc_matrix(vstack(blocks, format="csc")), np.concatenate(right), inequalities
