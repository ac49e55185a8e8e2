"""Intervals: an expression graph over a box, with the lower and upper end of every value.

Balls are intervals too, but a product of wide balls loses much: (2.75 +- 2.25)^2 extends below
zero, [0.5, 5]^2 does not. The ends are python-flint numbers, rounded outwards. Source: Moore,
Kearfott & Cloud, *Introduction to Interval Analysis* (2009), chapters 2 and 5.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from fractions import Fraction

import numpy as np
from flint import arb

from compiler.arrays import Array
from compiler.expressions.evaluator import Evaluator
from compiler.expressions.evaluators.balls import ball

INFINITY, ZERO, ONE = arb("inf"), arb(0), arb(1)


@dataclass(frozen=True, slots=True)
class Ends:
    """All reals from ``low`` to ``high``, which are exact numbers or infinities."""

    low: arb
    high: arb

    @property
    def undefined(self) -> bool:
        """Whether nothing is known about the value."""
        return bool(self.low.is_nan() or self.high.is_nan())

    @property
    def finite(self) -> bool:
        """Whether both ends are finite."""
        return bool(self.low.is_finite() and self.high.is_finite())

    def ball(self) -> arb:
        """A ball around a finite interval."""
        return self.low.union(self.high)


UNDEFINED = Ends(arb("nan"), arb("nan"))
"""A value that may be undefined somewhere in the box; no comparison with it holds."""


def around(value: arb) -> Ends:
    """The ends of a ball."""
    return outward(value, value)


def between(low: Fraction | None, high: Fraction | None) -> Ends:
    """The interval with rational ends; None stands for an infinite end."""
    lower = -INFINITY if low is None else ball(low).lower()
    return Ends(lower, INFINITY if high is None else ball(high).upper())


def outward(low: arb, high: arb) -> Ends:
    """The lower end of one ball and the upper end of another; undefined if one is unknown."""
    if low.is_nan() or high.is_nan():
        return UNDEFINED
    return Ends(low.lower(), high.upper())


class IntervalEvaluator(Evaluator[Ends]):
    """Values are intervals; a value that is not defined everywhere is undefined."""

    def constant(self, value: Fraction | int) -> Ends:
        """An exact integer, or the ends of a ball around a rational."""
        if isinstance(value, int):
            return Ends(arb(value), arb(value))
        return around(ball(value))

    def pi(self) -> Ends:
        """The ends of a ball around pi."""
        return around(arb.pi())

    def neg(self, argument: Ends, /) -> Ends:
        """The negation."""
        return Ends(-argument.high, -argument.low)

    def twice(self, argument: Ends, /) -> Ends:
        """Twice the argument."""
        return outward(argument.low * 2, argument.high * 2)

    def add(self, left: Ends, right: Ends, /) -> Ends:
        """The sum."""
        return outward(left.low + right.low, left.high + right.high)

    def sub(self, left: Ends, right: Ends, /) -> Ends:
        """The difference."""
        return outward(left.low - right.high, left.high - right.low)

    def mul(self, left: Ends, right: Ends, /) -> Ends:
        """The product."""
        return _product(left, right)

    def div(self, left: Ends, right: Ends, /) -> Ends:
        """The quotient; undefined if the divisor may be zero."""
        return _product(left, self.inv(right))

    def sq(self, argument: Ends, /) -> Ends:
        """The square, which is never negative."""
        size = self.fabs(argument)
        return outward(size.low * size.low, size.high * size.high)

    def inv(self, argument: Ends, /) -> Ends:
        """The reciprocal; undefined if the argument may be zero."""
        if argument.low > 0 or argument.high < 0:
            return outward(1 / argument.high, 1 / argument.low)
        return UNDEFINED

    def sqrt(self, argument: Ends, /) -> Ends:
        """The square root; undefined if the argument may be negative."""
        if argument.low >= 0:
            return outward(argument.low.sqrt(), argument.high.sqrt())
        return UNDEFINED

    def fabs(self, argument: Ends, /) -> Ends:
        """The absolute value."""
        if argument.low >= 0:
            return argument
        if argument.high <= 0:
            return Ends(-argument.high, -argument.low)
        if argument.undefined:
            return UNDEFINED
        return Ends(ZERO, argument.high if argument.high > -argument.low else -argument.low)

    def sign(self, argument: Ends, /) -> Ends:
        """The slopes of the absolute value: all of [-1, 1] if zero is inside."""
        if argument.undefined:
            return UNDEFINED
        return Ends(ONE if argument.low > 0 else -ONE, -ONE if argument.high < 0 else ONE)

    def sin(self, argument: Ends, /) -> Ends:
        """The sine."""
        return _wave(argument, arb.sin, Fraction(1, 2))

    def cos(self, argument: Ends, /) -> Ends:
        """The cosine."""
        return _wave(argument, arb.cos, Fraction(0))

    def tan(self, argument: Ends, /) -> Ends:
        """The tangent; undefined if there may be a pole."""
        if not argument.finite or _integers(argument, Fraction(1, 2)):
            return UNDEFINED
        return outward(argument.low.tan(), argument.high.tan())


INTERVALS = IntervalEvaluator()


def _product(left: Ends, right: Ends) -> Ends:
    if left.undefined or right.undefined:
        return UNDEFINED
    if left.low.is_zero() and left.high.is_zero():
        return left  # an unbounded factor takes only finite values
    if right.low.is_zero() and right.high.is_zero():
        return right
    if left.low >= 0 and right.low >= 0:
        return outward(left.low * right.low, left.high * right.high)
    corners = (
        left.low * right.low,
        left.low * right.high,
        left.high * right.low,
        left.high * right.high,
    )
    if any(corner.is_nan() for corner in corners):
        return UNDEFINED
    low, high = corners[0].lower(), corners[0].upper()
    for corner in corners[1:]:
        lower, upper = corner.lower(), corner.upper()
        low = lower if lower < low else low
        high = upper if upper > high else high
    return Ends(low, high)


def _wave(argument: Ends, function: Callable[[arb], arb], shift: Fraction) -> Ends:
    """A sine or a cosine; its extrema are at multiples of a half turn, shifted by ``shift``."""
    if not argument.finite:
        return UNDEFINED if argument.undefined else Ends(-ONE, ONE)
    extrema = _integers(argument, shift)
    if len(extrema) > 1:
        return Ends(-ONE, ONE)
    start, end = function(argument.low), function(argument.high)
    low = start.lower() if start.lower() < end.lower() else end.lower()
    high = start.upper() if start.upper() > end.upper() else end.upper()
    if extrema:
        return Ends(low, ONE) if extrema[0] % 2 == 0 else Ends(-ONE, high)
    return Ends(low, high)


def _integers(argument: Ends, shift: Fraction) -> range:
    """The integers that x / pi - shift may take in an interval, at most three."""
    pi, offset = arb.pi(), ball(shift)
    first = (argument.low / pi - offset).lower().ceil().unique_fmpz()
    last = (argument.high / pi - offset).upper().floor().unique_fmpz()
    if first is None or last is None:
        return range(3)
    return range(int(first), min(int(last), int(first) + 2) + 1)


# --- Intervals in doubles, for many boxes at once -------------------------------------------------
#
# Rounding is not directed: these results guide a search and prove nothing.
#
# Source: Moore, Kearfott & Cloud, *Introduction to Interval Analysis* (2009), chapters 2 and 5.


HALF_TURN = np.pi
TURN = 2 * np.pi


@dataclass(frozen=True, slots=True, eq=False)
class IntervalBatch:
    """An interval for each of K boxes: ``low`` and ``high`` are (K,), or () if shared by all boxes.

    They are NaN if the value is not defined, or not known to be, somewhere in the box.
    """

    low: Array
    high: Array

    @property
    def magnitude(self) -> Array:
        """The largest absolute value, shape (K,) or ()."""
        return np.asarray(np.maximum(np.abs(self.low), np.abs(self.high)))


class BatchedIntervalEvaluator(Evaluator[IntervalBatch]):
    """Values are intervals, one for each box."""

    def constant(self, value: Fraction | int) -> IntervalBatch:
        """The nearest double, treated as exact."""
        exact = np.asarray(float(value))
        return IntervalBatch(exact, exact)

    def pi(self) -> IntervalBatch:
        """The double nearest to pi, treated as exact."""
        return IntervalBatch(np.asarray(np.pi), np.asarray(np.pi))

    def neg(self, argument: IntervalBatch, /) -> IntervalBatch:
        """The negation."""
        return IntervalBatch(-argument.high, -argument.low)

    def twice(self, argument: IntervalBatch, /) -> IntervalBatch:
        """Twice the argument."""
        return IntervalBatch(2 * argument.low, 2 * argument.high)

    def add(self, left: IntervalBatch, right: IntervalBatch, /) -> IntervalBatch:
        """The sum."""
        return IntervalBatch(left.low + right.low, left.high + right.high)

    def sub(self, left: IntervalBatch, right: IntervalBatch, /) -> IntervalBatch:
        """The difference."""
        return IntervalBatch(left.low - right.high, left.high - right.low)

    def mul(self, left: IntervalBatch, right: IntervalBatch, /) -> IntervalBatch:
        """The product."""
        return product(left, right)

    def sq(self, argument: IntervalBatch, /) -> IntervalBatch:
        """The square, which is never negative."""
        size = self.fabs(argument)
        return IntervalBatch(size.low**2, size.high**2)

    def inv(self, argument: IntervalBatch, /) -> IntervalBatch:
        """The reciprocal; undefined if zero is inside."""
        low, high = argument.low, argument.high
        safe = (low > 0) | (high < 0)
        return IntervalBatch(1 / np.where(safe, high, np.nan), 1 / np.where(safe, low, np.nan))

    def sqrt(self, argument: IntervalBatch, /) -> IntervalBatch:
        """The square root; undefined if a negative number is inside."""
        low, high = argument.low, argument.high
        rooted = np.sqrt(np.where(low >= 0, low, np.nan))
        return _known(rooted, np.sqrt(np.where(low >= 0, high, np.nan)))

    def fabs(self, argument: IntervalBatch, /) -> IntervalBatch:
        """The absolute value."""
        nearest = np.maximum(np.maximum(argument.low, -argument.high), 0.0)
        return IntervalBatch(nearest, argument.magnitude)

    def sign(self, argument: IntervalBatch, /) -> IntervalBatch:
        """The slopes of the absolute value."""
        return IntervalBatch(
            np.where(argument.low > 0, 1.0, -1.0), np.where(argument.high < 0, -1.0, 1.0)
        )

    def sin(self, argument: IntervalBatch, /) -> IntervalBatch:
        """The sine."""
        return _batched_wave(argument, HALF_TURN / 2)

    def cos(self, argument: IntervalBatch, /) -> IntervalBatch:
        """The cosine."""
        return _batched_wave(argument, 0.0)

    def tan(self, argument: IntervalBatch, /) -> IntervalBatch:
        """The tangent; undefined if there is a pole."""
        low, high = argument.low, argument.high
        poles = np.floor(low / HALF_TURN + 0.5) != np.floor(high / HALF_TURN + 0.5)
        return IntervalBatch(
            np.where(poles, np.nan, np.tan(low)), np.where(poles, np.nan, np.tan(high))
        )


def product(left: IntervalBatch, right: IntervalBatch) -> IntervalBatch:
    """The interval of all products."""
    a, b = left.low * right.low, left.high * right.high
    c, d = left.low * right.high, left.high * right.low
    low = np.minimum(np.minimum(a, b), np.minimum(c, d))
    high = np.maximum(np.maximum(a, b), np.maximum(c, d))
    return IntervalBatch(np.asarray(low), np.asarray(high))


def common(one: IntervalBatch, other: IntervalBatch) -> IntervalBatch:
    """The intersection of two enclosures of one value; an undefined enclosure is ignored."""
    return IntervalBatch(np.fmax(one.low, other.low), np.fmin(one.high, other.high))


def _known(low: Array, high: Array) -> IntervalBatch:
    """An interval with both ends known, or undefined."""
    lost = np.isnan(low) | np.isnan(high)
    return IntervalBatch(np.where(lost, np.nan, low), np.where(lost, np.nan, high))


def _batched_wave(argument: IntervalBatch, lead: float) -> IntervalBatch:
    """The cosine of an angle minus ``lead``, by the positions of its extrema."""
    low, high = argument.low - lead, argument.high - lead
    start, end = np.cos(low), np.cos(high)
    peak = np.ceil(low / TURN) * TURN <= high
    trough = np.ceil(low / TURN - 0.5) * TURN + HALF_TURN <= high
    return IntervalBatch(
        np.where(trough, -1.0, np.minimum(start, end)),
        np.where(peak, 1.0, np.maximum(start, end)),
    )
