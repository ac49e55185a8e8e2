"""The limit of time of what is being computed, which every long loop asks about.

A loop that may take seconds calls :func:`check_time`, however deep below a search it is, and passes
nothing down.  Without a limit the call does nothing.  What comes out is an exception: a step that
the limit has cut has no result.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import TypeAlias

Reached: TypeAlias = Callable[[], bool]
"""Whether the limit is reached; once it is, it stays so."""


class OutOfTimeError(Exception):
    """The limit was reached.

    ``step`` names what went before and could not be interrupted; it is empty where loops asked.
    """

    def __init__(self, step: str = "") -> None:
        super().__init__(step)
        self.step = step


_REACHED: ContextVar[Reached | None] = ContextVar("reached", default=None)


@contextmanager
def time_limit(reached: Reached | None) -> Iterator[None]:
    """In the block that limit holds, and no other; None: none holds."""
    token = _REACHED.set(reached)
    try:
        yield
    finally:
        _REACHED.reset(token)


def current_limit() -> Reached | None:
    """The limit that holds here, for another thread to ask about."""
    return _REACHED.get()


def is_late() -> bool:
    """Whether the limit that holds here is reached."""
    reached = _REACHED.get()
    return reached is not None and reached()


def check_time(step: str = "") -> None:
    """End what is being computed if its limit is reached.

    Args:
        step: what was done since the last call, where that is one call of a library that takes
            seconds.

    Raises:
        OutOfTimeError: the limit is reached.
    """
    if is_late():
        raise OutOfTimeError(step)
