"""Where the value of a parameter may be: unions of intervals with rational ends, some of them open.

For an irrational end or choice the interval is slightly wider, so ranges reported as disjoint are
disjoint.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from fractions import Fraction
from typing import TypeAlias

from compiler.expressions.exact_numbers import rational_bounds
from grammar_lang import ir


@dataclass(frozen=True, slots=True)
class Range:
    """The values from ``low`` to ``high`` in SI units, without open ends."""

    low: Fraction
    high: Fraction
    low_open: bool = False
    high_open: bool = False

    def meets(self, other: Range) -> bool:
        """Whether both have a value in common."""
        low, low_open = max((self.low, self.low_open), (other.low, other.low_open))
        high, high_closed = min((self.high, not self.high_open), (other.high, not other.high_open))
        return low < high or (low == high and high_closed and not low_open)


Ranges: TypeAlias = tuple[Range, ...]


def ranges_of(domain: ir.Interval | ir.Choices) -> Ranges:
    """The values of a domain."""
    if isinstance(domain, ir.Choices):
        return tuple(Range(*rational_bounds(value)) for value in domain.values)
    return (Range(rational_bounds(domain.lower)[0], rational_bounds(domain.upper)[1]),)


def single(value: Fraction) -> Ranges:
    """The range of one value."""
    return (Range(value, value),)


def meet(one: Iterable[Range], other: Ranges) -> bool:
    """Whether two unions have a value in common."""
    return any(mine.meets(theirs) for mine in one for theirs in other)
