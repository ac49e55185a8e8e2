"""Who watches a long proof: told how far it has come, and able to end it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass


@dataclass(frozen=True, slots=True)
class Watch:
    """What a proof calls as it goes on.

    Attributes:
        tick: called again and again; what it raises ends the proof.
        part: told how many of all parts of the work are done: of the steps of a motion, or of the
            structures of a family.  Work that is done again begins at none.
    """

    tick: Callable[[], None] = lambda: None
    part: Callable[[int, int], None] = lambda _done, _count: None


UNWATCHED = Watch()
