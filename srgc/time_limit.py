"""The time that a command may take, counted from its start."""

from __future__ import annotations

import time
from contextlib import AbstractContextManager
from dataclasses import dataclass, field

TOLERATED = 1.0
"""Seconds beyond the limit that are not reported."""


@dataclass(frozen=True, slots=True)
class TimeLimit:
    """A limit of ``seconds`` from ``begun``; None for no limit."""

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
        """Within the block, long computations raise OutOfTimeError once the limit is reached."""
        from compiler.time_limits.time_limit import time_limit  # keeps help and completion fast

        return time_limit(None if self.seconds is None else self.reached)

    def overrun(self, step: str) -> str:
        """The text about a limit that was exceeded by more than is tolerated; else empty.

        Args:
            step: what could not be interrupted, if known.
        """
        beyond = 0.0 if self.seconds is None else self.passed - self.seconds
        if beyond <= TOLERATED:
            return ""
        what = f"in which {step}" if step else "in a step that cannot be interrupted"
        return f"; it was passed by {beyond:.1f} s, {what}"
