"""What does jobs: one after the other or many at once, with the same results."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Protocol, TypeVar

Job = TypeVar("Job")
Result = TypeVar("Result")


ENDED = "all workers that began a job ended in the middle of it; perhaps there was no memory left"
DISCONNECTED = "the connection to the workers was lost"


class WorkersLostError(Exception):
    """A job could not be finished: every worker that tried it ended, or none can be reached."""


class Workers(Protocol):
    """Does jobs.  A function is pure and found by its name in a module; jobs can be pickled.

    The same jobs have the same results, whoever does them and in whichever order.
    """

    @property
    def width(self) -> int:
        """How many jobs are done at once."""
        ...

    def map(self, function: Callable[[Job], Result], jobs: Iterable[Job]) -> Iterator[Result]:
        """The results in the order of the jobs.

        Jobs are drawn while a result is waited for only, and no more than ``width`` are unfinished
        at any time: with a width of 1 nothing is done before it is needed.  An iterator that is
        closed or forgotten abandons its jobs.

        Raises:
            WorkersLostError: see there.
        """
        ...

    def close(self) -> None:
        """End the workers, whatever they are doing."""
        ...


# --- Jobs done in this process, one after the other -----------------------------------------------


class InProcess:
    """Does each job when its result is asked for."""

    @property
    def width(self) -> int:
        """One job at a time."""
        return 1

    def map(self, function: Callable[[Job], Result], jobs: Iterable[Job]) -> Iterator[Result]:
        """The results in the order of the jobs."""
        return map(function, jobs)

    def close(self) -> None:
        """Nothing has to be ended."""
