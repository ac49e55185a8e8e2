"""The statements of ``design.json`` about the objectives of a task, read and put in words."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from math import isfinite
from pathlib import Path
from typing import Any

from srgc.faults import UsageFault

SEARCHED = ("effort", "time", "energy")
"""Objectives of motions, about which little is proved for other robots."""


@dataclass(frozen=True, slots=True)
class Objective:
    """A design's value of an objective, and what is proved about all robots.

    Attributes:
        objective: as written in the task, such as ``"sum(price)"``.
        value: the design's value in SI units; for ``effort`` a share.
        least: no robot has less than this, among those within the allowances of the earlier
            objectives; 0 if nothing is proved.
        unit: the SI unit; empty for a plain number.
        undecided: how many robots that may have less were neither found nor refuted.
        all_tried: whether all robots that may have less were tried.
    """

    objective: str
    value: float
    least: float
    unit: str
    undecided: int
    all_tried: bool

    @property
    def is_least(self) -> bool:
        """Whether it is proved that no robot has less."""
        return self.least >= self.value

    @property
    def gap(self) -> float | None:
        """The relative distance of the value from ``least``; None if nothing is proved."""
        return self.value / self.least - 1 if self.least > 0 else None

    @property
    def name(self) -> str:
        """Its name in a sentence; for a sum, the attribute."""
        return self.objective.removeprefix("sum(").removesuffix(")")

    def amount(self, value: float) -> str:
        """A value of it with its unit; an effort is in percent."""
        if self.objective == "effort":
            return f"{short(100 * value)} %"
        return f"{short(value)} {self.unit}".rstrip()

    def claim(self, *, first: bool) -> str:
        """What is proved about all robots, as a clause; ``first``: it is the first objective."""
        robots = "no robot" if first else "no robot within what the objectives before it leave"
        if not self.least > 0 and not self.is_least:
            return "nothing is proved of other robots"
        if self.is_least:
            return f"{robots} has less"
        return f"{robots} has less than {self.amount(self.least)}"

    @property
    def open(self) -> str:
        """Which robots may still have less, in words; "" if that is settled or was not searched."""
        if self.is_least or self.objective in SEARCHED:
            return ""
        more = "" if self.all_tried else "not all that may have less were tried"
        if not self.undecided:
            return more
        one = self.undecided == 1
        found = f"{self.undecided} {'robot' if one else 'robots'} that may have less "
        found += "is undecided" if one else "are undecided"
        return f"{found}, and {more}" if more else found


def short(value: float) -> str:
    """A number to six digits, an integer in full."""
    return str(int(value)) if value.is_integer() and abs(value) < 1e12 else f"{value:.6g}"


def stated_objectives(design: Mapping[str, Any], path: Path) -> tuple[Objective, ...]:
    """The objectives of a design in order; empty if the task has none.

    Raises:
        UsageFault: the file at ``path`` was not written by ``srgc synth``.
    """
    entries = design.get("objectives", [])
    if not isinstance(entries, list) or not all(map(_is_objective, entries)):
        raise UsageFault(f"{path} is not what `srgc synth` writes")
    return tuple(
        Objective(
            each["objective"], float(each["value"]), float(each["least"]), each["unit"],
            each["undecided"], each["all_tried"],
        )
        for each in entries
    )  # fmt: skip


def _is_objective(entry: Any) -> bool:
    return (
        isinstance(entry, dict)
        and all(isinstance(entry.get(name), str) for name in ("objective", "unit"))
        and _are_finite([entry.get("value"), entry.get("least")])
        and isinstance(entry.get("undecided"), int)
        and isinstance(entry.get("all_tried"), bool)
    )


def _are_finite(values: Sequence[Any]) -> bool:
    return all(
        isinstance(value, int | float) and not isinstance(value, bool) and isfinite(value)
        for value in values
    )
