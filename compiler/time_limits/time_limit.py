"""The time limit of the current computation, which every long loop checks.

A loop that may take seconds calls :func:`check_time`, however deep in a search it runs; no argument
is passed down. Without a limit the call does nothing. When the limit is reached, it raises an
exception: an interrupted step has no result.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TypeAlias

Reached: TypeAlias = Callable[[], bool]
"""Whether the limit is reached; once reached, it stays reached."""


class OutOfTimeError(Exception):
    """The limit was reached.

    ``step`` names the preceding step, which could not be interrupted; it is empty if a loop
    checked.
    """

    def __init__(self, step: str = "") -> None:
        super().__init__(step)
        self.step = step


_REACHED: ContextVar[Reached | None] = ContextVar("reached", default=None)


@contextmanager
def time_limit(reached: Reached | None) -> Iterator[None]:
    """Apply this limit and no other within the block; with None, no limit applies."""
    token = _REACHED.set(reached)
    try:
        yield
    finally:
        _REACHED.reset(token)


def current_limit() -> Reached | None:
    """The limit that applies here, so that another thread can check it."""
    return _REACHED.get()


def is_late() -> bool:
    """Whether the limit that applies here is reached."""
    reached = _REACHED.get()
    return reached is not None and reached()


def check_time(step: str = "") -> None:
    """Raise an exception if the limit that applies here is reached.

    Args:
        step: the work done since the last call, if that was one library call that takes seconds.

    Raises:
        OutOfTimeError: the limit is reached.
    """
    if is_late():
        raise OutOfTimeError(step)
