"""A box of coordinates that a robot may be in, as a proof about its drives reads it."""

from __future__ import annotations

from dataclasses import dataclass

from flint import arb


@dataclass(frozen=True, slots=True)
class LeafBox:
    """Balls around the coordinates; whether a pose in it may be the start's, or the goal's."""

    coordinates: tuple[arb, ...]
    start_possible: bool
    goal_possible: bool
