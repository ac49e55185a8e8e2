"""Run jobs in other processes on this machine."""

from __future__ import annotations

import os
import signal
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import BrokenExecutor, Future, ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from multiprocessing import get_context, parent_process, resource_tracker
from multiprocessing.connection import Connection, wait
from threading import Lock, Thread
from types import ModuleType
from typing import Generic

from solvers.execution.in_order import begun, in_order
from solvers.execution.one_thread import ONE_THREAD
from solvers.execution.workers import Begun, Job, Result, received, sent

PATIENCE = 1.0
"""Seconds of jobs run in this process before others are started: a short run needs none."""
STARTING = Lock()
"""Held while processes are started, and by code that ends this process."""


class ProcessPool:
    """Runs jobs in ``jobs`` processes, which are started once this is worthwhile.

    Until they are ready, jobs run in this process, one after the other. Processes that end in the
    middle of a job are replaced, and the job is run again.
    """

    def __init__(self, jobs: int, patience: float | None = None) -> None:
        if jobs < 1:
            raise ValueError("at least one process does jobs")
        self._jobs, self._patience = jobs, PATIENCE if patience is None else patience
        self._executor: ProcessPoolExecutor | None = None
        self._lifeline: Connection | None = None
        self._ready: list[Future[None]] = []
        self._closed = False

    @property
    def width(self) -> int:
        """The number of jobs that run at once."""
        return self._jobs

    def map(self, function: Callable[[Job], Result], jobs: Iterable[Job]) -> Iterator[Result]:
        """The results in the order of the jobs."""
        remaining = iter(jobs)
        while not self._is_ready(function):
            begun = time.monotonic()
            for job in remaining:
                result = function(job)
                break
            else:
                return
            self._patience -= time.monotonic() - begun
            yield result
        yield from in_order(self, function, remaining)

    def begin(self, function: Callable[[Job], Result], job: Job) -> Begun[Result]:
        """Begin a job; the processes are started at once for this.

        It runs in this process if its result is asked for before they are ready.
        """
        return _BegunJob(self, function, job, begun(self, function, job))

    def start(self, function: Callable[[Job], Result], job: Job) -> Future[Result]:
        """Begin a job; processes that have ended are replaced first."""
        data = sent(function, job)
        try:
            return self._running(function).submit(received, data)
        except BrokenExecutor:
            self._end()
            return self._running(function).submit(received, data)

    def is_lost(self, error: BaseException) -> bool:
        """Whether an error says that a process ended."""
        return isinstance(error, BrokenExecutor)

    def is_alive(self) -> bool:
        """Always true: ended processes are noticed when their jobs are lost."""
        return True

    def close(self) -> None:
        """End the processes at once."""
        self._closed = True
        self._end()

    def _is_ready(self, function: Callable[..., object]) -> bool:
        """Whether the processes are ready; they are started when patience ends."""
        if self._patience > 0:
            return False
        self._running(function)
        return self.has_processes

    @property
    def has_processes(self) -> bool:
        """Whether processes have been started and have imported what jobs need."""
        return bool(self._ready) and all(ready.done() for ready in self._ready)

    def _running(self, function: Callable[..., object]) -> ProcessPoolExecutor:
        """The executor, started if necessary, with processes that have imported the function."""
        if self._closed:
            raise RuntimeError("the processes have been ended")
        if self._executor is None:
            context = get_context("spawn")
            theirs, self._lifeline = context.Pipe(duplex=False)
            self._executor = ProcessPoolExecutor(
                self._jobs, mp_context=context, initializer=_prepare, initargs=(theirs,)
            )
            with _as_workers_start():
                # Each job that finds no idle process starts one.
                self._ready = [
                    self._executor.submit(_imported, function.__module__) for _ in range(self._jobs)
                ]
        return self._executor

    def _end(self) -> None:
        """End the processes, whatever they are doing.

        They end themselves when our end of the pipe is closed, but only after a library call lets
        another thread run; so they are also killed.
        """
        executor, lifeline = self._executor, self._lifeline
        self._executor = self._lifeline = None
        if lifeline is not None:
            lifeline.close()
        if executor is not None:
            for process in tuple((executor._processes or {}).values()):  # noqa: SLF001
                process.kill()
            executor.shutdown(wait=True, cancel_futures=True)


@dataclass(frozen=True, slots=True)
class _BegunJob(Generic[Job, Result]):
    pool: ProcessPool
    function: Callable[[Job], Result]
    job: Job
    begun: Begun[Result]

    @property
    def done(self) -> bool:
        """Whether the result is there."""
        return self.begun.done

    def result(self) -> Result:
        """The result, from this process if the others are not ready yet."""
        return self.begun.result() if self.pool.has_processes else self.function(self.job)


@contextmanager
def _as_workers_start() -> Iterator[None]:
    """Processes started in the block have libraries with one thread, and no interrupts.

    Interrupts are for the parent to handle: one that comes in the block is handled after it, or by
    another thread of the parent. The processes do not run their parent's main program first, as
    :mod:`multiprocessing` would: no job needs it, and a script may do anything.
    """
    program = sys.modules["__main__"]
    before = {name: os.environ.get(name) for name in ONE_THREAD}
    resource_tracker.ensure_running()  # starting it unblocks SIGINT
    os.environ.update(ONE_THREAD)
    blocked = _blocked({signal.SIGINT})
    sys.modules["__main__"] = ModuleType("__main__")
    try:
        with STARTING:
            yield
    finally:
        sys.modules["__main__"] = program
        for name, value in before.items():
            if value is None:
                del os.environ[name]
            else:
                os.environ[name] = value
        if hasattr(signal, "pthread_sigmask"):
            signal.pthread_sigmask(signal.SIG_SETMASK, blocked)


def _blocked(signals: set[signal.Signals]) -> set[int | signal.Signals]:
    """Block signals in this thread and in the processes it starts; return those blocked before."""
    if hasattr(signal, "pthread_sigmask"):
        return signal.pthread_sigmask(signal.SIG_BLOCK, signals)
    return set()


def _prepare(lifeline: Connection) -> None:
    """Initialise a worker process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    Thread(target=_end_with, args=(lifeline,), daemon=True).start()


def _end_with(lifeline: Connection) -> None:
    """End this process when its parent ends or closes the pipe, whatever runs here."""
    parent = parent_process()
    wait([lifeline] if parent is None else [lifeline, parent.sentinel])
    os._exit(1)


def _imported(module: str) -> None:
    """A job that makes a process start and import what the jobs of a module need."""
    import_module(module)
