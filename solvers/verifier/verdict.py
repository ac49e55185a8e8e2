"""Answers with three values: nothing here is a bool, callers must match.

Source: unified-planning, `engines/results.py`, which keeps "proved unsolvable" and "gave up" apart
for the same reason.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum
from typing import Generic, TypeAlias, TypeVar

W_co = TypeVar("W_co", covariant=True)
C_co = TypeVar("C_co", covariant=True)


class Reason(Enum):
    """Why there is no answer."""

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
        raise TypeError("a verdict is no bool: match it")


@dataclass(frozen=True, slots=True)
class Fails(Generic[C_co]):
    """The claim fails, shown by a counterexample or a proof."""

    counterexample: C_co

    def __bool__(self) -> bool:
        raise TypeError("a verdict is no bool: match it")


@dataclass(frozen=True, slots=True)
class Unknown:
    """No answer; never to be read as one."""

    reason: Reason
    detail: str = ""

    def __bool__(self) -> bool:
        raise TypeError("a verdict is no bool: match it")


Verdict: TypeAlias = Holds[W_co] | Fails[C_co] | Unknown
