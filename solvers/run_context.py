"""What a synthesis tells while it runs, and how it is told to stop."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol, TypeAlias

from compiler.time_limits.time_limit import OutOfTimeError
from solvers.execution.workers import InProcess, Workers
from solvers.verifier.refutations.solver_process import SmtSolver

Recorded: TypeAlias = "bool | int | float | str | list[Recorded] | dict[str, Recorded] | None"
"""A value of JSON."""


class Reporter(Protocol):
    """Receives progress; every call is cheap and none may change the result."""

    def structure(self, number: int, word: tuple[str, ...]) -> None:
        """A structure is being tried."""
        ...

    def path(self, cells: tuple[str, ...]) -> None:
        """A cell path is being tried."""
        ...

    def robustness(self, value: float) -> None:
        """The best robustness so far for this path."""
        ...

    def note(self, text: str) -> None:
        """A finding worth a line."""
        ...


class Silent:
    """Reports nothing."""

    def structure(self, number: int, word: tuple[str, ...]) -> None:
        """Nothing."""

    def path(self, cells: tuple[str, ...]) -> None:
        """Nothing."""

    def robustness(self, value: float) -> None:
        """Nothing."""

    def note(self, text: str) -> None:
        """Nothing."""


class Journal(Protocol):
    """Remembers the results of finished steps, so that an interrupted run can go on."""

    def recall(self, key: str) -> Recorded:
        """The result of a step finished before, or None."""
        ...

    def record(self, key: str, value: Recorded) -> None:
        """A step is finished."""
        ...


@dataclass(slots=True)
class Memory:
    """A journal that lives as long as the process."""

    values: dict[str, Recorded] = field(default_factory=dict[str, Recorded])

    def recall(self, key: str) -> Recorded:
        """The result of a step finished before, or None."""
        return self.values.get(key)

    def record(self, key: str, value: Recorded) -> None:
        """A step is finished."""
        self.values[key] = value


PATHS = 6
EVALUATIONS = 12
"""What is tried for a structure, and for a path, unless a run says otherwise."""


@dataclass(frozen=True, slots=True)
class RunContext:
    """How a synthesis is run.

    Nothing here may change its result but the seed, the parameter ``search``, the limit of time,
    the budgets and the ``solver`` of convex programs, by its name in cvxpy (None: our own).  For a
    structure at most so many ``paths`` are tried, and half as many after a cell was cut; for a path
    so many ``evaluations`` of parameters are made.  With ``lemmas`` one refutation may be about
    many structures.  Scripts are given to the solvers ``smt``, all of which have to agree; without
    any, to z3 as a library.  ``out_of_time`` is asked between steps, as
    often each time; loops within them ask ``compiler.time_limits``.
    """

    seed: int = 0
    workers: Workers = field(default_factory=InProcess)
    search: str | None = None
    solver: str | None = None
    reporter: Reporter = field(default_factory=Silent)
    journal: Journal = field(default_factory=Memory)
    out_of_time: Callable[[], bool] = lambda: False
    paths: int = PATHS
    evaluations: int = EVALUATIONS
    lemmas: bool = True
    smt: tuple[SmtSolver, ...] = ()

    def check_time(self) -> None:
        """Raise OutOfTimeError once the limit is reached."""
        if self.out_of_time():
            raise OutOfTimeError
