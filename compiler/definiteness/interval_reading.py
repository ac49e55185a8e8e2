"""The interval reading of a graph over a box: lower and upper end of every value.

Balls are intervals too, but a product of wide balls loses much: (2.75 +- 2.25)^2 reaches below
zero, [0.5, 5]^2 does not.  The ends are python-flint numbers, rounded outwards.

Source: Moore, Kearfott & Cloud, *Introduction to Interval Analysis* (2009), chapters 2 and 5.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from flint import arb

from compiler.arithmetic.balls import ball

INFINITY, ZERO, ONE = arb("inf"), arb(0), arb(1)


@dataclass(frozen=True, slots=True)
class Ends:
    """All reals from ``low`` to ``high``, two exact numbers or infinities."""

    low: arb
    high: arb

    @property
    def undefined(self) -> bool:
        """Whether nothing is known."""
        return bool(self.low.is_nan() or self.high.is_nan())

    @property
    def finite(self) -> bool:
        """Whether both ends are finite."""
        return bool(self.low.is_finite() and self.high.is_finite())

    def ball(self) -> arb:
        """A ball around a finite interval."""
        return self.low.union(self.high)


UNDEFINED = Ends(arb("nan"), arb("nan"))
"""A value that is not defined, or not known to be, somewhere; no comparison with it holds."""


def around(value: arb) -> Ends:
    """The ends of a ball."""
    return outward(value, value)


def between(low: Fraction | None, high: Fraction | None) -> Ends:
    """An interval with rational ends, None for an infinite one."""
    lower = -INFINITY if low is None else ball(low).lower()
    return Ends(lower, INFINITY if high is None else ball(high).upper())


def outward(low: arb, high: arb) -> Ends:
    """The lower end of one ball and the upper end of another; undefined if one is not known."""
    if low.is_nan() or high.is_nan():
        return UNDEFINED
    return Ends(low.lower(), high.upper())


class IntervalArithmetic:
    """Intervals as the numbers of a tape; a value that is not defined everywhere is undefined."""

    def integer(self, value: int) -> Ends:
        """An exact integer."""
        return Ends(arb(value), arb(value))

    def unary(self, name: str, argument: Ends) -> Ends:
        """A function of one interval."""
        match name:
            case "neg":
                return Ends(-argument.high, -argument.low)
            case "twice":
                return outward(argument.low * 2, argument.high * 2)
            case "sq":
                return _square(argument)
            case "inv":
                return _inverse(argument)
            case "sqrt":
                return _root(argument)
            case "fabs":
                return _magnitude(argument)
            case "sign":
                return _sign(argument)
            case "sin" | "cos" | "tan":
                return _trigonometric(name, argument)
            case _:
                raise ValueError(f"no interval reading of {name}")

    def binary(self, name: str, left: Ends, right: Ends) -> Ends:
        """An operation on two intervals."""
        if name == "add":
            return outward(left.low + right.low, left.high + right.high)
        if name == "sub":
            return outward(left.low - right.high, left.high - right.low)
        if name == "mul":
            return _product(left, right)
        return _product(left, _inverse(right))


def _product(left: Ends, right: Ends) -> Ends:
    if left.undefined or right.undefined:
        return UNDEFINED
    if left.low.is_zero() and left.high.is_zero():
        return left  # an unlimited factor takes finite values only
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


def _magnitude(argument: Ends) -> Ends:
    if argument.low >= 0:
        return argument
    if argument.high <= 0:
        return Ends(-argument.high, -argument.low)
    if argument.undefined:
        return UNDEFINED
    return Ends(ZERO, argument.high if argument.high > -argument.low else -argument.low)


def _sign(argument: Ends) -> Ends:
    """The slopes of the absolute value: both, and all between, where zero is in the interval."""
    if argument.undefined:
        return UNDEFINED
    return Ends(ONE if argument.low > 0 else -ONE, -ONE if argument.high < 0 else ONE)


def _square(argument: Ends) -> Ends:
    size = _magnitude(argument)
    return outward(size.low * size.low, size.high * size.high)


def _inverse(argument: Ends) -> Ends:
    if argument.low > 0 or argument.high < 0:
        return outward(1 / argument.high, 1 / argument.low)
    return UNDEFINED


def _root(argument: Ends) -> Ends:
    if argument.low >= 0:
        return outward(argument.low.sqrt(), argument.high.sqrt())
    return UNDEFINED


def _trigonometric(name: str, argument: Ends) -> Ends:
    """``sin cos tan``, by where the extrema or poles are, in half turns."""
    if not argument.finite:
        return UNDEFINED if name == "tan" or argument.undefined else Ends(-ONE, ONE)
    if name == "tan":
        if _integers(argument, Fraction(1, 2)):
            return UNDEFINED
        return outward(argument.low.tan(), argument.high.tan())
    extrema = _integers(argument, Fraction(0) if name == "cos" else Fraction(1, 2))
    if len(extrema) > 1:
        return Ends(-ONE, ONE)
    function = arb.cos if name == "cos" else arb.sin
    start, end = function(argument.low), function(argument.high)
    low = start.lower() if start.lower() < end.lower() else end.lower()
    high = start.upper() if start.upper() > end.upper() else end.upper()
    if extrema:
        return Ends(low, ONE) if extrema[0] % 2 == 0 else Ends(-ONE, high)
    return Ends(low, high)


def _integers(argument: Ends, shift: Fraction) -> range:
    """The integers that x / pi - shift may take in an interval, cut after a few."""
    pi, offset = arb.pi(), ball(shift)
    first = (argument.low / pi - offset).lower().ceil().unique_fmpz()
    last = (argument.high / pi - offset).upper().floor().unique_fmpz()
    if first is None or last is None:
        return range(3)
    return range(int(first), min(int(last), int(first) + 2) + 1)
