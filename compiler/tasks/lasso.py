"""Sets of instants of a motion that goes on for ever: a prefix, then a loop that repeats.

Such a set is ultimately periodic. It is given by its part in [0, T), where T is the end of the
first round of the loop. The instant T is the first of the next round; whether the set contains T is
ignored.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from compiler.tasks.time_set import BEFORE, TimeSet


@dataclass(frozen=True, slots=True)
class Lasso:
    """All instants from 0 on; [``start``, ``end``) repeats for ever.

    Raises:
        ValueError: the loop takes no time, or begins before the motion.
    """

    start: Fraction
    end: Fraction

    def __post_init__(self) -> None:
        if not 0 <= self.start < self.end:
            raise ValueError("a loop takes some time after the beginning of a motion")

    @property
    def period(self) -> Fraction:
        """The duration of a round."""
        return self.end - self.start

    def before(self, times: TimeSet, lower: Fraction, upper: Fraction | None) -> TimeSet:
        """The instants t such that the set has one in [t + lower, t + upper] (None: any later one).

        Windows beyond the prefix may be moved by whole rounds, and a window that contains a round
        beyond the prefix misses nothing. So the motion is unrolled to at most three times its
        length.
        """
        if upper is None:
            if self._folded(times) & self._round:
                return self._folded(TimeSet.all(self.end))
            return self._folded(self._folded(times).before(lower, None))
        width = min(upper - lower, self.end)
        if lower > self.start:
            lower = self.start + (lower - self.start) % self.period
        unrolled = self.unrolled(times, self.end + lower + width)
        return self._cut(unrolled.before(lower, lower + width))

    def until(self, left: TimeSet, right: TimeSet) -> TimeSet:
        """The instants from which on ``left`` holds until just before some instant of ``right``.

        It is the least fixpoint: an instant of ``right`` must come. If one comes at all, it comes
        within a round, or before the first round is over.
        """
        horizon = self.end + self.period
        return self._cut(self.unrolled(left, horizon).until(self.unrolled(right, horizon)))

    def unrolled(self, times: TimeSet, horizon: Fraction) -> TimeSet:
        """The instants of the set in [0, horizon]."""
        folded = self._folded(times)
        again = (folded & self._round).intervals
        found = list(folded.intervals)
        shift = self.period
        while self.start + shift <= horizon:
            found += [((a + shift, p), (b + shift, q)) for (a, p), (b, q) in again]
            shift += self.period
        return TimeSet.between(max(horizon, self.end), found).cut_off(horizon)

    @property
    def _round(self) -> TimeSet:
        return TimeSet(self.end, ((self.start, BEFORE), (self.end, BEFORE)))

    def _folded(self, times: TimeSet) -> TimeSet:
        """The part of a set in [0, end)."""
        return times & TimeSet(self.end, ((Fraction(0), BEFORE), (self.end, BEFORE)))

    def _cut(self, times: TimeSet) -> TimeSet:
        """The part in [0, end) of a set over a longer time."""
        return self._folded(times.cut_off(self.end))
