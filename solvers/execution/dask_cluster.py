"""Run jobs on the workers of a Dask cluster."""

from __future__ import annotations

import asyncio
import logging
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import BrokenExecutor, CancelledError, Executor, Future, ThreadPoolExecutor
from importlib.metadata import PackageNotFoundError, version
from threading import Lock
from typing import TYPE_CHECKING, Any

from solvers.execution.in_order import begun, in_order
from solvers.execution.workers import (
    DISCONNECTED,
    ENDED,
    Begun,
    Job,
    Result,
    WorkersLostError,
    received,
    sent,
)

if TYPE_CHECKING:
    from distributed import Client


# --- One job at a time in a process: threads would share the state of the solver libraries --------


_BUSY = Lock()


def one_job(data: bytes) -> Any:
    """Do a job that was sent, once no other thread of this process does one."""
    with _BUSY:
        return received(data)


# --- Jobs run by any executor of :mod:`concurrent.futures` ----------------------------------------


LOST = (BrokenExecutor, CancelledError)


class AnyExecutor:
    """Runs jobs on an executor; its owner has to shut it down.

    ``lost`` are the errors that say that a worker ended. If the executor cannot continue after such
    an error, or is not ``alive`` any more, a job ends with WorkersLostError.

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
        """The number of jobs that run at once."""
        return self._width

    def start(self, function: Callable[[Job], Result], job: Job) -> Future[Result]:
        """Begin a job."""
        data = sent(function, job)
        try:
            return self._executor.submit(one_job, data)
        except self._lost as error:
            failed: Future[Result] = Future()
            failed.set_exception(error)
            return failed

    def is_lost(self, error: BaseException) -> bool:
        """Whether an error says that a worker ended."""
        return isinstance(error, self._lost)

    def is_alive(self) -> bool:
        """Whether unfinished jobs can still finish."""
        return self._alive()

    def map(self, function: Callable[[Job], Result], jobs: Iterable[Job]) -> Iterator[Result]:
        """The results in the order of the jobs."""
        return in_order(self, function, jobs)

    def begin(self, function: Callable[[Job], Result], job: Job) -> Begun[Result]:
        """Begin a job."""
        return begun(self, function, job)

    def close(self) -> None:
        """Do nothing: the executor has an owner."""


# --- Jobs run by the workers of a Dask cluster ----------------------------------------------------


REACHED_WITHIN = 5.0
"""Seconds within which the scheduler has to answer, and a worker has to be available."""
RETRIES = 2


class ClusterFault(Exception):
    """A cluster cannot be used; the message says why."""


class DaskCluster:
    """Runs jobs on the workers of a scheduler, one at a time on each.

    If a worker ends, the scheduler passes its jobs to others and computes results again that only
    this worker had.
    """

    def __init__(self, client: Client) -> None:
        self._client = client
        self._executor = client.get_executor(pure=False, retries=RETRIES)

    @property
    def width(self) -> int:
        """The current number of workers."""
        return max(1, len(self._client.nthreads()))

    def map(self, function: Callable[[Job], Result], jobs: Iterable[Job]) -> Iterator[Result]:
        """The results in the order of the jobs.

        Raises:
            WorkersLostError: every worker that tried a job ended, or none can be reached.
        """
        from distributed.scheduler import KilledWorker

        if not self._is_connected():
            raise WorkersLostError(DISCONNECTED)
        executor = AnyExecutor(self._executor, self.width, alive=self._is_connected)
        try:
            yield from executor.map(function, jobs)
        except KilledWorker as error:
            # The scheduler has tried several workers.
            raise WorkersLostError(ENDED) from error

    def begin(self, function: Callable[[Job], Result], job: Job) -> Begun[Result]:
        """Begin a job.

        Raises:
            WorkersLostError: the connection is lost.
        """
        from distributed.scheduler import KilledWorker

        if not self._is_connected():
            raise WorkersLostError(DISCONNECTED)
        lost = (*LOST, KilledWorker)
        return AnyExecutor(self._executor, 1, lost, self._is_connected).begin(function, job)

    def _is_connected(self) -> bool:
        return self._client.status not in ("closing", "closed")

    def close(self) -> None:
        """Leave the cluster; unfinished jobs are abandoned."""
        if not self._is_connected():
            return
        self._executor.shutdown(wait=False)
        self._client.close()


def join_cluster(address: str, seconds: float = REACHED_WITHIN) -> DaskCluster:
    """The workers of the Dask scheduler at an address, such as ``tcp://10.0.0.1:8786``.

    Raises:
        ClusterFault: Dask is not installed, the address cannot be reached within this time, there
            is no worker, or one has another version of srgc.
    """
    try:
        from distributed import Client
    except ImportError:
        raise ClusterFault('Dask is not installed: pip install "srgc[cluster]"') from None
    for name in ("distributed", "distributed.client"):
        logging.getLogger(name).setLevel(logging.CRITICAL)
    try:
        # Without a scheduler, a client takes long to shut down again.
        asyncio.run(_knock(address, seconds))
        client = Client(address, timeout=seconds, set_as_default=False)
    except Exception as error:
        # Anything may listen at this address and answer in any way.
        reason = " ".join(str(error).split()) or "no answer"
        raise ClusterFault(f"the cluster at {address} cannot be reached: {reason}") from None
    try:
        _refuse_unfit(client, address, seconds)
    except BaseException:
        client.close()
        raise
    return DaskCluster(client)


async def _knock(address: str, seconds: float) -> None:
    """Connect to the scheduler at an address and disconnect again."""
    from distributed.comm.core import connect

    comm = await asyncio.wait_for(connect(address, timeout=seconds), seconds)
    await comm.close()


def _refuse_unfit(client: Client, address: str, seconds: float) -> None:
    try:
        client.wait_for_workers(1, timeout=seconds)
    except TimeoutError:
        raise ClusterFault(f"the cluster at {address} has no workers") from None
    own = installed()
    found = client.run(installed, on_error="return")
    for worker, answer in sorted(found.items()):
        if answer != own:
            there = "no srgc" if isinstance(answer, BaseException) else f"srgc {answer}"
            raise ClusterFault(f"the worker {worker} has {there}; srgc {own} is needed there")


def installed() -> str:
    """The version of srgc that is installed here."""
    try:
        return version("srgc")
    except PackageNotFoundError:
        return "of unknown version"
