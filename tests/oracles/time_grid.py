"""Sets of instants as the parts of a grid: part 2 k is the instant k, part 2 k + 1 what follows."""

from __future__ import annotations

from collections.abc import Iterable
from fractions import Fraction

from compiler.tasks.time_set import TimeSet
from tests.oracles.formula_semantics import instant


def time_set(parts: Iterable[bool], unit: Fraction = Fraction(1)) -> TimeSet:
    """The union of the parts marked, whose instants are multiples of ``unit``."""
    marks = list(parts)
    end = (len(marks) - 1) // 2 * unit
    found = TimeSet(end)
    for part, marked in enumerate(marks):
        if marked:
            first, last = part // 2 * unit, (part + 1) // 2 * unit
            sides = (1, 0) if part % 2 else (0, 1)
            found |= TimeSet(end, ((first, sides[0]), (last, sides[1])))
    return found


def marks(times: TimeSet, unit: Fraction = Fraction(1)) -> list[bool]:
    """Which parts are in a set of whole parts, told from an instant of each."""
    count = 2 * int(times.end / unit) + 1
    return [instant(part) * unit in times for part in range(count)]
