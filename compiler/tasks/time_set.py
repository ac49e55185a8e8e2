"""Sets of instants: finite unions of intervals of [0, T] with exact ends, each open or closed.

A cut (t, 0) lies just before the instant t, a cut (t, 1) just after it. A set is the strictly
ascending sequence of the cuts at which one enters and leaves it: [a, b) is (a, 0), (b, 0), the
instant a alone is (a, 0), (a, 1). So every set has exactly one form, and open and closed ends need
no separate cases.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from fractions import Fraction
from heapq import merge
from typing import TypeAlias

Cut: TypeAlias = tuple[Fraction, int]
BEFORE, AFTER = 0, 1
_START: Cut = (Fraction(0), BEFORE)


@dataclass(frozen=True, slots=True)
class TimeSet:
    """A subset of [0, ``end``]; ``cuts`` as described in this module, none outside [0, end]."""

    end: Fraction
    cuts: tuple[Cut, ...] = ()

    @staticmethod
    def all(end: Fraction) -> TimeSet:
        """[0, end]."""
        return TimeSet(end, (_START, (end, AFTER)))

    @staticmethod
    def closed(end: Fraction, intervals: Iterable[tuple[Fraction, Fraction]]) -> TimeSet:
        """The union of closed intervals with ascending beginnings, cut off at 0 and ``end``."""
        return _union_of(end, (((a, BEFORE), (b, AFTER)) for a, b in intervals))

    @staticmethod
    def between(end: Fraction, intervals: Iterable[tuple[Cut, Cut]]) -> TimeSet:
        """The union of intervals between cuts, with ascending beginnings, within [0, end]."""
        return _union_of(end, intervals)

    def cut_off(self, end: Fraction) -> TimeSet:
        """The part in [0, ``end``]."""
        return _union_of(end, self.intervals)

    def __contains__(self, time: Fraction | int) -> bool:
        return bisect_left(self.cuts, (Fraction(time), AFTER)) % 2 == 1

    def __bool__(self) -> bool:
        return bool(self.cuts)

    @property
    def intervals(self) -> tuple[tuple[Cut, Cut], ...]:
        """The maximal intervals, ascending, each as the cuts at its ends."""
        return tuple(zip(self.cuts[::2], self.cuts[1::2], strict=True))

    @property
    def complement(self) -> TimeSet:
        """The other instants of [0, end]."""
        last: Cut = (self.end, AFTER)
        head = self.cuts[1:] if self.cuts[:1] == (_START,) else (_START, *self.cuts)
        return TimeSet(self.end, head[:-1] if head[-1:] == (last,) else (*head, last))

    def __or__(self, other: TimeSet) -> TimeSet:
        return _combined(self, other, lambda depth: depth >= 1)

    def __and__(self, other: TimeSet) -> TimeSet:
        return _combined(self, other, lambda depth: depth >= 2)

    def __le__(self, other: TimeSet) -> bool:
        return (self & other) == self

    def before(self, lower: Fraction, upper: Fraction | None) -> TimeSet:
        """The instants t such that the set has one in [t + lower, t + upper] (None: to the end)."""
        if upper is None:
            latest = (self.cuts[-1][0] - lower, self.cuts[-1][1]) if self.cuts else _START
            return _union_of(self.end, [(_START, latest)])
        return _union_of(
            self.end,
            (((a - upper, p), (b - lower, q)) for (a, p), (b, q) in self.intervals),
        )

    def until(self, right: TimeSet) -> TimeSet:
        """The instants from which on this set holds until just before some instant of ``right``.

        The instants of ``right`` are among them. Any other t lies inside a maximal interval with
        supremum h and needs an instant t' of ``right`` with t < t' <= h: whether h is in the
        interval does not matter, since only the instants before t' count.
        """
        found: list[tuple[Cut, Cut]] = []
        goals, number, latest = right.intervals, 0, Fraction(-1)
        for low, (high, _) in self.intervals:
            while number < len(goals) and goals[number][0] < (high, AFTER):
                latest = goals[number][1][0]
                number += 1
            # The last one may continue beyond h, and into the next interval.
            found.append((low, (min(latest, high), BEFORE)))
        return _union_of(self.end, found) | right


def _combined(left: TimeSet, right: TimeSet, chosen: Callable[[int], bool]) -> TimeSet:
    """The instants such that ``chosen`` is true for the number of sets that contain them."""
    if left.end != right.end:
        raise ValueError("time sets of different horizons")
    turns = merge(
        ((cut, -1 if i % 2 else 1) for i, cut in enumerate(left.cuts)),
        ((cut, -1 if i % 2 else 1) for i, cut in enumerate(right.cuts)),
    )
    cuts: list[Cut] = []
    depth = 0
    for cut, change in turns:
        before = chosen(depth)
        depth += change
        if chosen(depth) != before:
            if cuts and cuts[-1] == cut:
                cuts.pop()
            else:
                cuts.append(cut)
    return TimeSet(left.end, tuple(cuts))


def _union_of(end: Fraction, intervals: Iterable[tuple[Cut, Cut]]) -> TimeSet:
    """The union of intervals with ascending beginnings, cut off at 0 and ``end``."""
    cuts: list[Cut] = []
    last: Cut = (end, AFTER)
    for low, high in intervals:
        first, final = max(low, _START), min(high, last)
        if first >= final:
            continue
        if cuts and first <= cuts[-1]:
            cuts[-1] = max(cuts[-1], final)
        else:
            cuts += (first, final)
    return TimeSet(end, tuple(cuts))
