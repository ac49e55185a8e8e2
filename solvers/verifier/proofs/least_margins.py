"""Margins of conditions that hold along a whole tube, refined where they are least."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from fractions import Fraction
from heapq import heappop, heappush

from compiler.expressions.evaluators.balls import below
from solvers.verifier.proofs.point_map import PointMap, Slice
from solvers.verifier.proofs.tube_checks import (
    MOST_SPLITS,
    REFINEMENT,
    Constraint,
    HeldSlice,
    Status,
    Stretch,
)


def close_margins(point_map: PointMap, constraints: Sequence[Constraint]) -> None:
    """Refine the margins of conditions that hold along a whole tube, where they are least.

    A margin is a bound for all slices: it is no larger than that of any remaining slice.
    """
    slices = _Slices(point_map)
    for constraint in constraints:
        if constraint.status is Status.HOLDS and constraint.held:
            _close_margin(slices, constraint)


@dataclass(slots=True)
class _Slices:
    """Positions over stretches of a tube, shared by the conditions."""

    point_map: PointMap
    known: dict[tuple[Fraction, int, int], Slice | None] = field(default_factory=dict)

    def over(self, stretch: Stretch) -> Slice | None:
        """The positions over a stretch; None if they are not finite."""
        segment = stretch.segment
        key = segment.steps[0], stretch.depth, stretch.index
        if key not in self.known:
            inputs, middle, half = stretch.inputs, stretch.middle, stretch.half
            self.known[key] = self.point_map.over(segment, inputs, middle, half)
        return self.known[key]


def _close_margin(slices: _Slices, constraint: Constraint) -> None:
    """Halve the slice of the least margin until this is close to the margin at its middle."""
    held, count = constraint.held, len(constraint.held)
    while True:
        least = heappop(held)
        stretch = least.stretch
        over = slices.over(stretch)
        if over is None:
            constraint.margin = min(least.margin, constraint.hope)
            constraint.time = float(stretch.time.mid())
            return
        bound, middle = constraint.bound(over)
        lower, shown = max(least.margin, below(bound)), below(middle)
        constraint.hope = min(constraint.hope, shown)
        if held and lower > held[0].margin:
            count += 1
            heappush(held, HeldSlice(lower, count, stretch))
            continue
        if shown - lower <= REFINEMENT * shown or stretch.depth == MOST_SPLITS:
            # On slices not in ``held`` the margin is at least ``hope``.
            constraint.note(Status.HOLDS, min(lower, constraint.hope), over)
            return
        for half in stretch.halves():
            within = slices.over(half)
            margin = lower
            if within is not None:
                bound, middle = constraint.bound(within)
                margin = max(lower, below(bound))
                constraint.hope = min(constraint.hope, below(middle))
            count += 1
            heappush(held, HeldSlice(margin, count, half))
