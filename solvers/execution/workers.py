"""Workers that run jobs: one after the other or many at once, with the same results."""

from __future__ import annotations

import pickle
from collections import OrderedDict
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from hashlib import sha256
from typing import Any, Generic, Protocol, TypeVar, cast

Job = TypeVar("Job")
Result = TypeVar("Result")
Made_co = TypeVar("Made_co", covariant=True)


ENDED = "all workers that began a job ended in the middle of it; perhaps there was no memory left"
DISCONNECTED = "the connection to the workers was lost"


class WorkersLostError(Exception):
    """A job could not be finished: every worker that tried it ended, or none can be reached."""


class Begun(Protocol[Made_co]):
    """A job that was begun, or that will run when its result is asked for."""

    @property
    def done(self) -> bool:
        """Whether the result is available without waiting."""
        ...

    def result(self) -> Made_co:
        """The result.

        Raises:
            OutOfTimeError: the current time limit was reached.
            WorkersLostError: every worker that tried the job ended, or none can be reached.
        """
        ...


class Workers(Protocol):
    """Runs jobs. A function is pure and found by its name in a module; jobs can be pickled.

    The same jobs have the same results, whoever runs them and in whatever order.
    """

    @property
    def width(self) -> int:
        """The number of jobs that run at once."""
        ...

    def map(self, function: Callable[[Job], Result], jobs: Iterable[Job]) -> Iterator[Result]:
        """The results in the order of the jobs.

        Jobs are drawn only while a result is waited for, and no more than ``width`` are unfinished
        at any time: with a width of 1 nothing is done before it is needed. An iterator that is
        closed or deleted abandons its jobs.

        Raises:
            WorkersLostError: every worker that tried a job ended, or none can be reached.
        """
        ...

    def begin(self, function: Callable[[Job], Result], job: Job) -> Begun[Result]:
        """Begin a job alongside the caller; its result need not be asked for."""
        ...

    def close(self) -> None:
        """End the workers, whatever they are doing."""
        ...


# --- Jobs run in this process, one after the other ------------------------------------------------


class InProcess:
    """Runs each job when its result is asked for."""

    @property
    def width(self) -> int:
        """One job at a time."""
        return 1

    def map(self, function: Callable[[Job], Result], jobs: Iterable[Job]) -> Iterator[Result]:
        """The results in the order of the jobs."""
        return map(function, jobs)

    def begin(self, function: Callable[[Job], Result], job: Job) -> Begun[Result]:
        """The job, which runs when its result is asked for."""
        return _WhenAsked(function, job)

    def close(self) -> None:
        """Do nothing: there is nothing to end."""


@dataclass(frozen=True, slots=True)
class _WhenAsked(Generic[Job, Result]):
    function: Callable[[Job], Result]
    job: Job
    done: bool = True

    def result(self) -> Result:
        """Compute the result."""
        return self.function(self.job)


# --- Jobs on their way to other processes ---------------------------------------------------------


def sent(function: Callable[[Job], Result], job: Job) -> bytes:
    """A job as bytes.

    Executors would pickle it in a thread while its contents may change here: a property that is
    computed on access is enough.
    """
    return pickle.dumps((function, job), protocol=pickle.HIGHEST_PROTOCOL)


def received(data: bytes) -> Any:
    """The result of a job that was sent."""
    function, job = pickle.loads(data)  # noqa: S301 (our own)
    return function(job)


# --- Data that many jobs share: pickled once, and unpickled once per process ----------------------


Content = TypeVar("Content")
Made = TypeVar("Made")

KEPT = 8
"""The number of objects made from payloads that are kept: those used last."""

_made: OrderedDict[tuple[str, str], object] = OrderedDict()


@dataclass(frozen=True, slots=True)
class SharedPayload(Generic[Content]):
    """A pickled value, named by the digest of its bytes."""

    digest: str
    data: bytes


def packed(content: Content) -> SharedPayload[Content]:
    """A value as a payload."""
    data = pickle.dumps(content, protocol=pickle.HIGHEST_PROTOCOL)
    return SharedPayload(sha256(data).hexdigest(), data)


def made_of(payload: SharedPayload[Content], make: Callable[[Content], Made]) -> Made:
    """The object that a function makes from the content; kept for later jobs with this payload."""
    name = payload.digest, f"{make.__module__}.{make.__qualname__}"
    if name not in _made:
        keep(payload, make, make(cast("Content", pickle.loads(payload.data))))  # noqa: S301 (our own)
    _made.move_to_end(name)
    return cast("Made", _made[name])


def keep(payload: SharedPayload[Content], make: Callable[[Content], Made], made: Made) -> None:
    """Store what a function makes from a payload, if it is available already."""
    _made[payload.digest, f"{make.__module__}.{make.__qualname__}"] = made
    while len(_made) > KEPT:
        _made.popitem(last=False)
