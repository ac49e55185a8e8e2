r"""Where a frame may be, for many robots at once: a set of positions that is simple to compose.

The origin is a point of a box plus a vector of which only the length is known:

.. math:: p = b + v, \qquad b \in B, \quad r_{low} \le |v| \le r_{high}.

A revolute joint keeps the direction of its axis and makes the directions across it unknown,
whatever its range. Displacements along known directions are added to the box, all others to the
length. Lengths of sums satisfy the triangle inequality on both sides,

.. math:: \bigl| |v| - |w| \bigr| \le |v + w| \le |v| + |w| .

Two such descriptions are kept. In the first one the box moves on as long as directions are known;
in the second it stays with the base, and everything after it is a length. The first preserves
heights; the second keeps apart what comes before the first joint and what comes after it.

Source: Moore, Kearfott & Cloud, *Introduction to Interval Analysis*; Cousot & Cousot (1977) for
joins and widening.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from flint import arb

from compiler.expressions.evaluators.balls import ball
from compiler.expressions.evaluators.intervals import INFINITY, INTERVALS, ZERO, Ends, outward

THIN = Fraction(1, 10**6)
"""The error of a direction, or of a position in metres, up to which it still counts as known."""

Box: TypeAlias = tuple[Ends, Ends, Ends]
Axes: TypeAlias = tuple[Box | None, Box | None, Box | None]

EVERYTHING = Ends(-INFINITY, INFINITY)
NOTHING = Ends(ZERO, ZERO)
ONE = Ends(arb(1), arb(1))
ORIGIN: Box = (NOTHING, NOTHING, NOTHING)
UNITS: tuple[Box, Box, Box] = (
    (ONE, NOTHING, NOTHING),
    (NOTHING, ONE, NOTHING),
    (NOTHING, NOTHING, ONE),
)


def total(value: Ends) -> Ends:
    """The interval, or all numbers if it is undefined."""
    return EVERYTHING if value.undefined else value


@dataclass(frozen=True, slots=True)
class Around:
    """The points of a box (metres), each displaced by a vector of a length within ``off``.

    The vector is orthogonal to the unit vector ``across``, if that is given.
    """

    box: Box
    off: Ends
    across: Box | None = None

    def joined(self, other: Around) -> Around:
        """A description that encloses both."""
        across = _common_normal(self, other)
        return Around(_hull_of(self.box, other.box), hull(self.off, other.off), across)

    def widened(self, other: Around) -> Around:
        """A description that encloses both, with ends that grow set to infinity."""
        x, y, z = (widened(a, b) for a, b in zip(self.box, other.box, strict=True))
        off = widened(self.off, other.off)
        across = _common_normal(self, other)
        return Around((x, y, z), Ends(off.low if off.low > 0 else ZERO, off.high), across)

    def furthest(self, normal: Sequence[Fraction]) -> arb:
        """An upper bound of ``normal`` . p over all points p."""
        square = Ends(ZERO, sum((ball(a * a) for a in normal), ZERO).upper())
        if self.across is not None:
            upright = NOTHING
            for a, entry in zip(normal, self.across, strict=False):
                upright = INTERVALS.add(upright, INTERVALS.mul(_ends(a), entry))
            square = INTERVALS.sub(square, INTERVALS.sq(upright))
        length = square.high.sqrt() if square.high > 0 else ZERO
        found = self.off.high * length if self.off.high > 0 and length > 0 else ZERO
        for a, side in zip(normal, self.box, strict=False):
            if a:
                found += ball(a) * (side.high if a > 0 else side.low)
        return found.upper()

    def nearest(self, centre: Sequence[Fraction]) -> arb:
        """A lower bound of the distance of all points from a point."""
        off = [INTERVALS.sub(side, _ends(c)) for side, c in zip(self.box, centre, strict=False)]
        return (self.off.low - norm(off).high).lower()


@dataclass(frozen=True, slots=True)
class Placement:
    """Where a frame may be: two descriptions of its origin, and its axes in the world.

    An axis that is None may have any direction; the others have entries within intervals.
    """

    known: Around
    based: Around
    axes: Axes

    @property
    def views(self) -> tuple[Around, Around]:
        """Both descriptions of the origin; each of them holds."""
        return self.known, self.based

    def joined(self, other: Placement) -> Placement:
        """A placement that encloses both."""
        x, y, z = (
            None if a is None or b is None else _hull_of(a, b)
            for a, b in zip(self.axes, other.axes, strict=True)
        )
        known, based = self.known.joined(other.known), self.based.joined(other.based)
        return Placement(known, based, (x, y, z))

    def widened(self, other: Placement) -> Placement:
        """A placement that encloses both, with growing ends infinite and changing axes unknown."""
        x, y, z = (
            a if a is not None and a == b else None
            for a, b in zip(self.axes, self.joined(other).axes, strict=True)
        )
        known, based = self.known.widened(other.known), self.based.widened(other.based)
        return Placement(known, based, (x, y, z))

    def then(self, step: Placement) -> Placement:
        """The world placement of the frame ``step``, which is given in this one."""
        known, unknown = _divided(self.axes, step.known.box)
        aside = self._aside(step, unknown)
        axes = self.axes
        if step.axes is not UNITS:
            x, y, z = (self._axis(column) for column in step.axes)
            axes = x, y, z
        return Placement(
            Around(
                _plus(self.known.box, known),
                _sum(self.known.off, aside.off),
                _common_normal(self.known, aside),
            ),
            self._based(step),
            axes,
        )

    def _aside(self, step: Placement, unknown: Sequence[Ends]) -> Around:
        """The vectors that a step adds in unknown directions, from the origin."""
        known = [axis for axis in self.axes if axis is not None]
        own = Around(ORIGIN, norm(unknown), known[0] if len(known) == 1 else None)
        behind = Around(ORIGIN, step.known.off, self._axis(step.known.across))
        return Around(ORIGIN, _sum(own.off, behind.off), _common_normal(own, behind))

    def _based(self, step: Placement) -> Around:
        """The second description: it begins where the step's does, unless something turns."""
        known, unknown = _divided(self.axes, step.based.box)
        if self.based.off == NOTHING and not unknown:
            return Around(_plus(self.based.box, known), step.based.off)
        way = _common(_size(step.known), _size(step.based))
        return Around(self.based.box, _sum(self.based.off, way))

    def _axis(self, column: Box | None) -> Box | None:
        """A direction of this frame, in the world."""
        if column is None:
            return None
        found, lost = ORIGIN, ZERO
        for entry, axis in zip(column, self.axes, strict=True):
            if entry == NOTHING:
                continue
            if axis is None:
                lost += INTERVALS.fabs(entry).high
            else:
                x, y, z = (total(INTERVALS.mul(entry, side)) for side in axis)
                found = _plus(found, (x, y, z))
        if not lost < ball(THIN):
            return None
        slack = Ends(-lost.upper(), lost.upper())
        return _plus(found, (slack, slack, slack)) if lost > 0 else found


def placed(box: Box, axes: Axes = UNITS) -> Placement:
    """A frame at a point of a box."""
    fixed = all(_is_thin(side) for side in box)
    based = Around(box, NOTHING) if fixed else Around(ORIGIN, norm(box))
    return Placement(Around(box, NOTHING), based, axes)


def along(axis: int, way: Ends) -> Placement:
    """A frame displaced along an axis, 0 to 2, by a length in metres."""
    x, y, z = (total(way) if i == axis else NOTHING for i in range(3))
    return placed((x, y, z))


def turned(axis: int, angle: Ends) -> Placement:
    """A frame rotated about an axis, 0 to 2, by an angle (rad)."""
    sine, cosine = total(INTERVALS.sin(angle)), total(INTERVALS.cos(angle))
    first, second = (axis + 1) % 3, (axis + 2) % 3
    columns = [list(unit) for unit in UNITS]
    columns[first][first] = columns[second][second] = cosine
    columns[first][second], columns[second][first] = sine, INTERVALS.neg(sine)
    x, y, z = ((c[0], c[1], c[2]) for c in columns)
    return placed(ORIGIN, (x, y, z))


def freely_turned(axis: int) -> Placement:
    """A frame rotated about an axis, 0 to 2, by any angle."""
    x, y, z = (unit if i == axis else None for i, unit in enumerate(UNITS))
    return placed(ORIGIN, (x, y, z))


# --- Lengths and boxes ----------------------------------------------------------------------------


def _common_normal(a: Around, b: Around) -> Box | None:
    """A direction to which the vectors of both are orthogonal, or None."""
    if a.off == NOTHING:
        return b.across
    return a.across if b.off == NOTHING or a.across == b.across else None


def hull(a: Ends, b: Ends) -> Ends:
    """The least interval that contains both."""
    return Ends(a.low if a.low <= b.low else b.low, a.high if a.high >= b.high else b.high)


def widened(old: Ends, new: Ends) -> Ends:
    """The old interval, with each end that the new one exceeds set to infinity."""
    return Ends(
        -INFINITY if new.low < old.low else old.low, INFINITY if new.high > old.high else old.high
    )


def norm(vector: Sequence[Ends]) -> Ends:
    """The Euclidean lengths of vectors."""
    square = NOTHING
    for entry in vector:
        square = INTERVALS.add(square, INTERVALS.sq(total(entry)))
    return INTERVALS.sqrt(square)


def _sum(a: Ends, b: Ends) -> Ends:
    """The possible lengths of the sum of two vectors of given lengths."""
    low = ZERO
    for one, other in ((a, b), (b, a)):
        left = (one.low - other.high).lower()
        low = left if left > low else low
    return Ends(low, (a.high + b.high).upper())


def _common(a: Ends, b: Ends) -> Ends:
    """The intersection of two intervals that have a common point."""
    return Ends(a.low if a.low >= b.low else b.low, a.high if a.high <= b.high else b.high)


def _size(place: Around) -> Ends:
    """The distances of the points from the origin."""
    return _sum(norm(place.box), place.off)


def _divided(axes: Axes, box: Box) -> tuple[Box, list[Ends]]:
    """A displacement split into the world vector along known axes, and the rest."""
    known, unknown = ORIGIN, list[Ends]()
    for side, axis in zip(box, axes, strict=True):
        if side == NOTHING:
            continue
        if axis is None:
            unknown.append(side)
        else:
            x, y, z = (total(INTERVALS.mul(side, entry)) for entry in axis)
            known = _plus(known, (x, y, z))
    return known, unknown


def _plus(a: Box, b: Box) -> Box:
    x, y, z = (outward(s.low + t.low, s.high + t.high) for s, t in zip(a, b, strict=True))
    return total(x), total(y), total(z)


def _hull_of(a: Box, b: Box) -> Box:
    x, y, z = (hull(s, t) for s, t in zip(a, b, strict=True))
    return x, y, z


def _is_thin(side: Ends) -> bool:
    return bool(side.finite and side.high - side.low < ball(THIN))


def _ends(value: Fraction) -> Ends:
    point = ball(value)
    return Ends(point.lower(), point.upper())


WORLD = placed(ORIGIN)
"""The world frame."""
