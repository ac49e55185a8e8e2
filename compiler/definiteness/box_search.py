"""Branch and bound over boxes: a property is proved on every part, refuted in one, or undecided.

The part that looks worst (by floating point) is divided first, at the variable that matters most
there, so that a part which cannot be proved is found soon.  Limits are numbers of boxes.

Source: Moore, Kearfott & Cloud, *Introduction to Interval Analysis* (2009), chapter 11.
"""

from __future__ import annotations

import heapq
from collections.abc import Callable
from dataclasses import dataclass
from typing import Generic, Literal, TypeVar

from compiler.definiteness.boxes import Box
from compiler.time_limits.time_limit import check_time

Counterexample = TypeVar("Counterexample")


@dataclass(frozen=True, slots=True)
class Examined:
    """A box: whether the property is proved on it, else how well it looks and what to divide."""

    proved: bool
    score: float = 0.0
    split: Callable[[], int | None] = lambda: None


@dataclass(frozen=True, slots=True)
class Searched(Generic[Counterexample]):
    """The result of a search; ``box`` is where it fails, or a part that is left undecided.

    ``proved`` and ``left`` count the parts that are proved and left undecided.
    """

    status: Literal["proved", "fails", "undecided"]
    boxes: int
    box: Box | None = None
    counterexample: Counterexample | None = None
    reason: str = ""
    proved: int = 0
    left: int = 0


def search(
    root: Box,
    examine: Callable[[Box], Examined],
    refute: Callable[[Box], Counterexample | None],
    budget: int,
) -> Searched[Counterexample]:
    """Decide a property on a box with at most ``budget`` boxes examined."""
    waiting: list[tuple[float, int, Box, Examined]] = []
    fresh, boxes, proved = [root], 0, 0
    while fresh or waiting:
        for number, box in enumerate(fresh):
            if boxes == budget:
                reason, left = f"{budget} boxes did not suffice", len(waiting) + len(fresh) - number
                return Searched("undecided", boxes, box, None, reason, proved, left)
            boxes += 1
            check_time()
            examined = examine(box)
            if examined.proved:
                proved += 1
                continue
            found = refute(box)
            if found is not None:
                return Searched("fails", boxes, box, found)
            heapq.heappush(waiting, (examined.score, boxes, box, examined))
        fresh = []
        if waiting:
            _, _, box, examined = heapq.heappop(waiting)
            variable = examined.split()
            if variable is None:
                reason = "neither proved nor refuted on a box that is too small to divide"
                return Searched("undecided", boxes, box, None, reason, proved, len(waiting) + 1)
            fresh = [
                (*box[:variable], half, *box[variable + 1 :]) for half in box[variable].halves()
            ]
    return Searched("proved", boxes, proved=proved)


def widest_effect(box: Box, active: tuple[int, ...], spread: Callable[[int], float]) -> int | None:
    """The divisible variable of largest effect, unlimited ones first; None if there is none."""
    divisible = [i for i in active if box[i].divisible()]
    unlimited = [i for i in divisible if not box[i].ends.finite]
    if unlimited:
        return unlimited[0]
    effects = [(spread(i), -i) for i in divisible]
    return -max(effects)[1] if effects else None
