"""Interval arithmetic in floats over many boxes at once: a lane for each box.

Rounding is not directed: what is read here guides a search, and proves nothing.

Source: Moore, Kearfott & Cloud, *Introduction to Interval Analysis* (2009), chapters 2 and 5.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compiler.discretisation.float_reading import Array

HALF_TURN = np.pi
TURN = 2 * np.pi


@dataclass(frozen=True, slots=True, eq=False)
class Lanes:
    """An interval for each of K boxes: ``low`` and ``high`` (K,), or one for all of them ().

    NaN where the value is not defined, or not known to be, somewhere in the box.
    """

    low: Array
    high: Array

    @property
    def magnitude(self) -> Array:
        """The largest absolute value."""
        return np.asarray(np.maximum(np.abs(self.low), np.abs(self.high)))


class LaneArithmetic:
    """Lanes as the numbers of a tape."""

    def integer(self, value: int) -> Lanes:
        """An exact integer."""
        exact = np.asarray(float(value))
        return Lanes(exact, exact)

    def unary(self, name: str, argument: Lanes) -> Lanes:
        """A function of one interval."""
        low, high = argument.low, argument.high
        match name:
            case "neg":
                return Lanes(-high, -low)
            case "twice":
                return Lanes(2 * low, 2 * high)
            case "sq":
                size = _absolute(argument)
                return Lanes(size.low**2, size.high**2)
            case "inv":
                return _inverse(argument)
            case "sqrt":
                rooted = np.sqrt(np.where(low >= 0, low, np.nan))
                return _known(rooted, np.sqrt(np.where(low >= 0, high, np.nan)))
            case "fabs":
                return _absolute(argument)
            case "sign":
                return Lanes(np.where(low > 0, 1.0, -1.0), np.where(high < 0, -1.0, 1.0))
            case "tan":
                return _tangent(argument)
            case _:
                return _wave(argument, 0.0 if name == "cos" else HALF_TURN / 2)

    def binary(self, name: str, left: Lanes, right: Lanes) -> Lanes:
        """An operation on two intervals."""
        if name == "add":
            return Lanes(left.low + right.low, left.high + right.high)
        if name == "sub":
            return Lanes(left.low - right.high, left.high - right.low)
        return product(left, right if name == "mul" else _inverse(right))


def product(left: Lanes, right: Lanes) -> Lanes:
    """All products."""
    a, b = left.low * right.low, left.high * right.high
    c, d = left.low * right.high, left.high * right.low
    low = np.minimum(np.minimum(a, b), np.minimum(c, d))
    high = np.maximum(np.maximum(a, b), np.maximum(c, d))
    return Lanes(np.asarray(low), np.asarray(high))


def common(one: Lanes, other: Lanes) -> Lanes:
    """The intersection of two enclosures of one value; an undefined one says nothing."""
    return Lanes(np.fmax(one.low, other.low), np.fmin(one.high, other.high))


def _known(low: Array, high: Array) -> Lanes:
    """An interval with both ends, or undefined."""
    lost = np.isnan(low) | np.isnan(high)
    return Lanes(np.where(lost, np.nan, low), np.where(lost, np.nan, high))


def _absolute(argument: Lanes) -> Lanes:
    low, high = argument.low, argument.high
    nearest = np.maximum(np.maximum(low, -high), 0.0)
    return Lanes(nearest, argument.magnitude)


def _inverse(argument: Lanes) -> Lanes:
    low, high = argument.low, argument.high
    safe = (low > 0) | (high < 0)
    return Lanes(1 / np.where(safe, high, np.nan), 1 / np.where(safe, low, np.nan))


def _tangent(argument: Lanes) -> Lanes:
    low, high = argument.low, argument.high
    poles = np.floor(low / HALF_TURN + 0.5) != np.floor(high / HALF_TURN + 0.5)
    return Lanes(
        np.where(poles, np.nan, np.tan(low)),
        np.where(poles, np.nan, np.tan(high)),
    )


def _wave(argument: Lanes, lead: float) -> Lanes:
    """The cosine of an angle less ``lead``, by where its extrema are."""
    low, high = argument.low - lead, argument.high - lead
    start, end = np.cos(low), np.cos(high)
    peak = np.ceil(low / TURN) * TURN <= high
    trough = np.ceil(low / TURN - 0.5) * TURN + HALF_TURN <= high
    return Lanes(
        np.where(trough, -1.0, np.minimum(start, end)),
        np.where(peak, 1.0, np.maximum(start, end)),
    )
