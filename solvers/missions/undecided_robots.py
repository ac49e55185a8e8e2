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

    ``task`` is the index of the task in whose search this happened; None for all tasks together.
    ``cause`` is what blocked its motion, None if that is not known.  ``apart`` says that the
    parameters found do not satisfy all requirements at once.
    """

    reason: str
    task: int | None = None
    cause: Cause | None = None
    apart: bool = False


@dataclass(frozen=True, slots=True)
class UndecidedRobots:
    """The robots that are undecided for one reason: their number, and their distinct words."""

    why: Undecided
    robots: int
    words: tuple[Word, ...]


def grouped(robots: Iterable[tuple[Word, Undecided]]) -> tuple[UndecidedRobots, ...]:
    """Robots grouped by the reason why they are undecided, in order of first occurrence."""
    found: dict[Undecided, list[Word]] = {}
    for word, why in robots:
        found.setdefault(why, []).append(word)
    return tuple(
        UndecidedRobots(why, len(words), tuple(dict.fromkeys(words)))
        for why, words in found.items()
    )


EndedBy: TypeAlias = Literal["time", "motions", "structures", "cuts", "parameters", "modules"]
"""Respectively: the time limit; too many robots without a motion; too many structures; too many cut
boxes; parameters that disagree; no bound on modules."""


@dataclass(frozen=True, slots=True)
class Ended:
    """The limit that ended a search without an answer; ``try_first`` suggests a remedy."""

    by: EndedBy
    try_first: str


OUT_OF_TIME = Ended("time", "a longer `--time-limit`")
NO_BOUND = Ended("modules", "`modules <= n` in the tasks")
MANY_MOTIONS = Ended(
    "motions", "a narrower `accept` that leaves out robots like those, or weaker tasks"
)
