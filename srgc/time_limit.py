"""The time that a command may take, from when it was begun."""

from __future__ import annotations

import time
from contextlib import AbstractContextManager
from dataclasses import dataclass, field

TOLERATED = 1.0
"""Seconds beyond the limit that need no explanation."""


@dataclass(frozen=True, slots=True)
class TimeLimit:
    """So many seconds from ``begun``; None: no limit."""

    seconds: float | None = None
    begun: float = field(default_factory=time.monotonic)

    @property
    def passed(self) -> float:
        """Seconds since the beginning."""
        return time.monotonic() - self.begun

    def reached(self) -> bool:
        """Whether the limit is reached."""
        return self.seconds is not None and self.passed > self.seconds

    def holds(self) -> AbstractContextManager[None]:
        """In the block, whatever takes long ends with OutOfTimeError once the limit is reached."""
        from compiler.time_limits.time_limit import time_limit  # not for help and completion

        return time_limit(None if self.seconds is None else self.reached)

    def overrun(self, step: str) -> str:
        """What is to be said of a limit that was passed by more than is tolerated; else nothing.

        Args:
            step: what could not be interrupted, where that is known.
        """
        beyond = 0.0 if self.seconds is None else self.passed - self.seconds
        if beyond <= TOLERATED:
            return ""
        what = f"in which {step}" if step else "in a step that cannot be interrupted"
        return f"; it was passed by {beyond:.1f} s, {what}"
