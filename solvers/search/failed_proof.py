"""What a failed proof lacked, in a line of progress, and the shorter steps that may help."""

from __future__ import annotations

import numpy as np

from grammar_lang import ir
from grammar_lang.ir.expression_text import number_text
from solvers.search.search_state import Blocked, Cause
from solvers.verifier.proofs.checked_condition import CheckedCondition

WIDTH = 88
"""The most characters in a line of progress: 100, less a time stamp."""
WIDER = "; widening margins"


def failure_text(blocked: Blocked, *, goes_on: bool) -> str:
    """Which condition was not proved, when, and what it lacked, in at most ``WIDTH`` characters.

    ``goes_on``: a wider margin is tried next.
    """
    end, lacking = WIDER if goes_on else "", blocked.condition
    if lacking is None:
        return f"{blocked.cause.value}{end}"
    # The reason of a condition that stands for the end of an enclosure says all there is to say.
    if lacking.why and not np.isfinite(lacking.margin):
        return _shortened(lacking.reason, end)
    at = "" if lacking.time is None else f" at {lacking.time:.3g} s"
    seen = "is broken in a simulation" if blocked.cause is Cause.BROKEN else "not proved"
    return _shortened(f"`{lacking.name}", f"` {seen}{at}{_lack(lacking)}{end}")


def _lack(condition: CheckedCondition) -> str:
    """By how much a condition is not proved, in words; empty if it is not known."""
    if not (condition.unit and np.isfinite(condition.margin) and condition.margin < 0):
        return ""
    unit = "of the bound" if condition.unit == "1" else condition.unit_text
    return f", lacks {-condition.margin:.2g} {unit}"


def _shortened(head: str, tail: str) -> str:
    """Both in one line; the head is cut off where the line would be too long."""
    most = WIDTH - len(tail)
    return f"{head if len(head) <= most else head[: most - 1] + '…'}{tail}"


def shorter_steps(task: ir.Task) -> str:
    """The horizon of a task in half the steps, as it is written in a task."""
    length = number_text(task.step / 2)
    # Without parentheses, a quotient would be read as that of a number and a time.
    of = f"({length})" if "/" in length else length
    return f"`horizon {'at most ' if task.at_most else ''}{2 * task.steps} steps of {of} s`"
