"""How far a momentum brings its measure up, or down, where weight pulls one way.

Let p grow by at most ``growth`` per second, which may be negative, and be at most ``first`` at the
start.  Then the positive part of p is at most that of first + growth t; in the same way backwards
from the end, where p is known.  Twice: for p, and for -p.
"""

from __future__ import annotations

from dataclasses import dataclass

from flint import arb

from compiler.expressions.evaluators.intervals import Ends

ZERO = arb(0)


@dataclass(frozen=True, slots=True)
class Side:
    """A bound of p from one end of the motion: ``size`` >= 0 there, ``growth`` per second."""

    size: arb
    growth: arb

    def area(self, time: arb) -> arb:
        """An upper bound of the integral of the positive part of p over so many seconds."""
        if self.growth < 0 and not self.size + self.growth * time >= 0:
            return (self.size * self.size / (-2 * self.growth)).upper()
        return (self.size * time + self.growth * time * time / 2).upper()


def climb(first: Side, last: Side | None, time: arb) -> arb:
    """An upper bound of the integral of the positive part of p over the whole motion."""
    if last is None:
        return first.area(time)
    turn, steepness = time, first.growth + last.growth
    if steepness > 0:
        # Any instant is right; best is where both bounds meet.
        meeting = (last.size + last.growth * time - first.size) / steepness
        turn = meeting.mid().max(ZERO).min(time)
    return (first.area(turn) + last.area(time - turn)).upper().min(first.area(time))


@dataclass(frozen=True, slots=True)
class OneWay:
    """A measure on a line: its values at the start and the goal, how far it gets up and down."""

    start: Ends
    goal: Ends
    up: arb
    down: arb

    def admits(self, low: arb, high: arb) -> bool:
        """Whether a motion may have a value in [low, high] on its way."""
        climbs = (low - self.start.high, self.goal.low - high)
        falls = (self.start.low - high, low - self.goal.high)
        return not (any(way > self.up for way in climbs) or any(way > self.down for way in falls))
