"""A thin adapter to Clarabel: one sparse conic program, a three-valued answer.

minimise (1/2) x'Px + q'x  subject to  Ax + s = b,  s in a product of cones (zero cone first,
then the nonnegative cone, then second-order cones).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import clarabel
import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csc_matrix

Array = NDArray[np.float64]


@dataclass(frozen=True, slots=True)
class ConicProgram:
    """Matrices in compressed columns; ``quadratic`` is the upper triangle of P."""

    quadratic: csc_matrix
    linear: Array
    matrix: csc_matrix
    right: Array
    equalities: int
    inequalities: int
    second_order: tuple[int, ...]


@dataclass(frozen=True, slots=True)
class Optimum:
    """An optimal point and value."""

    point: Array
    value: float


@dataclass(frozen=True, slots=True)
class NotSolved:
    """Anything but a solved program, by the solver's own word; never a proof of anything."""

    status: str


def solve(program: ConicProgram, tolerances: Sequence[float] = (1e-8, 1e-6)) -> Optimum | NotSolved:
    """Solve by interior points; only the status ``Solved`` is an optimum.

    Later tolerances are tried, in order, only where an earlier one was not reached.
    """
    cones: list[object] = [
        clarabel.ZeroConeT(program.equalities),
        clarabel.NonnegativeConeT(program.inequalities),
    ]
    cones += [clarabel.SecondOrderConeT(size) for size in program.second_order]
    status = "NotTried"
    for tolerance in tolerances:
        settings = clarabel.DefaultSettings()
        settings.verbose = False
        settings.max_threads = 1
        settings.tol_gap_abs = settings.tol_gap_rel = settings.tol_feas = tolerance
        solver = clarabel.DefaultSolver(
            program.quadratic, program.linear, program.matrix, program.right, cones, settings
        )
        solution = solver.solve()
        status = str(solution.status)
        if status == "Solved":
            return Optimum(np.asarray(solution.x), float(solution.obj_val))
    return NotSolved(status)
