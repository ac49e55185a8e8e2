"""Designs held against each other: which of them others dominate.

A design is dominated if another is nowhere worse and somewhere better.  Exact values are compared
as they are; what a search has computed in floating point counts to few digits.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TypeAlias

from compiler.expressions.exact_numbers import Bounds, exact_text
from compiler.objectives.objective_text import LONGEST
from grammar_lang import ir

DIGITS = 4
"""Significant digits to which other values are compared: below them is the noise of a search."""
SEARCHED = ("effort", "energy")
"""Objectives whose values come from the motion that a search has found."""
Cost: TypeAlias = Fraction | float


@dataclass(frozen=True, slots=True)
class Figure:
    """What a design has of an objective: its ``cost`` is to be small; ``shown`` is for people."""

    value: float
    cost: Cost
    shown: str


def whole_figure(value: int) -> Figure:
    """A number of things, to be small."""
    return Figure(value, value, str(value))


def rounded_figure(value: float, *, large: bool = False) -> Figure:
    """A value that counts to few digits, to be small, or ``large``."""
    shown = f"{value:.{DIGITS}g}"
    return Figure(value, -float(shown) if large else float(shown), shown)


def objective_figure(objective: ir.Objective, bounds: Bounds) -> Figure:
    """A value of an objective of a task: exact where its bounds are equal and it was not searched.

    Args:
        objective: the objective.
        bounds: rationals that contain the value.
    """
    low, high = bounds
    if low != high or objective.kind in SEARCHED:
        return rounded_figure(float(high))
    exact = exact_text(high)
    return Figure(float(high), high, exact if len(exact) <= LONGEST else f"{float(high):.6g}")


@dataclass(frozen=True, slots=True)
class ParetoRow:
    """A proved design; ``dominated_by`` is the number of a structure that is better, or None."""

    structure: int
    word: tuple[str, ...]
    parameters: tuple[tuple[int, str, float], ...]
    figures: tuple[Figure, ...]
    dominated_by: int | None = None

    @property
    def folder(self) -> str:
        """Where its results are."""
        return f"designs/{self.structure}"

    @property
    def costs(self) -> tuple[Cost, ...]:
        """What it has of each objective, all to be small."""
        return tuple(figure.cost for figure in self.figures)

    def dominates(self, other: ParetoRow) -> bool:
        """Whether it is nowhere worse and somewhere better."""
        return self.costs != other.costs and all(
            own <= theirs for own, theirs in zip(self.costs, other.costs, strict=True)
        )


def judged(rows: Sequence[ParetoRow]) -> tuple[ParetoRow, ...]:
    """The rows, each with the first that dominates it."""
    found = []
    for row in rows:
        better = next((other.structure for other in rows if other.dominates(row)), None)
        found.append(replace(row, dominated_by=better))
    return tuple(found)
