"""What must hold at every instant, checked on a validated tube.

Over a slice of time of half-width d about its middle, a position is enclosed to second order,

    p(s) in p(0) + p'(0) s + [p''/2] s^2,   |s| <= d,

the first two at the middle and the last over the whole slice.  A slice on which a constraint is
not decided is halved, so that every answer is a proof or an honest "undecided".
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import Enum
from fractions import Fraction
from itertools import combinations

from flint import arb, arb_series, ctx

from compiler.arithmetic.balls import BallArithmetic, SeriesArithmetic, ball
from compiler.dynamics.tape import Tape
from compiler.geometry.polytope import Polytope
from solvers.verifier.proofs.enclosure import TubeSegment, VectorField

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
class Slice:
    """Positions over a slice of time: per point and axis (p(0), p'(0), p''/2) and half-width d."""

    time: arb
    half: arb
    points: tuple[tuple[tuple[arb, arb, arb], ...], ...]

    def form(self, normal: Sequence[arb], point: int) -> tuple[arb, arb]:
        """Enclosures of ``normal . p`` over the slice and at its middle."""
        zero, one, two = arb(0), arb(0), arb(0)
        for a, (p0, p1, p2) in zip(normal, self.points[point], strict=True):
            zero, one, two = zero + a * p0, one + a * p1, two + a * p2
        s = arb(0, 1) * self.half
        square = arb(0.5, 0.5) * self.half * self.half
        return zero + one * s + two * square, zero


@dataclass(slots=True)
class Constraint:
    """A condition on points at every instant, with the least margin proved so far (metres)."""

    name: str
    margin: float = float("inf")
    time: float = 0.0
    place: tuple[float, ...] = ()
    status: Status = Status.HOLDS


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

    points: tuple[int, ...] = ()
    rows: tuple[Row, ...] = ()
    distance: arb = field(default_factory=lambda: arb(0))

    def bound(self, over: Slice) -> tuple[arb, arb]:
        """The least distance to a facet, less what is asked: over the slice, and at its middle."""
        worst, middle = arb("inf"), arb("inf")
        for point in self.points:
            for item in self.rows:
                value, centre = over.form(item.normal, point)
                worst = worst.min((item.offset - value) / item.length)
                middle = middle.min((item.offset - centre) / item.length)
        return worst - self.distance, middle - self.distance

    def violated(self, over: Slice) -> bool:
        """Whether the condition certainly fails at the middle of the slice."""
        return any(
            bool(over.form(item.normal, point)[1] > item.offset - self.distance * item.length)
            for point in self.points
            for item in self.rows
        )


@dataclass(slots=True)
class Apart(Constraint):
    """The hull of some points stays away from a convex obstacle by more than a distance.

    ``vertices`` is empty for an unbounded obstacle, whose own facets are then the only candidates.
    """

    points: tuple[int, ...] = ()
    rows: tuple[Row, ...] = ()
    vertices: tuple[tuple[arb, ...], ...] = ()
    distance: arb = field(default_factory=lambda: arb(0))

    def bound(self, over: Slice) -> tuple[arb, arb]:
        """The distance along the best separating direction, less what is asked."""
        best = self._best(over, [*self.rows, *self._corners(over)])
        planar = bool(self.rows) and len(self.rows[0].normal) == 2
        if planar or not best[0] > 0:
            best = max(best, self._best(over, self._along_bodies(over)), key=_lower)
        return best

    def _best(self, over: Slice, candidates: Sequence[Row]) -> tuple[arb, arb]:
        """The largest lower bound over the candidates, and its value at the middle."""
        best, middle = arb("-inf"), arb("-inf")
        for item in candidates:
            lower, centre = arb("inf"), arb("inf")
            for point in self.points:
                value, at = over.form(item.normal, point)
                lower, centre = lower.min(value), centre.min(at)
            worth = ((lower - item.offset) / item.length - self.distance).lower()
            if bool(worth > best) or not best.is_finite():
                best = worth
                middle = (centre - item.offset) / item.length - self.distance
        return best, middle

    def violated(self, over: Slice) -> bool:
        """Whether the condition certainly fails at the middle of the slice."""
        return any(
            all(bool(over.form(item.normal, point)[1] < item.offset) for item in self.rows)
            or self._too_near([axis[0] for axis in over.points[point]])
            for point in self.points
        )

    def _too_near(self, p: Sequence[arb]) -> bool:
        """Whether some point of the obstacle is certainly nearer to p than the distance asked.

        The corners, and the feet on the facets that certainly lie in the obstacle, are tried.
        """
        feet = list(self.vertices)
        for item in self.rows:
            over = _product(item.normal, p) - item.offset
            share = over / (item.length * item.length)
            foot = tuple(x - share * a for x, a in zip(p, item.normal, strict=True))
            others = (other for other in self.rows if other is not item)
            if all(bool(_product(o.normal, foot) <= o.offset) for o in others):
                feet.append(foot)
        squares = (_product(gap, gap) for gap in (_minus(p, foot) for foot in feet))
        return any(bool(square < self.distance * self.distance) for square in squares)

    def _along_bodies(self, over: Slice) -> list[Row]:
        """Directions across the segments between the points.

        In the plane a segment misses a convex polygon iff a facet or the segment's own line
        separates them; in space the planes along the segment and an edge of the obstacle, which
        are among those along the segment and two corners, are needed too.
        """
        if len(self.points) < 2 or not self.vertices:
            return []
        normals: list[tuple[arb, ...]] = []
        for i, j in combinations(self.points, 2):
            along = [
                q[0].mid() - p[0].mid() for p, q in zip(over.points[i], over.points[j], strict=True)
            ]
            if len(along) == 2:
                normals.append((-along[1], along[0]))
                continue
            for v, w in combinations(self.vertices, 2):
                x, y, z = ((b - a).mid() for a, b in zip(v, w, strict=True))
                normals.append(
                    (
                        along[1] * z - along[2] * y,
                        along[2] * x - along[0] * z,
                        along[0] * y - along[1] * x,
                    )
                )
        both = [item for n in normals for item in (n, tuple(-a for a in n))]
        rows = (self._supported(normal) for normal in both)
        return [row for row in rows if row is not None]

    def _corners(self, over: Slice) -> list[Row]:
        """The lines from the obstacle's corners to the points.

        Where two corners are nearest, no other direction shows the distance.
        """
        found: list[Row] = []
        for point in self.points:
            middle = [axis[0].mid() for axis in over.points[point]]
            for vertex in self.vertices:
                normal = tuple(x - v.mid() for x, v in zip(middle, vertex, strict=True))
                row = self._supported(normal)
                if row is not None:
                    found.append(row)
        return found

    def _supported(self, normal: tuple[arb, ...]) -> Row | None:
        """The half-space of the obstacle in a direction; None for no direction."""
        length = sum((a * a for a in normal), arb(0)).sqrt()
        if not length > 0:
            return None
        support = arb("-inf")
        for vertex in self.vertices:
            value = sum((a * x for a, x in zip(normal, vertex, strict=True)), arb(0))
            support = support.max(value)
        return Row(normal, support, length)


def _product(left: Sequence[arb], right: Sequence[arb]) -> arb:
    return sum((a * b for a, b in zip(left, right, strict=True)), arb(0))


def _minus(left: Sequence[arb], right: Sequence[arb]) -> list[arb]:
    return [a - b for a, b in zip(left, right, strict=True)]


def _lower(bound: tuple[arb, arb]) -> float:
    value = float(bound[0])
    return value if value == value else float("-inf")


@dataclass(frozen=True, slots=True)
class PointReading:
    """Turns a tube into enclosures of positions: ``tape`` maps (q, theta, k) to all points."""

    tape: Tape
    field: VectorField
    dimension: int

    def positions(self, state: Sequence[arb]) -> list[list[arb]]:
        """Positions (points, d) for a state given as balls."""
        n = self.field.dofs
        flat = self.tape.run([*state[:n], *self.field.tail], BallArithmetic())
        d = self.dimension
        return [flat[i : i + d] for i in range(0, len(flat), d)]

    def over(
        self, segment: TubeSegment, u: Sequence[arb], middle: arb, half: arb
    ) -> tuple[Slice, list[arb]] | None:
        """Positions over a slice of a segment, and the state over it; None where not finite."""
        n, d = self.field.dofs, self.dimension
        state = segment.at(middle + arb(0, 1) * half)
        centre = segment.at(middle)
        try:
            pull = self.field.acceleration(state, u)
        except ZeroDivisionError:
            return None
        if not all(item.is_finite() for item in (*state, *pull)):
            return None
        wide = self._series([[state[i], state[n + i], pull[i] / 2] for i in range(n)], 3)
        near = self._series([[centre[i], centre[n + i]] for i in range(n)], 2)
        flat = [(near[i][0], near[i][1], wide[i][2]) for i in range(len(near))]
        points = tuple(tuple(flat[i : i + d]) for i in range(0, len(flat), d))
        return Slice(segment.start + middle, half, points), state

    def _series(self, q: list[list[arb]], length: int) -> list[arb_series]:
        ctx.cap = length
        tail = [arb_series([item]) for item in self.field.tail]
        return self.tape.run([*(arb_series(item) for item in q), *tail], SeriesArithmetic())


@dataclass(slots=True)
class StateLimit:
    """A coordinate or rate stays in an interval; None is unlimited.  Margin in rad or m (/s)."""

    name: str
    weights: tuple[int, ...]
    lower: arb | None
    upper: arb | None
    margin: float = float("inf")
    time: float = 0.0
    status: Status = Status.HOLDS

    def gap(self, state: Sequence[arb]) -> arb:
        """The distance to the nearer end, for a state given as balls."""
        gap = arb("inf")
        value = sum((w * x for w, x in zip(self.weights, state, strict=True) if w), arb(0))
        if self.lower is not None:
            gap = gap.min(value - self.lower)
        if self.upper is not None:
            gap = gap.min(self.upper - value)
        return gap


def check_segment(
    reading: PointReading,
    segment: TubeSegment,
    u: Sequence[arb],
    constraints: Sequence[Inside | Apart],
    limits: Sequence[StateLimit],
) -> None:
    """Hold every constraint and limit against one segment, updating their margins and status."""
    half = segment.length / 2
    pending = [(half, half, 0, tuple(constraints), tuple(limits))]
    while pending:
        middle, width, depth, open_constraints, open_limits = pending.pop()
        found = reading.over(segment, u, middle, width)
        if found is None:
            again, limits_again = open_constraints, open_limits
        else:
            over, state = found
            again = tuple(c for c in open_constraints if not _settle(c, over, depth))
            limits_again = tuple(
                limit for limit in open_limits if not _settle_limit(limit, over, state, depth)
            )
        if not again and not limits_again:
            continue
        if depth == MOST_SPLITS or (found is None and depth == MOST_UNBOUNDED_SPLITS):
            for item in (*again, *limits_again):
                item.status = _worse(item.status, Status.UNDECIDED)
            continue
        quarter = width / 2
        pending += [
            (centre, quarter, depth + 1, again, limits_again)
            for centre in (middle + quarter, middle - quarter)
        ]


def _worse(a: Status, b: Status) -> Status:
    order = [Status.HOLDS, Status.UNDECIDED, Status.FAILS]
    return max(a, b, key=order.index)


def _settle(constraint: Inside | Apart, over: Slice, depth: int) -> bool:
    """Whether a constraint needs no smaller slices here."""
    bound, middle = constraint.bound(over)
    lower, centre = float(bound.lower()), float(middle.mid())
    if not lower > 0:
        if constraint.violated(over):
            constraint.status = Status.FAILS
            constraint.time = float(over.time.mid())
            constraint.place = _place(over, constraint.points)
            constraint.margin = min(constraint.margin, centre)
            return True
        return False
    if lower >= constraint.margin:
        return True
    if centre - lower > REFINEMENT * centre and depth < MOST_SPLITS:
        return False
    constraint.margin = lower
    constraint.time = float(over.time.mid())
    constraint.place = _place(over, constraint.points)
    return True


def _place(over: Slice, points: Sequence[int]) -> tuple[float, ...]:
    return tuple(float(axis[0].mid()) for axis in over.points[points[0]]) if points else ()


def _settle_limit(limit: StateLimit, over: Slice, state: Sequence[arb], depth: int) -> bool:
    """Whether a limit needs no smaller slices here."""
    gap = limit.gap(state)
    lower = float(gap.lower())
    if bool(gap < 0):
        limit.status, limit.margin, limit.time = (
            Status.FAILS,
            float(gap.mid()),
            float(over.time.mid()),
        )
        return True
    if not lower > 0:
        return False
    if lower < limit.margin:
        if float(gap.rad()) > REFINEMENT * lower and depth < MOST_SPLITS // 2:
            return False
        limit.margin, limit.time = lower, float(over.time.mid())
    return True
