"""Limits of coordinates, rates and accelerations along a validated tube."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from flint import arb

from compiler.expressions.evaluators.balls import SIGNS, below
from solvers.verifier.proofs.enclosure import TubeSegment, polynomial
from solvers.verifier.proofs.linearisation import Coefficients
from solvers.verifier.proofs.moved_set import Spread
from solvers.verifier.proofs.tube_checks import (
    MOST_SPLITS,
    MOST_UNBOUNDED_SPLITS,
    REFINEMENT,
    Status,
    Stretch,
)

LIMITS = "range of", "rate of"
"""How the names of limits begin: those of coordinates, and those of rates."""


@dataclass(slots=True)
class StateLimit:
    """A coordinate or rate stays in an interval; a bound of None is unlimited.

    ``lower``, ``upper`` and ``margin`` are in ``unit``, ``time`` is in seconds.
    """

    name: str
    unit: str
    weights: tuple[int, ...]
    lower: arb | None
    upper: arb | None
    margin: float = float("inf")
    time: float = 0.0
    status: Status = Status.HOLDS

    def sums(self, size: int) -> Sequence[Sequence[int]]:
        """The weights of the limited sums of entries of a state with ``size`` entries."""
        del size
        return [self.weights]

    def polynomials(self, segment: TubeSegment) -> Sequence[Coefficients]:
        """The limited quantities as polynomials of time in a segment, with ball coefficients."""
        return [weighted_sum(row, segment.states) for row in self.sums(len(segment.states))]

    def gap(self, state: Sequence[arb]) -> arb:
        """The distance to the nearer end, for a state given as balls."""
        sums = self.sums(len(state))
        return self.least(
            sum((w * x for w, x in zip(row, state, strict=True)), arb(0)) for row in sums
        )

    def least(self, values: Iterable[arb]) -> arb:
        """The least distance of some values from the nearer end."""
        gap = arb("inf")
        for value in values:
            gap = gap.min(self.gap_of(value))
        return gap

    def gap_of(self, value: arb) -> arb:
        """The distance of a value from the nearer end."""
        gap = arb("inf")
        if self.lower is not None:
            gap = gap.min(value - self.lower)
        if self.upper is not None:
            gap = gap.min(self.upper - value)
        return gap

    def gap_in(self, spread: Spread, time: arb) -> arb:
        """The distance in a wide tube, at an instant or over a ball of times."""
        return self.least(spread.value(row, time) for row in self.sums(len(spread.reach)))

    def give_up(self, stretch: Stretch) -> None:
        """Become undecided, unless refuted: nothing finite is known of a stretch."""
        if self.status is Status.HOLDS:
            self.status, self.margin = Status.UNDECIDED, float("-inf")
            self.time = float(stretch.time.mid())

    def note(self, status: Status, margin: float, time: arb) -> None:
        """Record the result of a slice."""
        self.status, self.margin, self.time = status, margin, float(time.mid())


@dataclass(slots=True)
class AccelerationLimit(StateLimit):
    """The acceleration of a joint stays in an interval; ``weights`` are those of its coordinate."""

    def polynomials(self, segment: TubeSegment) -> Sequence[Coefficients]:
        """The acceleration."""
        return [weighted_sum(self.weights, segment.accelerations)]

    def gap_in(self, spread: Spread, time: arb) -> arb:
        """Minus infinity: a spread adds nothing to what the segment shows."""
        del spread, time
        return arb("-inf")


def weighted_sum(weights: Sequence[int], parts: Sequence[Coefficients]) -> Coefficients:
    """A weighted sum of polynomials."""
    pairs = [(w, x) for w, x in zip(weights, parts, strict=True) if w]
    length = max((len(x) for _, x in pairs), default=0)
    return [sum((w * x[k] for w, x in pairs if k < len(x)), arb(0)) for k in range(length)]


def check_limits(whole: Stretch, limits: Sequence[StateLimit]) -> None:
    """Check every limit over a stretch, updating its margin and status."""
    for limit in limits:
        course = _Course.of(whole.segment, limit)
        pending = [whole]
        while pending:
            stretch = pending.pop()
            gaps = course.gaps(stretch)
            if gaps is None:
                last = stretch.depth == MOST_UNBOUNDED_SPLITS
                if last:
                    limit.give_up(stretch)
            else:
                last = _settle_limit(limit, stretch, *gaps)
            if not last:
                pending += stretch.halves()


@dataclass(frozen=True, slots=True)
class _Course:
    """The limited quantities during a segment: polynomials of time, with their derivatives."""

    limit: StateLimit
    polynomials: Sequence[tuple[Sequence[arb], Sequence[arb]]]

    @staticmethod
    def of(segment: TubeSegment, limit: StateLimit) -> _Course:
        """The polynomials of a limit in a segment."""
        found = limit.polynomials(segment)
        slopes = ([k * item for k, item in enumerate(whole)][1:] for whole in found)
        return _Course(limit, list(zip(found, slopes, strict=True)))

    def gaps(self, stretch: Stretch) -> tuple[arb, arb] | None:
        """The distance to the limit over a stretch, and at its middle; None if not finite.

        Values are bounded about those at the middle by the mean value theorem.
        """
        off, values, centres = SIGNS * stretch.half, list[arb](), list[arb]()
        for whole, slope in self.polynomials:
            centres.append(polynomial(whole, stretch.middle))
            values.append(centres[-1] + polynomial(slope, stretch.middle + off) * off)
        if not all(item.is_finite() for item in values):
            return None
        return self.limit.least(values), self.limit.least(centres)


def _settle_limit(limit: StateLimit, stretch: Stretch, over: arb, middle: arb) -> bool:
    """Whether a limit needs no smaller slices, given its distances over this slice."""
    if limit.status is Status.FAILS:
        return True
    spread = stretch.segment.spread
    if spread is not None and not over > 0:
        times = stretch.middle + SIGNS * stretch.half, stretch.middle
        closer, shown_there = (limit.gap_in(spread, time) for time in times)
        over, middle = over.max(closer.lower()), middle.max(shown_there.lower())
    time, depth = stretch.time, stretch.depth
    lower, shown = below(over), below(middle)
    if bool(middle < 0):
        limit.note(Status.FAILS, float(middle.mid()), time)
        return True
    if not lower > 0:
        if limit.status is Status.UNDECIDED:
            limit.margin = min(limit.margin, shown)
            return True
        if depth == MOST_SPLITS:
            limit.note(Status.UNDECIDED, lower, time)
        return depth == MOST_SPLITS
    if limit.status is Status.HOLDS and lower < limit.margin:
        if shown - lower > REFINEMENT * shown and depth < MOST_SPLITS:
            return False
        limit.note(Status.HOLDS, lower, time)
    return True
