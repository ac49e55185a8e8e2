"""A question to z3 that a limit of time ends, from another thread: z3 itself asks nobody."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass, field
from threading import Event, Thread

import z3

from compiler.time_limits.time_limit import OutOfTimeError, Reached, current_limit

PULSE = 0.05
"""Seconds between two looks at the limit."""


@contextmanager
def interrupted_late(context: z3.Context) -> Iterator[None]:
    """In the block z3 is interrupted once the limit that holds here is reached.

    Whatever z3 has answered then is not taken for an answer: the block ends with an exception.

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
    """Looks at the limit until the question is ``over``; ``late``: the limit came first."""

    context: z3.Context
    reached: Reached
    over: Event = field(default_factory=Event)
    late: bool = False

    def run(self) -> None:
        """Interrupt z3 again and again: an interrupt that comes between two steps is lost."""
        while not self.over.wait(PULSE):
            if self.late or self.reached():
                self.late = True
                self.context.interrupt()
