"""A thin adapter to cvxpy: programs written in it, and the solvers that it calls by name.

Source: Diamond & Boyd, *CVXPY: A Python-embedded modeling language for convex optimization*. cvxpy
is imported only on use.
"""

from __future__ import annotations

import warnings
from importlib.util import find_spec
from typing import TYPE_CHECKING

import numpy as np

from solvers.backends.conic import CREDIBLE, NotSolved, Status

if TYPE_CHECKING:
    import cvxpy as cp

STATUSES = {
    "infeasible": Status.INFEASIBLE,
    "unbounded": Status.UNBOUNDED,
    "optimal_inaccurate": Status.INACCURATE,
    "infeasible_inaccurate": Status.NUMERICS,
    "unbounded_inaccurate": Status.NUMERICS,
    "infeasible_or_unbounded": Status.NUMERICS,
    "user_limit": Status.ITERATION_LIMIT,
    "solver_error": Status.NUMERICS,
}
TOLERANCES = {
    "CLARABEL": ("tol_gap_abs", "tol_gap_rel", "tol_feas"),
    "ECOS": ("abstol", "reltol", "feastol"),
    "PIQP": ("eps_abs", "eps_rel", "eps_duality_gap_abs", "eps_duality_gap_rel"),
}
"""Tolerance settings of the solvers that reach any tolerance; the others keep their own."""
SETTINGS: dict[str, dict[str, float]] = {
    "OSQP": {"polish": False},
    "HIGHS": {"qp_iteration_limit": 5000},
}
"""OSQP prints messages when polishing; HiGHS's active-set method has been seen to run for ever."""


class SolverNameError(Exception):
    """There is no such solver here; the message lists the available ones."""


def solver_called(name: str) -> str:
    """The name of an installed solver, in cvxpy's spelling.

    Raises:
        SolverNameError: the solver is not installed or cannot solve quadratic programs, or cvxpy is
            missing.
    """
    if find_spec("cvxpy") is None:
        raise SolverNameError(f'solver `{name}` needs cvxpy: pip install "srgc[solvers]"')
    import cvxpy as cp

    installed: list[str] = sorted(cp.installed_solvers())
    found = next((known for known in installed if known.upper() == name.upper()), None)
    if found is None:
        raise SolverNameError(
            f"there is no solver `{name}` here; there are: own, {', '.join(installed)}"
        )
    x = cp.Variable()
    trial = cp.Problem(cp.Minimize(x**2 - x), [x <= 2])
    answer = solved(trial, found, 1e-8)
    if answer is not None:
        raise SolverNameError(
            f"solver `{found}` does not solve a small quadratic program: "
            f"{answer.detail or answer.status.value}"
        )
    return found


def solved(problem: cp.Problem, solver: str, tolerance: float) -> NotSolved | None:
    """Solve a program; return None if it was solved, otherwise the reason why not.

    If solved, its variables have values. Only ``optimal`` counts as an optimum, and only if no
    constraint is violated.
    """
    settings = dict.fromkeys(TOLERANCES.get(solver, ()), tolerance) | SETTINGS.get(solver, {})
    try:
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")  # the status says the same
            problem.solve(solver=solver, **settings)
            status = str(problem.status)
            if status == "optimal":
                return None if _is_credible(problem) else NotSolved(Status.NOT_CREDIBLE)
    except (KeyboardInterrupt, SystemExit):
        raise
    except BaseException as error:  # a panic in a Rust library is not an Exception
        return NotSolved(Status.FAILED, f"{type(error).__name__}: {error}")
    return NotSolved(STATUSES.get(status, Status.FAILED), status)


def _is_credible(problem: cp.Problem) -> bool:
    """Whether all values are finite and violate no constraint by more than is accepted."""
    values = [variable.value for variable in problem.variables()]
    if any(value is None or not np.isfinite(value).all() for value in values):
        return False
    size = 1 + max((float(np.max(np.abs(value), initial=0.0)) for value in values), default=0.0)
    worst = [np.max(each.violation(), initial=0.0) for each in problem.constraints]
    return bool(np.all(np.array(worst) <= CREDIBLE * size)) and bool(np.isfinite(problem.value))
