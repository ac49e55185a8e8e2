"""Boxes of joint coordinates and parameters: ranges, finite sets, unlimited ranges; their parts."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import TypeAlias

from compiler.expressions.evaluators.balls import closed_ball
from compiler.expressions.evaluators.exact import NotExact, PiLinear, exact_closed
from compiler.expressions.evaluators.intervals import Ends, around, between
from compiler.expressions.rational_enclosure import rational_bounds
from grammar_lang import ir

FARTHEST = Fraction(2**20)
FINEST = Fraction(1, 2**20)


@dataclass(frozen=True, slots=True)
class Element:
    """An element of a finite set: ``low <= value <= high``, and its value where that is exact."""

    low: Fraction
    high: Fraction
    value: PiLinear | None
    expression: ir.Expr


@dataclass(frozen=True, slots=True)
class Side:
    """The values of one variable: a closed range (None: unlimited), or a finite set.

    The range from ``low`` to ``high`` contains all values.  ``first`` and ``last`` are values
    that surely are in the whole domain and bound what is known to be; None where unlimited.
    """

    low: Fraction | None
    high: Fraction | None
    first: PiLinear | None
    last: PiLinear | None
    elements: tuple[Element, ...] = ()
    angle: bool = False

    @property
    def ends(self) -> Ends:
        """An enclosure of all values."""
        if len(self.elements) == 1:
            return around(closed_ball(self.elements[0].expression))
        return between(self.low, self.high)

    @property
    def middle(self) -> Fraction:
        """A rational near the middle."""
        if self.elements:
            item = self.elements[(len(self.elements) - 1) // 2]
            return (item.low + item.high) / 2
        if self.low is None:
            return Fraction(0) if self.high is None or self.high > 0 else min(2 * self.high, -_ONE)
        if self.high is None:
            return Fraction(0) if self.low < 0 else max(2 * self.low, _ONE)
        return (self.low + self.high) / 2

    def samples(self) -> tuple[Fraction, ...]:
        """A few values from the lower end to the upper one."""
        if self.elements:
            return tuple((item.low + item.high) / 2 for item in self.elements)
        low, high = self.low, self.high
        low = self.middle - 1 if low is None else low
        high = self.middle + 1 if high is None else high
        return tuple(low + (high - low) * i / 4 for i in range(5))

    def contains(self, value: PiLinear) -> bool:
        """Whether a number certainly is a value of the whole domain."""
        if self.elements:
            return any(item.value == value for item in self.elements)
        above = self.first is None or self.first.at_most(value)
        return above and (self.last is None or value.at_most(self.last))

    @property
    def simple(self) -> PiLinear:
        """A value that is easy to calculate with: zero, a right angle, or a short fraction."""
        if self.elements:
            return self.central
        if self.angle and self.low is not None and self.high is not None:
            quarters = Fraction(157079632679, 10**11)
            first, last = math.ceil(self.low / quarters), math.floor(self.high / quarters)
            if first <= last:
                nearest = min(max(first, 0), last)
                turned = PiLinear(Fraction(0), Fraction(nearest, 2))
                if self.contains(turned) and self._covers(turned):
                    return turned
        return PiLinear(_simplest(self.low, self.high))

    def _covers(self, value: PiLinear) -> bool:
        above = self.low is None or PiLinear(self.low).at_most(value)
        return above and (self.high is None or value.at_most(PiLinear(self.high)))

    @property
    def central(self) -> PiLinear:
        """A value in the middle, as far as the middle is known exactly."""
        if not self.elements:
            return PiLinear(self.middle)
        known = [item.value for item in self.elements if item.value is not None]
        return known[(len(known) - 1) // 2] if known else PiLinear(self.middle)

    def divisible(self) -> bool:
        """Whether to divide it further: it is neither one value nor very small or far away."""
        if self.elements:
            return len(self.elements) > 1
        if self.low is None or self.high is None:
            return not ((self.low or 0) > FARTHEST or (self.high or 0) < -FARTHEST)
        return self.high - self.low > FINEST

    def halves(self) -> tuple[Side, Side]:
        """Two sides that cover it."""
        if self.elements:
            cut = len(self.elements) // 2
            return self._of(self.elements[:cut]), self._of(self.elements[cut:])
        return replace(self, high=self.middle), replace(self, low=self.middle)

    def _of(self, elements: tuple[Element, ...]) -> Side:
        low = min(item.low for item in elements)
        high = max(item.high for item in elements)
        return replace(self, low=low, high=high, elements=elements)

    def __str__(self) -> str:
        if self.elements:
            return "{" + ", ".join(_shown(item.low) for item in self.elements) + "}"
        low = "-inf" if self.low is None else _shown(self.low)
        return f"[{low}, {'inf' if self.high is None else _shown(self.high)}]"


_ONE = Fraction(1)
Box: TypeAlias = tuple[Side, ...]


def domain_side(domain: ir.Interval | ir.Choices | None, *, angle: bool = False) -> Side:
    """The values of a parameter or coordinate; an unlimited angle takes one turn.

    Raises:
        ValueError: an end has no finite value.
    """
    if isinstance(domain, ir.Choices):
        elements = tuple(_element(value) for value in domain.values)
        low, high = min(e.low for e in elements), max(e.high for e in elements)
        return Side(low, high, None, None, elements, angle)
    if domain is None and not angle:
        return Side(None, None, None, None)
    if domain is None:
        domain = ir.Interval(ir.Unary("neg", ir.Pi()), ir.Pi())
    lower, upper = _element(domain.lower), _element(domain.upper)
    first = lower.value or PiLinear(lower.high)
    last = upper.value or PiLinear(upper.low)
    return Side(lower.low, upper.high, first, last, (), angle)


def range_side(low: Fraction | int, high: Fraction | int, *, angle: bool = False) -> Side:
    """The values of a variable between two rationals."""
    return domain_side(ir.Interval(ir.Num(Fraction(low)), ir.Num(Fraction(high))), angle=angle)


def _element(expression: ir.Expr) -> Element:
    try:
        value = exact_closed(expression)
    except NotExact:
        value = None
    if value is not None and not value.pis:
        return Element(value.rational, value.rational, value, expression)
    low, high = rational_bounds(expression)
    return Element(low, high, value, expression)


def _simplest(low: Fraction | None, high: Fraction | None) -> Fraction:
    """The number of least denominator, then least size, between two numbers."""
    if (low is None or low <= 0) and (high is None or high >= 0):
        return Fraction(0)
    if low is None or (high is not None and high < 0):
        return -_simplest(None if high is None else -high, None if low is None else -low)
    # Source: the Stern-Brocot tree as a continued fraction; low > 0 here.
    terms: list[int] = []
    while True:
        whole = math.ceil(low)
        if high is None or whole <= high:
            terms.append(whole)
            break
        terms.append(whole - 1)
        low, high = 1 / (high - whole + 1), 1 / (low - whole + 1)
    value = Fraction(terms.pop())
    while terms:
        value = terms.pop() + 1 / value
    return value


def _shown(value: Fraction) -> str:
    return str(value) if len(str(value)) <= 12 else f"{float(value):.9g}"
