"""A minimal conflict: a subset of constraints that is refuted and of which all are needed.

QUICKXPLAIN finds one with few questions where it is small; elements that come first are preferred.
Source: Junker, *QuickXplain: Preferred Explanations and Relaxations for Over-Constrained Problems*
(AAAI 2004).  It assumes that more constraints are never less refuted.  A refuter with a budget may
break that, so that the answer is checked, and thinned out once more one by one.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TypeAlias, TypeVar

Item = TypeVar("Item")
Refuted: TypeAlias = Callable[[Sequence[Item]], bool]


def minimal_conflict(items: Sequence[Item], refuted: Refuted[Item]) -> tuple[Item, ...] | None:
    """A subset that is refuted, while it is not without any one of its elements; in order.

    None where not even all items together are refuted.  Empty where nothing at all is needed.
    """
    if not refuted(items):
        return None
    if refuted(()):
        return ()
    found = _explained((), tuple(items), refuted, grown=False)
    chosen = [item for item in items if item in found]
    return _thinned(chosen if refuted(chosen) else list(items), refuted)


def _explained(
    background: tuple[Item, ...],
    items: tuple[Item, ...],
    refuted: Refuted[Item],
    *,
    grown: bool,
) -> tuple[Item, ...]:
    """What of the items is needed besides the background; ``grown``: that is new."""
    if grown and refuted(background):
        return ()
    if len(items) == 1:
        return items
    half = len(items) // 2
    first, second = items[:half], items[half:]
    later = _explained((*background, *first), second, refuted, grown=True)
    earlier = _explained((*background, *later), first, refuted, grown=bool(later))
    return (*earlier, *later)


def _thinned(items: list[Item], refuted: Refuted[Item]) -> tuple[Item, ...]:
    """Without all that can be spared, the last first.

    What could not be spared beside more may be spared beside less, so it is asked until nothing is.
    """
    kept, count = list(items), len(items) + 1
    while len(kept) < count:
        count = len(kept)
        for item in reversed(kept):
            fewer = [other for other in kept if other is not item]
            if refuted(fewer):
                kept = fewer
    return tuple(kept)
