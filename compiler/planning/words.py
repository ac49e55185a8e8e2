"""Words of cells of an effector, stays left out."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Word:
    """The cells of an effector (from 0) in order; the samples they are entered at, or None."""

    effector: int
    cells: tuple[int, ...]
    entries: tuple[int, ...] | None
