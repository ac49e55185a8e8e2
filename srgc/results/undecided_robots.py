"""Robots of a mission that are neither found nor refuted, as ``design.json`` states them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from grammar_lang.diagnostics.wording import counted
from solvers.missions.mission_result import MissionResult
from solvers.missions.undecided_robots import UndecidedRobots
from srgc.text_reports.nearest_motion import FIRST

MOST_WORDS = 12
"""The most words to list for one reason."""
APART = "narrower ranges of its parameters"


@dataclass(frozen=True, slots=True)
class StatedUndecided:
    """The number of robots that are undecided for one reason, and the words of the first of them.

    ``task`` is the task whose search states the reason; None for all tasks together.  ``try_first``
    is a remedy to try; None if none is known.
    """

    task: str | None
    reason: str
    try_first: str | None
    robots: int
    words: tuple[tuple[str, ...], ...]

    def says(self, most: int = MOST_WORDS) -> str:
        """The reason in words, with at most ``most`` robots by name."""
        named = ", ".join(" ".join(word) for word in self.words[:most])
        said = f"{counted(self.robots, 'robot')}, {'as ' if self.robots > most else ''}{named}"
        return f"{said}: {self.reason}"


def undecided_by_task(
    undecided: Sequence[StatedUndecided],
) -> dict[str | None, list[StatedUndecided]]:
    """Maps each task, in order, to its undecided robots; None stands for all tasks together."""
    found: dict[str | None, list[StatedUndecided]] = {}
    for each in undecided:
        found.setdefault(each.task, []).append(each)
    return found


def undecided_entry(result: MissionResult, each: UndecidedRobots) -> dict[str, Any]:
    """The entry in ``design.json``."""
    why = each.why
    by_cause = None if why.cause is None else FIRST.get(why.cause)
    return {
        "task": None if why.task is None else result.mission.tasks[why.task],
        "reason": why.reason,
        "try_first": APART if why.apart else by_cause,
        "robots": each.robots,
        "words": [list(word) for word in each.words[:MOST_WORDS]],
    }


def stated_undecided(
    design: Mapping[str, Any], tasks: Sequence[str]
) -> tuple[StatedUndecided, ...]:
    """The undecided robots that ``design.json`` states.

    Raises:
        TypeError, LookupError: the content is not what srgc writes there.
    """
    for name in ("ended_by", "try_first"):
        if not isinstance(design.get(name), str | None):
            raise TypeError(name)
    return tuple(_read(entry, tasks) for entry in design.get("open", []))


def _read(entry: Mapping[str, Any], tasks: Sequence[str]) -> StatedUndecided:
    task, reason, first = entry["task"], entry["reason"], entry["try_first"]
    robots, words = entry["robots"], entry["words"]
    if task is not None and task not in tasks:
        raise LookupError(task)
    if not isinstance(reason, str) or not isinstance(first, str | None):
        raise TypeError(reason)
    if not isinstance(robots, int) or robots < 1 or not words:
        raise TypeError(robots)
    named = tuple(tuple(word) for word in words)
    if not all(isinstance(symbol, str) for word in named for symbol in word):
        raise TypeError(words)
    return StatedUndecided(task, reason, first, robots, named)
