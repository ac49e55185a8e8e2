"""What must hold at every instant, checked on a validated tube.

A slice of time on which a constraint is not decided is halved, so that every answer is a proof or
an honest "undecided".
"""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from enum import Enum
from fractions import Fraction
from heapq import heappush

from flint import arb

from compiler.expressions.evaluators.balls import ball, below
from compiler.workspaces.polytope import Polytope
from solvers.verifier.proofs.enclosure import TubeSegment
from solvers.verifier.proofs.extension import Extension, lowest
from solvers.verifier.proofs.point_map import PointMap, Slice

MOST_SPLITS = 12
MOST_UNBOUNDED_SPLITS = 5
"""Slices over which nothing finite is known are given up sooner."""
REFINEMENT = 0.02
"""A margin is refined until it is known to this fraction of itself."""


class Status(Enum):
    """Proved, disproved, or neither."""

    HOLDS = "holds"
    FAILS = "fails"
    UNDECIDED = "undecided"


@dataclass(frozen=True, slots=True)
class Stretch:
    """A part of a segment: the inputs in force, the middle and half-width in seconds.

    ``depth`` counts the halvings, and it is part ``index`` of 2^``depth`` equal ones.
    """

    segment: TubeSegment
    inputs: Sequence[arb]
    middle: arb
    half: arb
    depth: int
    index: int = 0

    @staticmethod
    def of(segment: TubeSegment, inputs: Sequence[arb]) -> Stretch:
        """A whole segment."""
        half = segment.length / 2
        return Stretch(segment, inputs, half, half, 0)

    @property
    def time(self) -> arb:
        """The time of its middle."""
        return self.segment.start + self.middle

    def halves(self) -> tuple[Stretch, Stretch]:
        """The later half, and the earlier one."""
        quarter = self.half / 2
        later, earlier = (
            Stretch(self.segment, self.inputs, middle, quarter, self.depth + 1, index)
            for middle, index in (
                (self.middle + quarter, 2 * self.index + 1),
                (self.middle - quarter, 2 * self.index),
            )
        )
        return later, earlier


@dataclass(frozen=True, slots=True, order=True)
class HeldSlice:
    """A stretch on which a condition holds by at least ``margin``; ``number`` orders equal ones."""

    margin: float
    number: int
    stretch: Stretch = field(compare=False)


@dataclass(slots=True)
class Constraint(ABC):
    """A condition on points at every instant, with the least margin proved so far (metres).

    ``time`` and ``place`` say where that is; of one that is not proved, where it is so first, and
    ``margin`` is then about how much a wide tube outgrows it at worst.
    """

    name: str
    points: tuple[int, ...] = ()
    extensions: tuple[Extension, ...] = ()
    margin: float = float("inf")
    time: float = 0.0
    place: tuple[float, ...] = ()
    status: Status = Status.HOLDS
    hope: float = float("inf")
    """The margin cannot get larger than this: the least that is known of the middle of a slice."""
    held: list[HeldSlice] = field(default_factory=list["HeldSlice"])
    """Slices on which it holds, and which may have the least margin."""

    @property
    def unit(self) -> str:
        """Of the margin."""
        return "m"

    @abstractmethod
    def bound(self, over: Slice) -> tuple[arb, arb]:
        """The distance to a violation: a lower bound over the slice, and at its middle."""

    def glance(self, over: Slice) -> float:
        """A lower bound over the slice that takes little, if it is not much worse than others."""
        del over
        return float("-inf")

    @abstractmethod
    def violated(self, over: Slice) -> bool:
        """Whether the condition certainly fails at the middle of the slice."""

    @abstractmethod
    def where(self, over: Slice) -> tuple[float, ...]:
        """The place at the middle of the slice that its bound is about."""

    def hold(self, lower: float, stretch: Stretch) -> None:
        """Keep a stretch on which it holds by at least ``lower``, if that may be the least."""
        if lower < self.hope:
            heappush(self.held, HeldSlice(lower, len(self.held), stretch))

    def give_up(self, stretch: Stretch) -> None:
        """Nothing finite is known of a stretch: whatever is not refuted is not decided."""
        if self.status is Status.HOLDS:
            self.status, self.margin = Status.UNDECIDED, float("-inf")
            self.time = float(stretch.time.mid())

    def note(self, status: Status, margin: float, over: Slice) -> None:
        """Keep what a slice shows."""
        self.status, self.margin = status, margin
        self.time, self.place = float(over.time.mid()), self.where(over)


@dataclass(frozen=True, slots=True)
class Row:
    """``normal . p <= offset`` with the exact Euclidean length of the normal as a ball."""

    normal: tuple[arb, ...]
    offset: arb
    length: arb


def row(normal: Sequence[Fraction], offset: Fraction) -> Row:
    """A row of a polytope as balls."""
    square = sum((a * a for a in normal), Fraction(0))
    return Row(tuple(ball(a) for a in normal), ball(offset), ball(square).sqrt())


def rows_of(polytope: Polytope) -> tuple[Row, ...]:
    """The rows of a polytope as balls, in the working precision."""
    return tuple(row(item.normal, item.offset) for item in polytope.rows if any(item.normal))


@dataclass(slots=True)
class Inside(Constraint):
    """Points stay inside a polytope, farther than a distance from its facets."""

    rows: tuple[Row, ...] = ()
    distance: arb = field(default_factory=lambda: arb(0))

    def bound(self, over: Slice) -> tuple[arb, arb]:
        """The least distance to a facet, less what is asked: over the slice, and at its middle."""
        worst, middle = arb("inf"), arb("inf")
        for item in self.rows:
            for value, centre in self._farthest(item, over):
                worst = worst.min((item.offset - value) / item.length)
                middle = middle.min((item.offset - centre) / item.length)
        return worst - self.distance, middle - self.distance

    def violated(self, over: Slice) -> bool:
        """Whether the condition certainly fails at the middle of the slice."""
        return any(
            bool(centre > item.offset - self.distance * item.length)
            for item in self.rows
            for _, centre in self._farthest(item, over)
        )

    def _farthest(self, item: Row, over: Slice) -> Iterator[tuple[arb, arb]]:
        """Enclosures of ``normal . p`` of what may be farthest along the normal of a row."""
        if not self.extensions:
            yield from (over.form(item.normal, point) for point in self.points)
            return
        against = [-a for a in item.normal]
        for value, centre in lowest(over, against, self.points, self.extensions):
            yield -value, -centre

    def where(self, over: Slice) -> tuple[float, ...]:
        """The point that is nearest to a facet, at the middle of the slice."""
        gaps = [
            (float(((item.offset - over.form(item.normal, point)[1]) / item.length).mid()), point)
            for point in self.points
            for item in self.rows
        ]
        return over.middle(min(gaps)[1]) if gaps else ()


def check_segment(point_map: PointMap, whole: Stretch, constraints: Sequence[Constraint]) -> None:
    """Hold every constraint against a stretch, updating its margin and status."""
    pending = [(whole, tuple(constraints))]
    while pending:
        stretch, still = pending.pop()
        over = point_map.over(stretch.segment, stretch.inputs, stretch.middle, stretch.half)
        if over is None:
            last = stretch.depth == MOST_UNBOUNDED_SPLITS
            for item in still if last else ():
                item.give_up(stretch)
        else:
            last = stretch.depth == MOST_SPLITS
            view = _View(point_map, stretch, over)
            still = tuple(item for item in still if not _settle(item, view))
        if still and not last:
            pending += [(half, still) for half in stretch.halves()]


@dataclass(slots=True)
class _View:
    """Positions over a stretch; closer ones where they are asked for.

    In a wide tube the entries of a state go together, which boxes do not show.
    """

    point_map: PointMap
    stretch: Stretch
    over: Slice
    together: Slice | None = None

    def bound(self, constraint: Constraint) -> tuple[Slice, arb, arb]:
        """The positions that show a bound, and the bound over the stretch and at its middle."""
        bound, middle = constraint.bound(self.over)
        spread = self.stretch.segment.spread
        if spread is None or bound > 0:
            return self.over, bound, middle
        if self.together is None:
            segment = self.stretch.segment
            self.together = self.point_map.closer(segment, self.stretch.middle, self.over)
        return self.together, *constraint.bound(self.together)


def _settle(constraint: Constraint, view: _View) -> bool:
    """Whether a constraint needs no smaller slices to be decided here.

    In a wide tube the bound at the middle of a slice is as much as smaller slices may show.  What
    is not decided at one time is only looked at for a violation later, and for how open it gets.
    """
    if constraint.status is Status.FAILS:
        return True
    stretch = view.stretch
    if constraint.status is Status.HOLDS:
        # Where it may be least, it is looked at closely at the end.
        lower = constraint.glance(view.over)
        if lower > 0:
            constraint.hold(lower, stretch)
            return True
    over, bound, middle = view.bound(constraint)
    lower = below(bound)
    if not lower > 0:
        if constraint.violated(over):
            constraint.note(Status.FAILS, min(constraint.hope, float(middle.mid())), over)
            return True
        if constraint.status is Status.UNDECIDED:
            constraint.margin = min(constraint.margin, below(middle))
            return True
        if stretch.depth == MOST_SPLITS:
            constraint.note(Status.UNDECIDED, lower, over)
        return stretch.depth == MOST_SPLITS
    if constraint.status is Status.HOLDS and lower < constraint.hope:
        constraint.hold(lower, stretch)
        constraint.hope = min(constraint.hope, below(middle))
    return True
