"""The verdict on a task, and the three-valued answers that lead to one.

This is the only module of ``solvers`` that search and verifier share.  Answers cannot be used as
bools: callers match them, so that "gave up" is never read as "no" (as in unified-planning,
``engines/results.py``).
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Generic, Literal, TypeAlias, TypeVar

Claimed: TypeAlias = Literal["found", "impossible"]
"""The verdicts that come with a certificate."""
NotFound: TypeAlias = Literal["impossible", "unknown"]
Verdict: TypeAlias = Literal["found", "impossible", "unknown"]
"""The verdicts on a task (docs/explanation/guarantees.md); only the first two are proved."""

MISSION = "mission.json"
"""The file in which a result folder states its claims about a mission."""

W_co = TypeVar("W_co", covariant=True)
C_co = TypeVar("C_co", covariant=True)


class Reason(Enum):
    """Why a solver returned no answer."""

    CONFLICT_LIMIT = "conflict limit reached"
    RESOURCE_LIMIT = "resource limit reached"
    ITERATION_LIMIT = "iteration limit reached"
    TIME_LIMIT = "time limit reached"
    NUMERICS = "reduced accuracy"
    INCOMPLETE = "incomplete method"
    INTERRUPTED = "interrupted"
    FAILED = "solver failed"


@dataclass(frozen=True, slots=True)
class Holds(Generic[W_co]):
    """The claim holds, shown by a witness."""

    witness: W_co

    def __bool__(self) -> bool:
        raise TypeError("an answer is no bool: match it")


@dataclass(frozen=True, slots=True)
class Fails(Generic[C_co]):
    """The claim fails, shown by a counterexample or a proof."""

    counterexample: C_co

    def __bool__(self) -> bool:
        raise TypeError("an answer is no bool: match it")


@dataclass(frozen=True, slots=True)
class Unknown:
    """The solver gave no answer; this must not be read as yes or no."""

    reason: Reason
    detail: str = ""

    def __bool__(self) -> bool:
        raise TypeError("an answer is no bool: match it")


Answer: TypeAlias = Holds[W_co] | Fails[C_co] | Unknown
