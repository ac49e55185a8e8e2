"""The structures that were tried, equal robots together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

GROUPS = ("found", "unresolved", "inadmissible", "refuted")
"""Verdicts in the order in which they are told."""


@dataclass(frozen=True, slots=True)
class TriedRobot:
    """A robot that was tried: its first structure, and the numbers of those equal to it.

    ``evidence`` is a file, or the reason where there is none; ``reason`` may be empty.
    """

    number: int
    word: tuple[str, ...]
    verdict: str
    evidence: str
    reason: str
    boxes: str | None
    equal: tuple[tuple[int, tuple[str, ...]], ...]


def tried_robots(design: Mapping[str, Any]) -> tuple[TriedRobot, ...]:
    """The different robots of ``design.json``, in order."""
    tried = design["structures_tried"]
    equal: dict[int, list[tuple[int, tuple[str, ...]]]] = {}
    for number, one in enumerate(tried):
        if one["same_robot_as"] is not None:
            equal.setdefault(one["same_robot_as"], []).append((number, tuple(one["word"])))
    return tuple(
        TriedRobot(
            number,
            tuple(one["word"]),
            str(one["verdict"]),
            str(one["evidence"]),
            str(one.get("reason", "")),
            one["boxes"],
            tuple(equal.get(number, ())),
        )
        for number, one in enumerate(tried)
        if one["same_robot_as"] is None
    )
