"""The options of a search: parameter search, convex solver, SMT solvers, gap and workers."""

from __future__ import annotations

import os
from collections.abc import Iterator
from contextlib import contextmanager
from math import inf
from typing import TYPE_CHECKING

from solvers.execution.process_pool import ProcessPool
from solvers.execution.workers import InProcess, Workers, WorkersLostError
from solvers.search.configuration_search import SEARCHES
from srgc.session import NoAnswer, UsageFault

if TYPE_CHECKING:
    from grammar_lang import ir
    from solvers.verifier.refutations.solver_process import SmtSolver

# --- The parameter search -------------------------------------------------------------------------


def named_search(name: str | None) -> str | None:
    """The parameter search with that name; None for the default.

    Raises:
        UsageFault: there is no such search.
    """
    if name is None or name.lower() == SEARCHES[0]:
        return None
    if name.lower() not in SEARCHES:
        known = " and ".join(f"`{each}`" for each in SEARCHES)
        raise UsageFault(f"there is no parameter search `{name}`; known are {known}")
    return name.lower()


# --- The solver of convex programs ----------------------------------------------------------------


OWN = "own"


def named_solver(name: str | None) -> str | None:
    """The solver as cvxpy spells it; None for srgc's own solver, which does not need cvxpy.

    Raises:
        UsageFault: there is no such solver here.
    """
    if name is None or name.lower() == OWN:
        return None
    from solvers.backends.cvxpy_solvers import SolverNameError, solver_called

    try:
        return solver_called(name)
    except SolverNameError as error:
        raise UsageFault(str(error)) from None


# --- The SMT solvers ------------------------------------------------------------------------------


def named_smt_solvers(names: str | None) -> tuple[SmtSolver, ...]:
    """The solvers in a comma-separated list of names; empty for z3 as a library.

    Raises:
        UsageFault: one of them is not installed.
    """
    from solvers.verifier.refutations.solver_process import UnknownSolverError, named_solvers

    try:
        return named_solvers(names)
    except UnknownSolverError as error:
        raise UsageFault(str(error)) from None


# --- The gap that a run has to close --------------------------------------------------------------


def named_gap(text: str | float | None) -> float | None:
    """A gap in percent, written with or without the percent sign.

    Raises:
        UsageFault: it is not a number, or it is negative.
    """
    if text is None:
        return None
    try:
        gap = float(str(text).strip().removesuffix("%").rstrip())
    except ValueError:
        gap = -inf
    if not 0 <= gap < inf:
        raise UsageFault(f"a gap is a percentage of at least 0, such as `5 %`, not `{text}`")
    return gap


def asked_gap(text: str | float | None, task: ir.Task) -> float | None:
    """The gap for a task, in percent.

    Raises:
        UsageFault: it is not a valid gap, or the task has objectives of its own.
    """
    gap = named_gap(text)
    if gap is not None and task.minimize:
        raise UsageFault(
            "a gap is about robustness, and the task has `minimize`: how far the design may be "
            "from the least is proved without it"
        )
    return gap


# --- The workers: this process, other processes, or a cluster -------------------------------------


@contextmanager
def workers_for(jobs: int, cluster: str | None = None) -> Iterator[Workers]:
    """The workers of a run; they are closed when the block ends, however it ends.

    Results are the same for any number of jobs, so that more than ``most_processes()`` are as many.

    Raises:
        UsageFault: the cluster at that address cannot be used.
        NoAnswer: the workers were lost during the block.
    """
    workers = _made(jobs, cluster)
    try:
        yield workers
    except WorkersLostError as error:
        raise NoAnswer(str(error)) from error
    finally:
        workers.close()


def most_processes() -> int:
    """More would only wait for each other: one per processor, but always two."""
    try:
        return max(2, len(os.sched_getaffinity(0)))
    except AttributeError:  # macOS and Windows
        return max(2, os.cpu_count() or 1)


def _made(jobs: int, cluster: str | None) -> Workers:
    if cluster is None:
        return InProcess() if jobs == 1 else ProcessPool(min(jobs, most_processes()))
    from solvers.execution.dask_cluster import ClusterFault, join_cluster

    try:
        return join_cluster(cluster)
    except ClusterFault as fault:
        raise UsageFault(str(fault)) from None
