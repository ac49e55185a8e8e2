"""Jobs done by any executor of :mod:`concurrent.futures`."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future, ThreadPoolExecutor

from solvers.execution.in_order import in_order
from solvers.execution.one_job import one_job
from solvers.execution.workers import Job, Result

LOST = (BrokenExecutor, CancelledError)


class AnyExecutor:
    """Does jobs by an executor, which stays its owner's to shut down.

    ``lost`` are the errors that say that a worker ended; where the executor does not go on after
    that, a job ends with WorkersLostError, and also where it is not ``alive`` any more.

    Raises:
        ValueError: the width is not positive.
        TypeError: the executor has threads of this process.
    """

    def __init__(
        self,
        executor: Executor,
        width: int,
        lost: tuple[type[BaseException], ...] = LOST,
        alive: Callable[[], bool] = lambda: True,
    ) -> None:
        if width < 1:
            raise ValueError("at least one job is done at once")
        if isinstance(executor, ThreadPoolExecutor):
            raise TypeError("threads would share the state of the solver libraries")
        self._executor, self._width, self._lost, self._alive = executor, width, lost, alive

    @property
    def width(self) -> int:
        """How many jobs are done at once."""
        return self._width

    def start(self, function: Callable[[Job], Result], job: Job) -> Future[Result]:
        """Begin a job."""
        try:
            return self._executor.submit(one_job, function, job)
        except self._lost as error:
            failed: Future[Result] = Future()
            failed.set_exception(error)
            return failed

    def is_lost(self, error: BaseException) -> bool:
        """Whether a worker ended."""
        return isinstance(error, self._lost)

    def is_alive(self) -> bool:
        """Whether unfinished jobs may still be finished."""
        return self._alive()

    def map(self, function: Callable[[Job], Result], jobs: Iterable[Job]) -> Iterator[Result]:
        """The results in the order of the jobs."""
        return in_order(self, function, jobs)

    def close(self) -> None:
        """Nothing: the executor has an owner."""
