"""How long work of equal-looking parts may still take: a range from what its parts have taken."""

from __future__ import annotations

from collections.abc import Sequence
from statistics import fmean

LEAST_PARTS = 4
"""After fewer finished parts there is no estimate."""
NO_ESTIMATE = "no estimate"


def remaining(finished: Sequence[float], running: float, left: int) -> tuple[float, float] | None:
    """Seconds that the parts which are left may take, at the least and at the most.

    Args:
        finished: what each finished part took, s, in order.
        running: for how long the present part has been under way, s.
        left: how many parts there still are, the present one among them.

    Returns:
        The parts that are left, each as long as those finished on average, all of them or the last
        quarter with the present one, if that is longer already: parts mostly become longer, and a
        range says how much.  None after too few parts.
    """
    if len(finished) < LEAST_PARTS:
        return None
    recent = finished[-max(2, len(finished) // 4) :]
    if running > fmean(recent):
        recent = [*recent, running]
    rates = sorted((fmean(finished), fmean(recent)))
    return left * rates[0], left * rates[1]


def estimate_text(finished: Sequence[float], running: float, left: int | None) -> str:
    """The estimate in words; ``left`` None: nobody knows how many parts there are."""
    expected = None if left is None else remaining(finished, running, left)
    if expected is None:
        return NO_ESTIMATE
    low, high = (duration_text(seconds) for seconds in expected)
    return f"{low} left for all" if low == high else f"{low} to {high} left for all"


def duration_text(seconds: float) -> str:
    """A duration as one says it, in one unit: ``40 s``, ``3 min``, ``2 h``."""
    for unit, size in (("s", 1), ("min", 60), ("h", 3600)):
        if seconds < 100 * size or unit == "h":
            return f"{max(1, round(seconds / size))} {unit}"
    raise AssertionError
