"""The usual solver of convex programs: several solvers in turn, which can always be interrupted.

PIQP and Clarabel neither ask for the time nor let another thread run.  A program of thousands of
steps keeps them busy for seconds, and a difficult one for minutes, in which no limit of time and no
signal would be noticed.  So large programs are solved in a process of their own, which can be
killed: what it was doing is then no answer at all (decision 148).
"""

from __future__ import annotations

import atexit
from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from itertools import count
from multiprocessing import parent_process
from typing import TYPE_CHECKING
from weakref import finalize

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

if TYPE_CHECKING:
    from solvers.execution.process_pool import ProcessPool

# --------------------------------------------------------------------------------------------------
# What happens if a solver does not solve a convex program, by the kind of failure.
#
# A program that is infeasible or unbounded is so for every solver.  Any other failure is the
# solver's own: the program is passed to the next solver, which scales it differently or uses
# another method, and finally solved with a wider tolerance.  A program that no solver solves is
# *not solved*; this never means infeasible.


SOLVED = "a convex program was solved"
WIDER = 100.0
"""The factor by which the tolerance is widened in the last attempt."""
FINAL = frozenset({Status.INFEASIBLE, Status.UNBOUNDED})


def _solvers() -> tuple[ConvexSolver, ...]:
    return ProximalInteriorPoint(), Clarabel(scaled=True), Clarabel(scaled=False)


@dataclass(frozen=True, slots=True)
class SolverPortfolio:
    """Solvers in the order in which they are tried; the first does not support cones."""

    solvers: Sequence[ConvexSolver] = field(default_factory=_solvers)

    def solve(self, program: ConvexProgram, tolerance: float) -> Optimum | NotSolved:
        """The first credible optimum; else the last failure."""
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
    """The solver's answer, if it is credible; a solver that raises an exception has failed."""
    try:
        return credible(program, solver.solve(program, tolerance))
    except (KeyboardInterrupt, SystemExit):
        raise
    except BaseException as error:  # a panic in a Rust library is not an Exception
        return NotSolved(Status.FAILED, f"{type(error).__name__}: {error}")


# --------------------------------------------------------------------------------------------------
# Large programs in another process.
#
# The other process has a portfolio for each one here, so that what a solver keeps from one program
# for the next is the same as here, and so are the answers, bit for bit.


LARGE = 5_000
"""Programs with at least this many unknowns are solved in another process: two joints and 400
steps.  There they take 0.1 s and more, to which sending them adds a hundredth."""


@dataclass(slots=True)
class UsualSolver:
    """The portfolio, which for large programs is in another process.

    A process that works for another one, and is killed by that, solves all programs itself.
    """

    _portfolio: ConvexSolver = field(default_factory=SolverPortfolio)

    def solve(self, program: ConvexProgram, tolerance: float) -> Optimum | NotSolved:
        """As :meth:`SolverPortfolio.solve`.

        Raises:
            OutOfTimeError: the current time limit was reached; a program is abandoned for it.
        """
        apart = len(program.linear) >= LARGE and parent_process() is None
        # Programs of one structure have one size, so nothing that is kept for the next one is lost.
        if apart != isinstance(self._portfolio, _PortfolioApart):
            self._portfolio = _PortfolioApart() if apart else SolverPortfolio()
        return self._portfolio.solve(program, tolerance)


@dataclass(frozen=True, slots=True)
class _Question:
    """A program for the portfolio with a ``number``; ``forgotten`` portfolios are needed no more.

    The structure of the program is a number.
    """

    number: int
    program: ConvexProgram
    tolerance: float
    forgotten: tuple[int, ...]


class _PortfolioApart:
    """A portfolio in the other process."""

    def __init__(self) -> None:
        self._number = next(_NUMBERS)
        finalize(self, _OTHER.forgotten.append, self._number).atexit = False
        self._structure: object = None
        self._structures = 0

    def solve(self, program: ConvexProgram, tolerance: float) -> Optimum | NotSolved:
        if program.structure is None or program.structure is not self._structure:
            self._structure = program.structure
            self._structures += 1
        given = None if program.structure is None else self._structures
        return _OTHER.answer(self._number, replace(program, structure=given), tolerance)


_NUMBERS = count()


@dataclass(slots=True)
class _OtherProcess:
    """The process that solves large programs, once there was one."""

    forgotten: list[int] = field(default_factory=list[int])
    _pool: ProcessPool | None = None

    def answer(self, number: int, program: ConvexProgram, tolerance: float) -> Optimum | NotSolved:
        """The answer of a portfolio; whatever ends the wait for it ends the process, too."""
        from solvers.execution.in_order import in_order
        from solvers.execution.process_pool import ProcessPool
        from solvers.execution.workers import WorkersLostError

        gone = tuple(self.forgotten)
        del self.forgotten[: len(gone)]
        if self._pool is None:
            self._pool = ProcessPool(1)
            atexit.register(self.end)
        try:
            return next(
                in_order(self._pool, _answered, [_Question(number, program, tolerance, gone)])
            )
        except WorkersLostError as error:
            return NotSolved(Status.FAILED, str(error))
        except BaseException:
            self.end()
            raise

    def end(self) -> None:
        """End the process, whatever it is doing; the next question starts another."""
        pool, self._pool = self._pool, None
        if pool is not None:
            pool.close()
            atexit.unregister(self.end)


_OTHER = _OtherProcess()


@dataclass(slots=True)
class _Kept:
    """A portfolio in this process, and the structure of its last program."""

    portfolio: SolverPortfolio = field(default_factory=SolverPortfolio)
    structure: object = None


_KEPT: dict[int, _Kept] = {}


def _answered(question: _Question) -> Optimum | NotSolved:
    """Answer a question of the process that has started this one."""
    for number in question.forgotten:
        _KEPT.pop(number, None)
    kept = _KEPT.setdefault(question.number, _Kept())
    if question.program.structure != kept.structure:
        kept.structure = question.program.structure
    program = replace(question.program, structure=kept.structure)
    return kept.portfolio.solve(program, question.tolerance)
