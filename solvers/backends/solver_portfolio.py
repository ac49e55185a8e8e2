"""What is done about a convex program that a solver does not solve, by the name of the failure.

A program that is infeasible or unbounded is so for every solver.  Any other failure is the
solver's own: the program is given to the next one, which scales it otherwise or works otherwise,
and at last with a wider tolerance.  What none of them solves is *not solved*, never infeasible.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

from compiler.time_limits.time_limit import check_time
from solvers.backends.clarabel import Clarabel
from solvers.backends.conic import (
    ConvexProgram,
    ConvexSolver,
    NotSolved,
    Optimum,
    Status,
    credible,
)
from solvers.backends.piqp import ProximalInteriorPoint

SOLVED = "a convex program was solved"
WIDER = 100.0
"""By how much the tolerance is widened in the last attempt."""
FINAL = frozenset({Status.INFEASIBLE, Status.UNBOUNDED})


def _solvers() -> tuple[ConvexSolver, ...]:
    return ProximalInteriorPoint(), Clarabel(scaled=True), Clarabel(scaled=False)


@dataclass(frozen=True, slots=True)
class SolverPortfolio:
    """Solvers in the order in which they are tried; the first takes no cones."""

    solvers: Sequence[ConvexSolver] = field(default_factory=_solvers)

    def solve(self, program: ConvexProgram, tolerance: float) -> Optimum | NotSolved:
        """The first optimum that is credible; else the last failure."""
        answer: Optimum | NotSolved = NotSolved(Status.FAILED, "no solver")
        solvers = self.solvers if program.cones is None else self.solvers[1:]
        attempts = [(solver, tolerance) for solver in solvers]
        attempts += [(solver, WIDER * tolerance) for solver in solvers[:1]]
        for solver, wanted in attempts:
            check_time()
            answer = _guarded(solver, program, wanted)
            check_time(SOLVED)
            if isinstance(answer, Optimum) or answer.status in FINAL:
                return answer
        return answer


def _guarded(solver: ConvexSolver, program: ConvexProgram, tolerance: float) -> Optimum | NotSolved:
    """The solver's answer, if it is credible; a solver that raises has failed."""
    try:
        return credible(program, solver.solve(program, tolerance))
    except (KeyboardInterrupt, SystemExit):
        raise
    except BaseException as error:  # a panic of a library in Rust is no Exception
        return NotSolved(Status.FAILED, f"{type(error).__name__}: {error}")
