"""z3 on the text of an SMT-LIB 2 script, with a deterministic budget.

Source: de Moura & Bjørner, *Z3: An Efficient SMT Solver*; Jovanović & de Moura, *Solving Non-linear
Arithmetic* (the procedure behind QF_NRA).  The budget counts z3's own resource units, never
seconds.  The script that is solved is the one that is kept as evidence, byte for byte.
"""

from __future__ import annotations

import z3

from solvers.backends.smt_interrupt import interrupted_late
from solvers.verdict import Answer, Fails, Holds, Reason, Unknown

LOGIC = "QF_NRA"
# Refuted structures of the test suite took 2,000 to 270,000 units (milliseconds); one unit can
# cost 0.1 milliseconds of nonlinear reasoning, so that a larger budget buys minutes of silence.
RESOURCES = 1_000_000


def solve_script(script: str, *, resources: int = RESOURCES) -> Answer[None, None]:
    """Decide a QF_NRA script: ``Holds`` is sat, ``Fails`` is unsat, all else is ``Unknown``.

    Raises:
        OutOfTimeError: the limit of time that holds here was reached; there is no answer.
        ValueError: the script does not parse, or the budget is not positive.
        KeyboardInterrupt: the user interrupted z3, which takes the signal for itself meanwhile.
    """
    if resources < 1:
        raise ValueError("a budget is at least one unit")
    context = z3.Context()
    solver = z3.SolverFor(LOGIC, ctx=context)
    solver.set("rlimit", resources)
    try:
        solver.from_string(script)
    except z3.Z3Exception as error:
        raise ValueError(f"not an SMT-LIB 2 script: {error}") from error
    with interrupted_late(context):
        try:
            answer = solver.check()
        except Exception as error:
            return Unknown(Reason.FAILED, f"{type(error).__name__}: {error}")
    if answer == z3.unsat:
        return Fails(None)
    if answer == z3.sat:
        return Holds(None)
    reason = solver.reason_unknown()
    if "interrupted" in reason:
        raise KeyboardInterrupt
    if "resource" in reason or "canceled" in reason:
        return Unknown(Reason.RESOURCE_LIMIT, f"after {resources} z3 resource units")
    return Unknown(Reason.INCOMPLETE, reason)
