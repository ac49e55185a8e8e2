"""One job at a time in a process: the solver libraries keep state that threads would share."""

from __future__ import annotations

from collections.abc import Callable
from threading import Lock

from solvers.execution.workers import Job, Result

_BUSY = Lock()


def one_job(function: Callable[[Job], Result], job: Job) -> Result:
    """Do a job when no other thread of this process does one."""
    with _BUSY:
        return function(job)
