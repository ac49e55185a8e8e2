"""z3 on the text of an SMT-LIB 2 script, with a deterministic budget.

Source: de Moura & Bjørner, *Z3: An Efficient SMT Solver*; Jovanović & de Moura, *Solving Non-linear
Arithmetic* (the procedure behind QF_NRA). The budget counts z3's own resource units, never seconds.
The script that is solved is also the one stored as evidence, byte for byte.
"""

from __future__ import annotations

import signal
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from threading import Event, Thread

import z3

from compiler.time_limits.time_limit import OutOfTimeError, Reached, current_limit
from solvers.verdict import Answer, Fails, Holds, Reason, Unknown

LOGIC = "QF_NRA"
# Refuted structures of the test suite took 2,000 to 270,000 units (milliseconds). One unit can cost
# 0.1 milliseconds of nonlinear reasoning, so a larger budget would mean minutes without an answer.
RESOURCES = 1_000_000


def solve_script(script: str, *, resources: int = RESOURCES) -> Answer[None, None]:
    """Decide a QF_NRA script: ``Holds`` is sat, ``Fails`` is unsat, anything else ``Unknown``.

    Raises:
        OutOfTimeError: the current time limit was reached without an answer.
        ValueError: the script does not parse, or the budget is not positive.
        KeyboardInterrupt: the user interrupted z3, where an interrupt is this exception.
    """
    if resources < 1:
        raise ValueError("a budget is at least one unit")
    context = z3.Context()
    solver = z3.SolverFor(LOGIC, ctx=context)
    solver.set("rlimit", resources)
    # Where Python would raise an exception, once z3 returns, z3 takes the signal and returns soon.
    # A program that handles interrupts in its own way must see the signal at once.
    solver.set("ctrl_c", signal.getsignal(signal.SIGINT) is signal.default_int_handler)
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


# --- z3 under a time limit: another thread interrupts it, since z3 does not check the limit -------


PULSE = 0.05
"""Seconds between two checks of the limit."""


@contextmanager
def interrupted_late(context: z3.Context) -> Iterator[None]:
    """Within the block, z3 is interrupted once the current time limit is reached.

    An answer of z3 after that is not used: the block ends with an exception.

    Raises:
        OutOfTimeError: the limit was reached in the block.
    """
    reached = current_limit()
    if reached is None:
        yield
        return
    if reached():
        raise OutOfTimeError
    watch = _Watch(context, reached)
    thread = Thread(target=watch.run, daemon=True)
    thread.start()
    try:
        yield
    finally:
        watch.over.set()
        thread.join()
    if watch.late:
        raise OutOfTimeError


@dataclass(slots=True)
class _Watch:
    """Checks the limit until the question is ``over``; ``late``: the limit came first."""

    context: z3.Context
    reached: Reached
    over: Event = field(default_factory=Event)
    late: bool = False

    def run(self) -> None:
        """Interrupt z3 repeatedly: an interrupt that comes between two steps is lost."""
        while not self.over.wait(PULSE):
            if self.late or self.reached():
                self.late = True
                self.context.interrupt()
