"""Robots of a mission that are neither found nor refuted, why, and what ended the search."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from typing import Literal, TypeAlias

from solvers.search.search_state import Cause

Word: TypeAlias = tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Undecided:
    """Why a robot is neither found nor refuted.

    ``task`` is the number of the task whose search says so; None: all tasks together.  ``cause``
    is what blocked its motion, None where that is not known.  ``apart``: the parameters that were
    found do not suit everything that they have to.
    """

    reason: str
    task: int | None = None
    cause: Cause | None = None
    apart: bool = False


@dataclass(frozen=True, slots=True)
class UndecidedRobots:
    """The robots that are undecided for one reason: how many, and their words, each once."""

    why: Undecided
    robots: int
    words: tuple[Word, ...]


def grouped(robots: Iterable[tuple[Word, Undecided]]) -> tuple[UndecidedRobots, ...]:
    """Robots by why they are undecided, in the order in which the reasons come first."""
    found: dict[Undecided, list[Word]] = {}
    for word, why in robots:
        found.setdefault(why, []).append(word)
    return tuple(
        UndecidedRobots(why, len(words), tuple(dict.fromkeys(words)))
        for why, words in found.items()
    )


EndedBy: TypeAlias = Literal["time", "motions", "structures", "cuts", "parameters", "modules"]
"""The time limit; robots without a motion; structures, boxes cut: there are or would be too many;
parameters that do not agree; no bound on modules."""


@dataclass(frozen=True, slots=True)
class Ended:
    """What ended a search without an answer; ``try_first`` says what to do about it."""

    by: EndedBy
    try_first: str


OUT_OF_TIME = Ended("time", "a longer `--time-limit`")
NO_BOUND = Ended("modules", "`modules <= n` in the tasks")
MANY_MOTIONS = Ended(
    "motions", "a narrower `accept` that leaves out robots like those, or weaker tasks"
)
