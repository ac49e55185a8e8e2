"""Evaluating parameters: the best outcome over all seeds of a follower, in this or other processes.

An evaluation is a pure function of the follower and the parameters, so results do not depend on
the number of processes; what was evaluated before is looked up in a journal.
"""

from __future__ import annotations

import os
import signal
from collections.abc import Iterable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from contextlib import contextmanager
from dataclasses import dataclass, fields
from multiprocessing import get_context, parent_process
from threading import Thread, current_thread, main_thread
from types import TracebackType

from compiler.discretisation.float_reading import Array, FloatReading
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.robot import RobotModel
from solvers.motions.control import SURVEY, ControlOutcome, Effort
from solvers.motions.path_following import Follower


@dataclass(frozen=True, slots=True)
class Recipe:
    """A follower as plain data, to be built again in another process."""

    model: RobotModel
    settings: dict[str, object]

    def follower(self) -> Follower:
        """The follower."""
        task = self.settings["task"]
        gravity = getattr(task, "gravity", ())
        reading = FloatReading(robot_graph(self.model, gravity))
        return Follower(reading=reading, **self.settings)  # type: ignore[arg-type]


def recipe(follower: Follower) -> Recipe:
    """The plain data of a follower."""
    settings = {f.name: getattr(follower, f.name) for f in fields(follower)}
    del settings["reading"]
    return Recipe(follower.model, settings)


def evaluate(follower: Follower, theta: Array, effort: Effort = SURVEY) -> ControlOutcome:
    """The best outcome over all seeds; ties go to the first.

    Raises:
        ValueError: there is no seed.
    """
    outcomes = [follower.solve(seed, effort=effort) for seed in follower.seeds(theta)]
    return max(outcomes, key=lambda outcome: outcome.robustness)


_worker_follower: list[Follower] = []


def _start_worker(plan: Recipe) -> None:
    Thread(target=_end_with_parent, daemon=True).start()
    _worker_follower[:] = [plan.follower()]


def _end_with_parent() -> None:
    """End this worker when its parent is gone, however that went."""
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _ready() -> None:
    """A task that only makes a worker start."""


@contextmanager
def _interrupts_ignored() -> Iterator[None]:
    """Processes started in the block ignore interrupts: those are for their parent to handle."""
    if current_thread() is not main_thread():
        yield
        return
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _evaluate_in_worker(theta: Array) -> ControlOutcome:
    return evaluate(_worker_follower[0], theta)


class Evaluator:
    """Evaluates batches of parameters for one follower, in order, with ``jobs`` processes."""

    def __init__(self, follower: Follower, jobs: int) -> None:
        self.follower = follower
        self._pool = None
        if jobs > 1:
            self._pool = ProcessPoolExecutor(
                jobs,
                mp_context=get_context("spawn"),
                initializer=_start_worker,
                initargs=(recipe(follower),),
            )
            with _interrupts_ignored():
                for _ in range(jobs):
                    self._pool.submit(_ready)

    def __enter__(self) -> Evaluator:
        return self

    def __exit__(
        self,
        kind: type[BaseException] | None,
        error: BaseException | None,
        trace: TracebackType | None,
    ) -> None:
        if self._pool is not None:
            self._pool.shutdown(wait=kind is None, cancel_futures=True)

    def batch(self, thetas: Sequence[Array]) -> Iterable[ControlOutcome]:
        """The outcomes, in the order of the parameters, one at a time."""
        if self._pool is None:
            return (evaluate(self.follower, theta) for theta in thetas)
        return self._pool.map(_evaluate_in_worker, thetas)
