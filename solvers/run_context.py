"""What a synthesis reports while it runs, and how it is configured and stopped."""

from __future__ import annotations

from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Protocol, TypeAlias

from compiler.time_limits.time_limit import OutOfTimeError
from solvers.execution.workers import InProcess, Workers
from solvers.verifier.refutations.solver_process import SmtSolver

Recorded: TypeAlias = "bool | int | float | str | list[Recorded] | dict[str, Recorded] | None"
"""A JSON value."""


OFTEN = 3
"""The failures of a condition after which a remedy is told."""


class Reporter(Protocol):
    """Receives progress reports; every call must be cheap and must not change the result."""

    def structure(self, number: int, word: tuple[str, ...]) -> None:
        """A structure is being tried; ``number`` counts from 0."""
        ...

    def path(self, cells: tuple[str, ...]) -> None:
        """A cell path is being tried."""
        ...

    def robustness(self, value: float) -> None:
        """The best robustness so far for the current path."""
        ...

    def note(self, text: str) -> None:
        """A message worth printing as one line."""
        ...


class Silent:
    """Reports nothing."""

    def structure(self, number: int, word: tuple[str, ...]) -> None:
        """Do nothing."""

    def path(self, cells: tuple[str, ...]) -> None:
        """Do nothing."""

    def robustness(self, value: float) -> None:
        """Do nothing."""

    def note(self, text: str) -> None:
        """Do nothing."""


class Journal(Protocol):
    """Stores the results of finished steps, so that an interrupted run can be resumed."""

    def recall(self, key: str) -> Recorded:
        """The result of a step finished earlier, or None."""
        ...

    def record(self, key: str, value: Recorded) -> None:
        """Store the result of a finished step."""
        ...


@dataclass(slots=True)
class Memory:
    """A journal kept in memory only."""

    values: dict[str, Recorded] = field(default_factory=dict[str, Recorded])

    def recall(self, key: str) -> Recorded:
        """The result of a step finished earlier, or None."""
        return self.values.get(key)

    def record(self, key: str, value: Recorded) -> None:
        """Store the result of a finished step."""
        self.values[key] = value


PATHS = 6
EVALUATIONS = 12
"""The default numbers of paths tried for a structure, and of evaluations made for a path."""


@dataclass(slots=True)
class FailureCounts:
    """The number of failed proofs by the condition that was not proved."""

    counts: Counter[str] = field(default_factory=Counter[str])
    told: bool = False

    def often(self, name: str) -> bool:
        """Count a failure; return whether a condition has now failed often, for the first time."""
        self.counts[name] += 1
        if self.told or self.counts[name] < OFTEN:
            return False
        self.told = True
        return True


@dataclass(frozen=True, slots=True)
class RunContext:
    """How a synthesis is run.

    Only the following settings may change its result: the seed, the parameter ``search``, the time
    limit, the budgets, and the ``solver`` of convex programs, by its name in cvxpy (None: the
    built-in solver).  At most ``paths`` paths are tried for a structure, and half as many after a
    cell was split.  ``evaluations`` is the number of parameter values evaluated for a path.  With
    ``lemmas``, one refutation may cover many structures.  Scripts are given to the solvers in
    ``smt``, all of which must agree; if there are none, to z3 as a library.  ``out_of_time`` is
    called between steps, equally often in every run; loops within a step call
    ``compiler.time_limits``.  ``failures`` counts what was not proved.
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
    failures: FailureCounts = field(default_factory=FailureCounts)

    def check_time(self) -> None:
        """Raise OutOfTimeError once the limit is reached."""
        if self.out_of_time():
            raise OutOfTimeError
