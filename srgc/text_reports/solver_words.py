"""Removes the convex solvers' own answers and codes from texts, as few readers need them."""

from __future__ import annotations

import re

from solvers.backends.conic import Status
from solvers.search.search_state import Cause
from solvers.trajectory.control_problem import Ending

_STATUSES = "|".join(re.escape(status.value) for status in Status)
_DETAIL = r" \((?:[^()]|\([^()]*\))*\)| \(.*?\)(?=[;,)]|$)"
_ANSWER = re.compile(rf"{Ending.UNSOLVED.value}: (?:{_STATUSES})(?:{_DETAIL})?", re.MULTILINE)


def without_solver_words(text: str) -> str:
    """A text that still says that a program was not solved, but not the solver's own status."""
    return _ANSWER.sub(Cause.UNSOLVED.value, text)
