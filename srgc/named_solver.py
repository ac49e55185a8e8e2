"""Which solver of convex programs a run is asked to use."""

from __future__ import annotations

from srgc.session import UsageFault

OWN = "own"


def named_solver(name: str | None) -> str | None:
    """The solver as cvxpy spells it; None for our own programs, which need no cvxpy.

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
