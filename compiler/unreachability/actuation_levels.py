r"""How far, how fast and to what energy drives can bring a robot in a given time.

Let s' = sqrt(q' M q'), the speed in the kinetic metric, so that s'^2 / 2 is the kinetic energy, and
E = s'^2 / 2 + V. The forces on the joints are u - b q' with b >= 0. From dE/dt = q'(u - b q'),

.. math:: s' s'' \le \dot q^\top (u - g) \le s' \lVert u - g \rVert_{M^{-1}}, \qquad
    \dot E \le s' \lVert u \rVert_{M^{-1}} \le \sqrt{2 (E - V_{\min})}\, \lVert u \rVert_{M^{-1}}

so with a >= ||u - g||, p >= ||u|| on the whole motion, and e = E - Vmin,

.. math:: s'(t) \le s'(0) + a t, \qquad \sqrt{2 e(t)} \le \sqrt{2 e(0)} + p t.

If the joints' rates have bounds r, dE/dt is also at most the power P = max of |u| . r.

(Both quantities are Lipschitz; where one is zero, apply the bound to sqrt(x^2 + d^2) and let d tend
to 0.) Without friction the same holds backwards from the end, if the speed or the energy is known
there. The kinetic length of the motion, the integral of s', is at most that of either bound, as
s'^2 <= 2 e.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

from flint import arb

from compiler.expressions.evaluators.intervals import Ends
from compiler.unreachability.actuation_bounds import BoxBounds


@dataclass(frozen=True, slots=True)
class Ramp:
    """A quantity x >= 0 on [0, T] that changes by at most ``growth`` per second.

    It is at most ``first`` at the start, and at most ``last`` at the end if that is known and the
    bound on the growth also holds backwards.
    """

    first: arb
    growth: arb
    last: arb | None = None

    def _turn(self, time: arb) -> arb:
        """About when the bounds from both ends meet; any time is valid, the exact one is best."""
        if self.last is None:
            return time
        if not self.growth > 0:
            return time if self.first <= self.last else arb(0)
        meeting = ((self.last - self.first) / self.growth + time) / 2
        return meeting.mid().max(arb(0)).min(time)

    def highest(self, time: arb) -> arb:
        """An upper bound of x on [0, ``time``]."""
        one = self.first + self.growth * time
        if self.last is None:
            return one.upper()
        both = (self.first + self.last + self.growth * time) / 2
        return one.min(self.last + self.growth * time).min(both).upper()

    def integral(self, time: arb) -> arb:
        """An upper bound of the integral of x over [0, ``time``]."""
        turn = self._turn(time)
        area = self.first * turn + self.growth * turn * turn / 2
        if self.last is not None:
            rest = time - turn
            area += self.last * rest + self.growth * rest * rest / 2
        return area.upper()


@dataclass(frozen=True, slots=True)
class Budget:
    """Upper bounds on a motion: kinetic length, kinetic speed, and total energy E (J)."""

    length: arb
    speed: arb
    energy: arb


@dataclass(frozen=True, slots=True)
class RateBounds:
    """The bounds from rate limits of all joints: the largest s' at such rates, and the power P."""

    speed: arb
    power: arb


def budget(
    speed: Ramp, energy: Ramp, lowest: arb, time: arb, rates: RateBounds | None = None
) -> Budget:
    """The upper bounds on a motion.

    Args:
        speed: s', that is sqrt(2 (E - V)).
        energy: sqrt(2 (E - Vmin)).
        lowest: a lower bound of V on the motion.
        time: T, in seconds.
        rates: None if some joint has no rate limits.
    """
    top = energy.highest(time)
    fastest = speed.highest(time)
    if rates is not None:
        last = None if energy.last is None else energy.last**2 / 2
        work = Ramp(energy.first**2 / 2, rates.power, last)
        top = top.min((2 * work.highest(time)).sqrt()).upper()
        fastest = fastest.min(rates.speed)
    fastest = fastest.min(top)
    length = speed.integral(time).min(energy.integral(time)).min(fastest * time)
    return Budget(length.upper(), fastest.upper(), (lowest + top * top / 2).upper())


# --- What it takes to bring a measure f from one value to another, level by level -----------------
#
# From f <= low to f >= high (or back) a motion passes every level between. While f is in the
# interval [l, l + w], |df| <= c ds with the largest steepness c of the boxes where f may have such
# values. So its kinetic length L and its time T satisfy
#
# .. math:: L \ge \sum_k w_k / c_k, \qquad T \ge \sum_k w_k / \min(c_k s_k, r_k)
#
# with the largest kinetic speed s_k there, at most sqrt(2 (E - V)), and the largest |df/dt|, r_k,
# that the joints' rates allow.


LEVELS = 24
"""The number of levels between two values."""
TINY = arb(2) ** -200
"""Stands for a slope of zero: such levels take practically infinite time."""


@dataclass(frozen=True, slots=True)
class Needed:
    """Lower bounds of the kinetic length and of the time (s)."""

    length: arb
    time: arb


def needed(
    measure: int, low: arb, high: arb, all_bounds: Sequence[BoxBounds], budget: Budget | None
) -> Needed:
    """The least length and time of a motion from one value of a measure to another.

    Args:
        measure: its number in the bounds.
        low: the one value, exact.
        high: the other value, exact and larger.
        all_bounds: the bounds of all boxes that the motion may be in.
        budget: bounds on the motion; None if nothing is known.
    """
    edges = [low, *((low + (high - low) * j / LEVELS).mid() for j in range(1, LEVELS)), high]
    length = time = arb(0)
    for first, last in pairwise(edges):
        here = [
            box
            for box in all_bounds
            if not (box.courses[measure].high < first or box.courses[measure].low > last)
        ]
        if not here:
            continue  # no pose has such a value: counting nothing gives a smaller, valid bound
        steepness = largest([box.courses[measure].steepness for box in here])
        if steepness is not None:
            length += (last - first) / steepness.max(TINY)
        speed = _speed(measure, here, steepness, budget)
        if speed is not None:
            time += (last - first) / speed.max(TINY)
    return Needed(length.lower(), time.lower())


def _speed(
    measure: int, all_bounds: Sequence[BoxBounds], steepness: arb | None, budget: Budget | None
) -> arb | None:
    """The largest |df/dt| in some boxes."""
    known = largest([box.courses[measure].speed for box in all_bounds])
    if steepness is None or budget is None:
        return known
    kinetic = budget.speed
    for_moving = budget.energy - least([box.potential.low for box in all_bounds])
    if for_moving > 0:
        kinetic = kinetic.min((2 * for_moving.upper()).sqrt())
    driven = (steepness * kinetic).upper()
    return driven if known is None else driven.min(known)


def largest(values: Sequence[arb | None]) -> arb | None:
    """The largest of some non-negative numbers; None if one is unknown."""
    result = arb(0)
    for value in values:
        if value is None:
            return None
        result = result.max(value)
    return result


def least(values: Sequence[arb]) -> arb:
    """The least of some numbers."""
    result = values[0]
    for value in values[1:]:
        result = result.min(value)
    return result


# --- How far a momentum raises or lowers its measure if weight pulls one way ----------------------
#
# Let p grow by at most ``growth`` per second, which may be negative, and be at most ``first`` at
# the start. Then the positive part of p is at most that of first + growth t, and likewise backwards
# from the end if p is known there. This is used twice: for p, and for -p.


ZERO = arb(0)


@dataclass(frozen=True, slots=True)
class Side:
    """A bound of p from one end of the motion: ``size`` >= 0 there, ``growth`` per second."""

    size: arb
    growth: arb

    def area(self, time: arb) -> arb:
        """An upper bound of the integral of the positive part of p over the given time (s)."""
        if self.growth < 0 and not self.size + self.growth * time >= 0:
            return (self.size * self.size / (-2 * self.growth)).upper()
        return (self.size * time + self.growth * time * time / 2).upper()


def climb(first: Side, last: Side | None, time: arb) -> arb:
    """An upper bound of the integral of the positive part of p over the whole motion."""
    if last is None:
        return first.area(time)
    turn, steepness = time, first.growth + last.growth
    if steepness > 0:
        # Any instant is valid; the best one is where both bounds meet.
        meeting = (last.size + last.growth * time - first.size) / steepness
        turn = meeting.mid().max(ZERO).min(time)
    return (first.area(turn) + last.area(time - turn)).upper().min(first.area(time))


@dataclass(frozen=True, slots=True)
class OneWay:
    """A measure on a line: its values at the start and the goal, and how far it goes up, down."""

    start: Ends
    goal: Ends
    up: arb
    down: arb

    def admits(self, low: arb, high: arb) -> bool:
        """Whether a motion may have a value in [low, high] on its way."""
        climbs = (low - self.start.high, self.goal.low - high)
        falls = (self.start.low - high, low - self.goal.high)
        return not (any(way > self.up for way in climbs) or any(way > self.down for way in falls))
