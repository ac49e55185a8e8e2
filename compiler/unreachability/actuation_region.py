r"""The boxes that a motion with bounded drives may be in, from its start to its goal.

R is a set of boxes that contains the whole motion up to its goal. Bounds on the motion follow from
the largest slopes and inputs in R (``actuation_levels.py``): kinetic length L, speed, energy E. A
measure changes by at most its steepness times L in total, and by at most its speed times T. So the
motion stays in those boxes of R that

- have points with V <= E,
- have a total distance from start and goal, in every measure, of at most its largest change,
- are connected by such boxes to the start and to the goal,

and these are the next R.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field

import numpy as np
from flint import arb
from numpy.typing import NDArray

from compiler.expressions.evaluators.intervals import Ends
from compiler.time_limits.time_limit import check_time
from compiler.unreachability.actuation_bounds import BoxBounds, Course, LeafBox
from compiler.unreachability.actuation_levels import (
    Budget,
    OneWay,
    Ramp,
    RateBounds,
    Side,
    budget,
    climb,
    largest,
    least,
)
from compiler.unreachability.actuation_measures import (
    CoordinateMeasure,
    HeightMeasure,
    Measure,
    Momentum,
    MomentumMeasure,
)

ZERO = arb(0)


@dataclass(frozen=True, slots=True)
class Limits:
    """The limits that the task sets: T (s), and the absolute rates of the joints in SI units.

    ``last_rate`` at the goal is None if the task does not limit it, or forces are not known
    backwards; ``power`` (W) of all inputs is None if not all rates have limits. ``pushes`` bounds
    the inputs of joints whose momentum is measured, if friction has no part in it.
    """

    time: arb
    first_rate: arb
    last_rate: arb | None
    power: arb | None
    pushes: Mapping[int, arb]


@dataclass(slots=True, eq=False)
class Region:
    """The set R: ``within`` says which of the boxes belong to it, (K,).

    ``given`` holds the bounds at the start pose if the task gives one.
    """

    measures: Sequence[Measure]
    limits: Limits
    leaves: Sequence[LeafBox]
    all_bounds: Sequence[BoxBounds]
    given: BoxBounds | None
    within: Flags = field(init=False)
    _near: Neighbourhood = field(init=False)
    _starts: Flags = field(init=False)
    _goals: Flags = field(init=False)

    def __post_init__(self) -> None:
        circles = [m.circle for m in self.measures if isinstance(m, CoordinateMeasure)]
        self._near = Neighbourhood([leaf.coordinates for leaf in self.leaves], circles)
        self._starts = np.array([leaf.start_possible for leaf in self.leaves], dtype=bool)
        self._goals = np.array([leaf.goal_possible for leaf in self.leaves], dtype=bool)
        self.within = self._joined(np.ones(len(self.leaves), dtype=bool))

    @property
    def empty(self) -> bool:
        """Whether no motion is left."""
        return not self.within.any()

    @property
    def inside(self) -> list[BoxBounds]:
        """The bounds of all boxes in R."""
        return self._of(self.within)

    @property
    def sources(self) -> list[BoxBounds]:
        """The bounds of the boxes in which the motion may start."""
        return [self.given] if self.given is not None else self._of(self.within & self._starts)

    @property
    def goals(self) -> list[BoxBounds]:
        """The bounds of the boxes in which it may end."""
        return self._of(self.within & self._goals)

    def budget(self) -> Budget | None:
        """Bounds on the motion; None if M or the forces are unknown in some box."""
        inside, sources, goals = self.inside, self.sources, self.goals
        net = largest([box_bounds.net for box_bounds in inside])
        inputs = largest([box_bounds.inputs for box_bounds in inside])
        first = self._kinetic(sources, self.limits.first_rate)
        if net is None or inputs is None or first is None:
            return None
        last = None
        if self.limits.last_rate is not None:
            last = self._kinetic(goals, self.limits.last_rate)
        lowest = least([box_bounds.potential.low for box_bounds in inside])
        energies = [
            None if speed is None else _energy(all_bounds, speed, lowest)
            for all_bounds, speed in ((sources, first), (goals, last))
        ]
        if energies[0] is None:
            return None
        fastest = largest([box_bounds.rate_speed for box_bounds in inside])
        rates = None
        if fastest is not None and self.limits.power is not None:
            rates = RateBounds(fastest, self.limits.power)
        energy = Ramp(energies[0], inputs, energies[1])
        return budget(Ramp(first, net, last), energy, lowest, self.limits.time, rates)

    def shrink(self, found: Budget | None) -> bool:
        """Remove boxes that the motion cannot be in; return whether there were any."""
        kept = self.within.copy()
        reaches = [self.change(number, found) for number in range(len(self.measures))]
        ways = [_Ways(self, number) for number in range(len(self.measures))]
        lines = {number: self.one_way(number) for number in range(len(self.measures))}
        known = {number: line for number, line in lines.items() if line is not None}
        for box, box_bounds in enumerate(self.all_bounds):
            if not kept[box]:
                continue
            kept[box] = not (found is not None and box_bounds.potential.low > found.energy) and all(
                reach is None or not way.least(box_bounds.courses[way.number]) > reach
                for way, reach in zip(ways, reaches, strict=True)
            )
            kept[box] &= all(
                line.admits(box_bounds.courses[number].low, box_bounds.courses[number].high)
                for number, line in known.items()
            )
        kept = self._joined(kept)
        smaller = bool((kept != self.within).any())
        self.within = kept
        return smaller

    def ends(self, number: int, *, start: bool) -> Ends:
        """The values of a measure at the start, or at the goal."""
        courses = [r.courses[number] for r in (self.sources if start else self.goals)]
        low = least([course.low for course in courses])
        high = -least([-course.high for course in courses])
        measure = self.measures[number]
        known = None
        if isinstance(measure, HeightMeasure):
            known = measure.start if start else measure.goal
        return Ends(low, high) if known is None else Ends(low.max(known[0]), high.min(known[1]))

    def spans(self, number: int, *, start: bool) -> Iterator[Ends]:
        """Intervals that contain these values: one for an effector, else split at the gaps."""
        if isinstance(self.measures[number], HeightMeasure):
            yield self.ends(number, start=start)
            return
        courses = [r.courses[number] for r in (self.sources if start else self.goals)]
        courses.sort(key=lambda course: float(course.low))
        low, high = courses[0].low, courses[0].high
        for course in courses[1:]:
            if course.low > high:
                yield Ends(low, high)
                low, high = course.low, course.high
            else:
                low, high = low.min(course.low), high.max(course.high)
        yield Ends(low, high)

    def least_way(self, number: int) -> arb:
        """A lower bound on the distance of a measure from the start to the goal."""
        way = _Ways(self, number)
        return least([way.from_start(span) for span in self.spans(number, start=False)])

    def change(self, number: int, found: Budget | None) -> arb | None:
        """An upper bound on the total change of a measure."""
        measure = self.measures[number]
        if isinstance(measure, MomentumMeasure):
            return self._drift(measure.cyclic)
        courses = [box_bounds.courses[number] for box_bounds in self.inside]
        speed = largest([course.speed for course in courses])
        by_rates = None if speed is None else (speed * self.limits.time).upper()
        steepness = largest([course.steepness for course in courses])
        if found is None or steepness is None:
            return by_rates
        by_length = (steepness * found.length).upper()
        return by_length if by_rates is None else by_length.min(by_rates)

    def one_way(self, number: int) -> OneWay | None:
        """How far momentum raises a measure, and lowers it; None on circles, or if unknown."""
        measure = self.measures[number]
        if measure.circle or not isinstance(measure, MomentumMeasure):
            return None
        found = self._momentum(measure.cyclic)
        if found is None:
            return None
        push, pull = self.limits.pushes[measure.cyclic], found.inside.pull
        rises, falls = push - pull.low, push + pull.high
        ways = [
            climb(
                Side(found.first, growth.upper()),
                None if found.last is None else Side(found.last, back.upper()),
                self.limits.time,
            )
            for growth, back in ((rises, falls), (falls, rises))
        ]
        up, down = ((way / found.inside.inertia).upper() for way in ways)
        return OneWay(self.ends(number, start=True), self.ends(number, start=False), up, down)

    def _drift(self, cyclic: int) -> arb | None:
        """An upper bound on how much momentum changes its measure."""
        found = self._momentum(cyclic)
        if found is None:
            return None
        growth = found.inside.most_pull + self.limits.pushes[cyclic]
        ramp = Ramp(found.first, growth.upper(), found.last)
        return (ramp.integral(self.limits.time) / found.inside.inertia).upper()

    def _momentum(self, cyclic: int) -> _Momenta | None:
        """The bounds on the momentum of a coordinate; None if its drive is unknown."""
        inside, last = together(self.inside, cyclic), self.limits.last_rate
        first, goals = together(self.sources, cyclic), together(self.goals, cyclic)
        if cyclic not in self.limits.pushes or inside is None or first is None or goals is None:
            return None
        return _Momenta(
            inside,
            (first.unit * self.limits.first_rate).upper(),
            None if last is None else (goals.unit * last).upper(),
        )

    def _kinetic(self, all_bounds: Sequence[BoxBounds], rate: arb) -> arb | None:
        """The kinetic speed if all rates are at most ``rate``."""
        if rate.is_zero():
            return ZERO
        unit = largest([box_bounds.unit_speed for box_bounds in all_bounds])
        return None if unit is None else (unit * rate).upper()

    def _joined(self, among: Flags) -> Flags:
        return self._near.joined(self._starts, among) & self._near.joined(self._goals, among)

    def _of(self, flags: Flags) -> list[BoxBounds]:
        return [box_bounds for box_bounds, flag in zip(self.all_bounds, flags, strict=True) if flag]


@dataclass(frozen=True, slots=True)
class _Momenta:
    """Bounds on a momentum: on all boxes, its size at the start, and at the end if known."""

    inside: Momentum
    first: arb
    last: arb | None


class _Ways:
    """Lower bounds on the distance of a measure from the start to a box and on to the goal."""

    def __init__(self, region: Region, number: int) -> None:
        self.number = number
        self._circle = region.measures[number].circle
        self._starts = list(region.spans(number, start=True))
        self._goals = list(region.spans(number, start=False))
        self._known: dict[object, arb] = {}

    def least(self, course: Course) -> arb:
        """A lower bound; not a large one if nothing is known."""
        key = _key(course)
        if key not in self._known:
            side = Ends(course.low, course.high)
            onwards = least([self._gap(side, span) for span in self._goals])
            self._known[key] = self.from_start(side) + onwards
        return self._known[key]

    def from_start(self, side: Ends) -> arb:
        """A lower bound of the way from the start to values in an interval."""
        return least([self._gap(side, span) for span in self._starts])

    def _gap(self, side: Ends, span: Ends) -> arb:
        """The distance between two intervals, on a circle modulo full turns."""
        if not self._circle:
            return _apart(side, span, ZERO)
        turn = 2 * arb.pi()
        difference = (side.low + side.high - span.low - span.high) / 2 / turn
        nearest = round(float(difference.mid()))
        return least([_apart(side, span, turn * (nearest + i)) for i in (-1, 0, 1)])


def _apart(side: Ends, span: Ends, shift: arb) -> arb:
    ahead, behind = span.low + shift - side.high, side.low - shift - span.high
    return ahead.max(behind).max(ZERO).lower()


def together(all_bounds: Sequence[BoxBounds], cyclic: int) -> Momentum | None:
    """The momentum bounds that hold on all of the given boxes."""
    found = [
        item for box_bounds in all_bounds if (item := box_bounds.momenta.get(cyclic)) is not None
    ]
    units = largest([item.unit for item in found])
    if len(found) < len(all_bounds) or units is None:
        return None
    low, high = least([item.pull.low for item in found]), -least([-i.pull.high for i in found])
    return Momentum(least([item.inertia for item in found]), units, Ends(low, high))


def _energy(all_bounds: Sequence[BoxBounds], speed: arb, lowest: arb) -> arb:
    """The square root of 2 (E - Vmin), if kinetic speeds are at most ``speed``."""
    highest = -least([-box_bounds.potential.high for box_bounds in all_bounds])
    above = (highest - lowest).max(ZERO)
    return (2 * above + speed * speed).upper().sqrt().upper()


def _key(course: Course) -> object:
    if not (course.low.is_finite() and course.high.is_finite()):
        return math.nan
    return (*course.low.man_exp(), *course.high.man_exp())


# --- Boxes of coordinates that chains of touching boxes connect to others; none is missed ---------
#
# The sides are floats that extend slightly beyond the boxes: a few boxes too many may touch.


Flags = NDArray[np.bool_]
BEYOND = 1e-9
"""The length added to each side, relative to its position if that is above one."""
FULL_TURN = 6.283185307179586


class Neighbourhood:
    """Closed boxes (K,) of n coordinates; ``circles`` marks the coordinates that are full turns."""

    def __init__(self, boxes: Sequence[Sequence[arb]], circles: Sequence[bool]) -> None:
        shape = (len(boxes), len(circles))
        middle = np.array([[float(side.mid()) for side in box] for box in boxes]).reshape(shape)
        radius = np.array([[float(side.rad()) for side in box] for box in boxes]).reshape(shape)
        radius += BEYOND * (1 + np.abs(middle) + radius)
        self.low, self.high = middle - radius, middle + radius
        self.circles = tuple(circles)

    def joined(self, seeds: Flags, among: Flags) -> Flags:
        """The given boxes that chains of touching ones among them connect to seeds, (K,)."""
        reached = seeds & among
        waiting = [int(i) for i in np.flatnonzero(reached)]
        rest = np.flatnonzero(among & ~reached)
        while waiting and len(rest):
            check_time()
            touching = self._touches(waiting.pop(), rest)
            found = rest[touching]
            reached[found] = True
            waiting += [int(i) for i in found]
            rest = rest[~touching]
        return reached

    def _touches(self, one: int, others: NDArray[np.intp]) -> Flags:
        found: Flags = np.ones(len(others), dtype=bool)
        for i, circle in enumerate(self.circles):
            low, high = self.low[others, i], self.high[others, i]
            meet: Flags = np.zeros(len(others), dtype=bool)
            for shift in (-FULL_TURN, 0.0, FULL_TURN) if circle else (0.0,):
                meet |= (low <= self.high[one, i] + shift) & (self.low[one, i] + shift <= high)
            found &= meet
        return found
