"""Conditions that must hold at every instant, checked on a validated tube.

A time slice on which a constraint is undecided is halved, so that every answer is either a proof or
"undecided".
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
"""Slices without finite bounds are given up sooner."""
REFINEMENT = 0.02
"""A margin is refined until its error is at most this fraction of it."""


class Status(Enum):
    """Proved, disproved, or neither."""

    HOLDS = "holds"
    FAILS = "fails"
    UNDECIDED = "undecided"


@dataclass(frozen=True, slots=True)
class Stretch:
    """A part of a segment: its inputs, and its middle and half-width in seconds.

    ``depth`` counts the halvings; the part has the number ``index`` among 2^``depth`` equal ones.
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
        """The later half, then the earlier one."""
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
    """A stretch on which a condition has at least ``margin``; ``number`` orders equal ones."""

    margin: float
    number: int
    stretch: Stretch = field(compare=False)


@dataclass(slots=True)
class Constraint(ABC):
    """A condition on points at every instant, with the least margin proved so far (metres).

    ``time`` and ``place`` say where this margin is. If the condition is not proved, they say where
    this happens first, and ``margin`` is about how far, at worst, a wide tube exceeds it.
    """

    name: str
    points: tuple[int, ...] = ()
    extensions: tuple[Extension, ...] = ()
    margin: float = float("inf")
    time: float = 0.0
    place: tuple[float, ...] = ()
    status: Status = Status.HOLDS
    hope: float = float("inf")
    """An upper bound of the margin: the least value known at the middle of a slice."""
    held: list[HeldSlice] = field(default_factory=list["HeldSlice"])
    """Slices on which the condition holds and which may have the least margin."""

    @property
    def unit(self) -> str:
        """The unit of the margin."""
        return "m"

    @abstractmethod
    def bound(self, over: Slice) -> tuple[arb, arb]:
        """The distance to a violation: a lower bound over the slice, and at its middle."""

    def glance(self, over: Slice) -> float:
        """A cheap lower bound over the slice, or -inf if it would be much worse than ``bound``."""
        del over
        return float("-inf")

    @abstractmethod
    def violated(self, over: Slice) -> bool:
        """Whether the condition certainly fails at the middle of the slice."""

    @abstractmethod
    def where(self, over: Slice) -> tuple[float, ...]:
        """The place at the middle of the slice to which the bound refers."""

    def hold(self, lower: float, stretch: Stretch) -> None:
        """Keep a stretch with a margin of at least ``lower``, if it may be the least margin."""
        if lower < self.hope:
            heappush(self.held, HeldSlice(lower, len(self.held), stretch))

    def give_up(self, stretch: Stretch) -> None:
        """Become undecided, unless refuted: nothing finite is known of a stretch."""
        if self.status is Status.HOLDS:
            self.status, self.margin = Status.UNDECIDED, float("-inf")
            self.time = float(stretch.time.mid())

    def note(self, status: Status, margin: float, over: Slice) -> None:
        """Record the result of a slice."""
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
        """The least distance to a facet, less the required one: over a slice and at its middle."""
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
        """Enclosures of ``normal . p`` for the points that may be farthest along a row's normal."""
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
    """Check every constraint over a stretch, updating its margin and status."""
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
    """Positions over a stretch; tighter ones on demand.

    In a wide tube the entries of a state depend on each other; boxes lose this dependence.
    """

    point_map: PointMap
    stretch: Stretch
    over: Slice
    together: Slice | None = None

    def bound(self, constraint: Constraint) -> tuple[Slice, arb, arb]:
        """The positions used for a bound, and the bound over the stretch and at its middle."""
        bound, middle = constraint.bound(self.over)
        spread = self.stretch.segment.spread
        if spread is None or bound > 0:
            return self.over, bound, middle
        if self.together is None:
            segment = self.stretch.segment
            self.together = self.point_map.closer(segment, self.stretch.middle, self.over)
        return self.together, *constraint.bound(self.together)


def _settle(constraint: Constraint, view: _View) -> bool:
    """Whether a constraint needs no smaller slices here.

    In a wide tube, smaller slices show no more than the bound at the middle of a slice. Once a
    constraint is undecided, later times are only checked for a violation and for how open it is.
    """
    if constraint.status is Status.FAILS:
        return True
    stretch = view.stretch
    if constraint.status is Status.HOLDS:
        # Slices that may have the least margin are refined at the end.
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
