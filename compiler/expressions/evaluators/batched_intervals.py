"""Intervals in doubles, for many boxes at once.

Rounding is not directed: what is computed here guides a search, and proves nothing.

Source: Moore, Kearfott & Cloud, *Introduction to Interval Analysis* (2009), chapters 2 and 5.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

import numpy as np

from compiler.arrays import Array
from compiler.expressions.evaluator import Evaluator

HALF_TURN = np.pi
TURN = 2 * np.pi


@dataclass(frozen=True, slots=True, eq=False)
class IntervalBatch:
    """An interval for each of K boxes: ``low`` and ``high`` (K,), or one for all of them ().

    NaN where the value is not defined, or not known to be, somewhere in the box.
    """

    low: Array
    high: Array

    @property
    def magnitude(self) -> Array:
        """The largest absolute value."""
        return np.asarray(np.maximum(np.abs(self.low), np.abs(self.high)))


class BatchedIntervalEvaluator(Evaluator[IntervalBatch]):
    """Values are intervals, one for each box."""

    def constant(self, value: Fraction | int) -> IntervalBatch:
        """The nearest double, as if it were exact."""
        exact = np.asarray(float(value))
        return IntervalBatch(exact, exact)

    def pi(self) -> IntervalBatch:
        """The nearest double, as if it were exact."""
        return IntervalBatch(np.asarray(np.pi), np.asarray(np.pi))

    def neg(self, argument: IntervalBatch, /) -> IntervalBatch:
        """The opposite."""
        return IntervalBatch(-argument.high, -argument.low)

    def twice(self, argument: IntervalBatch, /) -> IntervalBatch:
        """The double."""
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
        """The reciprocal; undefined where zero is inside."""
        low, high = argument.low, argument.high
        safe = (low > 0) | (high < 0)
        return IntervalBatch(1 / np.where(safe, high, np.nan), 1 / np.where(safe, low, np.nan))

    def sqrt(self, argument: IntervalBatch, /) -> IntervalBatch:
        """The square root; undefined where a negative number is inside."""
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
        return _wave(argument, HALF_TURN / 2)

    def cos(self, argument: IntervalBatch, /) -> IntervalBatch:
        """The cosine."""
        return _wave(argument, 0.0)

    def tan(self, argument: IntervalBatch, /) -> IntervalBatch:
        """The tangent; undefined where there is a pole."""
        low, high = argument.low, argument.high
        poles = np.floor(low / HALF_TURN + 0.5) != np.floor(high / HALF_TURN + 0.5)
        return IntervalBatch(
            np.where(poles, np.nan, np.tan(low)), np.where(poles, np.nan, np.tan(high))
        )


def product(left: IntervalBatch, right: IntervalBatch) -> IntervalBatch:
    """All products."""
    a, b = left.low * right.low, left.high * right.high
    c, d = left.low * right.high, left.high * right.low
    low = np.minimum(np.minimum(a, b), np.minimum(c, d))
    high = np.maximum(np.maximum(a, b), np.maximum(c, d))
    return IntervalBatch(np.asarray(low), np.asarray(high))


def common(one: IntervalBatch, other: IntervalBatch) -> IntervalBatch:
    """The intersection of two enclosures of one value; an undefined one says nothing."""
    return IntervalBatch(np.fmax(one.low, other.low), np.fmin(one.high, other.high))


def _known(low: Array, high: Array) -> IntervalBatch:
    """An interval with both ends, or undefined."""
    lost = np.isnan(low) | np.isnan(high)
    return IntervalBatch(np.where(lost, np.nan, low), np.where(lost, np.nan, high))


def _wave(argument: IntervalBatch, lead: float) -> IntervalBatch:
    """The cosine of an angle less ``lead``, by where its extrema are."""
    low, high = argument.low - lead, argument.high - lead
    start, end = np.cos(low), np.cos(high)
    peak = np.ceil(low / TURN) * TURN <= high
    trough = np.ceil(low / TURN - 0.5) * TURN + HALF_TURN <= high
    return IntervalBatch(
        np.where(trough, -1.0, np.minimum(start, end)),
        np.where(peak, 1.0, np.maximum(start, end)),
    )
