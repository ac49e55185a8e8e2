"""Results in the order of their jobs, from an executor that finishes them in any order."""

from __future__ import annotations

from collections import deque
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import FIRST_COMPLETED, CancelledError, Future, wait
from dataclasses import dataclass
from typing import Generic, Protocol

from compiler.time_limits.time_limit import check_time
from solvers.execution.workers import DISCONNECTED, ENDED, Job, Result, WorkersLostError

ATTEMPTS = 3
"""A job is given up when its worker has ended this many times before finishing it."""
AHEAD = 4
"""In units of the width: how many jobs may be drawn beyond the one whose result is next."""

PULSE = 0.1
"""Seconds without a result after which liveness and the time limit are checked."""


class Source(Protocol):
    """Starts jobs, and replaces workers that ended."""

    @property
    def width(self) -> int:
        """The number of jobs that run at once."""
        ...

    def start(self, function: Callable[[Job], Result], job: Job) -> Future[Result]:
        """Begin a job."""
        ...

    def is_lost(self, error: BaseException) -> bool:
        """Whether an error says that the worker ended, not that the job failed."""
        ...

    def is_alive(self) -> bool:
        """Whether unfinished jobs can still finish."""
        ...


@dataclass(slots=True)
class _Started(Generic[Job, Result]):
    """A job with its future; ``attempts`` counts how often it was started."""

    job: Job
    future: Future[Result]
    attempts: int = 1


@dataclass(frozen=True, slots=True)
class BegunJob(Generic[Job, Result]):
    """A job that a source runs; it is begun again if its worker ends."""

    source: Source
    function: Callable[[Job], Result]
    started: _Started[Job, Result]

    @property
    def done(self) -> bool:
        """Whether the job has ended, with a result or an error."""
        return self.started.future.done()

    def result(self) -> Result:
        """The result; see :meth:`Begun.result`."""
        return next(in_order(self.source, self.function, (), [self.started]))


def begun(source: Source, function: Callable[[Job], Result], job: Job) -> BegunJob[Job, Result]:
    """Begin a job."""
    return BegunJob(source, function, _Started(job, source.start(function, job)))


def in_order(
    source: Source,
    function: Callable[[Job], Result],
    jobs: Iterable[Job],
    started: Iterable[_Started[Job, Result]] = (),
) -> Iterator[Result]:
    """The results in the order of the jobs, after those ``started``; see :meth:`Workers.map`.

    Raises:
        OutOfTimeError: the current time limit was reached.
        WorkersLostError: every worker that tried a job ended, or none can be reached.
    """
    remaining, width = iter(jobs), source.width
    begun: deque[_Started[Job, Result]] = deque(started)
    try:
        while True:
            _begin_more(source, function, remaining, begun, width)
            if not begun:
                return
            lost = [one for one in begun if _is_lost(source, one.future)]
            for one in lost:
                _begin_again(source, function, one)
            unfinished = [one.future for one in begun if not one.future.done()]
            if begun[0].future in unfinished:
                check_time()
                finished = wait(unfinished, PULSE, FIRST_COMPLETED).done
                if not finished and not source.is_alive():
                    raise WorkersLostError(DISCONNECTED)
            elif not _is_lost(source, begun[0].future):
                yield begun.popleft().future.result()
    finally:
        for one in begun if source.is_alive() else ():
            one.future.cancel()


def _begin_more(
    source: Source,
    function: Callable[[Job], Result],
    remaining: Iterator[Job],
    begun: deque[_Started[Job, Result]],
    width: int,
) -> None:
    """Start jobs until ``width`` are unfinished, unless the next result is available."""
    while len(begun) < AHEAD * width and not (begun and begun[0].future.done()):
        if sum(not one.future.done() for one in begun) >= width:
            return
        for job in remaining:
            begun.append(_Started(job, source.start(function, job)))
            break
        else:
            return


def _begin_again(
    source: Source, function: Callable[[Job], Result], lost: _Started[Job, Result]
) -> None:
    if lost.attempts >= ATTEMPTS:
        raise WorkersLostError(ENDED) from _error(lost.future)
    lost.attempts += 1
    lost.future = source.start(function, lost.job)


def _is_lost(source: Source, future: Future[Result]) -> bool:
    error = _error(future) if future.done() else None
    return error is not None and source.is_lost(error)


def _error(future: Future[Result]) -> BaseException | None:
    try:
        return future.exception()
    except CancelledError as cancelled:
        return cancelled
