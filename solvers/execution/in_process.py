"""Jobs done in this process, one after the other."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator

from solvers.execution.workers import Job, Result


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
