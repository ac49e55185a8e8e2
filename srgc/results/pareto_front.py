"""Compares designs and finds out which of them others dominate.

A design is dominated if another is nowhere worse and somewhere better.  Exact values are compared
exactly; values that a search has computed in floating point are compared to few digits.
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
"""Significant digits of rounded values: further digits are noise of the search."""
SEARCHED = ("effort", "energy")
"""Objectives whose values come from the motion that a search has found."""
Cost: TypeAlias = Fraction | float


@dataclass(frozen=True, slots=True)
class Figure:
    """A design's value of an objective; a smaller ``cost`` is better, ``shown`` is for people."""

    value: float
    cost: Cost
    shown: str


def whole_figure(value: int) -> Figure:
    """The figure of a count, for which less is better."""
    return Figure(value, value, str(value))


def rounded_figure(value: float, *, large: bool = False) -> Figure:
    """The figure of a value that counts to few digits; less is better, or more if ``large``."""
    shown = f"{value:.{DIGITS}g}"
    return Figure(value, -float(shown) if large else float(shown), shown)


def objective_figure(objective: ir.Objective, bounds: Bounds) -> Figure:
    """The figure of a task's objective: exact if its bounds are equal and it was not searched.

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
    """A proved design; ``dominated_by`` is the number of a better structure, or None."""

    structure: int
    word: tuple[str, ...]
    parameters: tuple[tuple[int, str, float], ...]
    figures: tuple[Figure, ...]
    dominated_by: int | None = None

    @property
    def folder(self) -> str:
        """The subfolder with its results."""
        return f"designs/{self.structure}"

    @property
    def costs(self) -> tuple[Cost, ...]:
        """Its cost for each objective; less is better."""
        return tuple(figure.cost for figure in self.figures)

    def dominates(self, other: ParetoRow) -> bool:
        """Whether it is nowhere worse and somewhere better."""
        return self.costs != other.costs and all(
            own <= theirs for own, theirs in zip(self.costs, other.costs, strict=True)
        )


def judged(rows: Sequence[ParetoRow]) -> tuple[ParetoRow, ...]:
    """The rows, each with the first row that dominates it."""
    found = []
    for row in rows:
        better = next((other.structure for other in rows if other.dominates(row)), None)
        found.append(replace(row, dominated_by=better))
    return tuple(found)
