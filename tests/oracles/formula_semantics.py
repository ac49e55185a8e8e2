"""The meaning of formulas on signals that are constant on a grid, read off the definitions.

A signal gives for each of the 2 M + 1 parts of [0, M h] (part 2 k is the instant k h, part 2 k + 1
the open interval after it) what each effector is in.  All times of a formula must be multiples of
h: then every subformula is constant on the parts too, and one instant of each tells its value.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from fractions import Fraction
from itertools import product

from grammar_lang import ir

Signal = Sequence[Mapping[int, frozenset[str]]]


def instant(part: int) -> Fraction:
    """An instant of a part, in units of h."""
    return Fraction(part, 2)


def part_of(time: Fraction) -> int:
    """The part of an instant, in units of h."""
    return int(2 * time) if time.denominator == 1 else 2 * int(time) + 1


def parts_between(first: Fraction, last: Fraction) -> range:
    """The parts that meet the closed interval between two instants."""
    return range(part_of(first), part_of(last) + 1) if first <= last else range(0)


class Meaning:
    def __init__(self, signal: Signal, h: Fraction, step: Fraction) -> None:
        self.signal = signal
        self.h = h
        self.step = step
        self.end = instant(len(signal) - 1)

    def holds(self, formula: ir.Formula, part: int = 0) -> bool:
        match formula:
            case ir.Atom(region=region, effector=effector):
                return region in self.signal[part][effector]
            case ir.Not(operand=f):
                return not self.holds(f, part)
            case ir.And(operands=fs):
                return all(self.holds(f, part) for f in fs)
            case ir.Or(operands=fs):
                return any(self.holds(f, part) for f in fs)
            case ir.Implies(left=a, right=b):
                return not self.holds(a, part) or self.holds(b, part)
            case _:
                return self.in_time(formula, part)

    def in_time(self, formula: ir.Formula, part: int) -> bool:
        now = instant(part)
        match formula:
            case ir.Always(operand=f, window=w):
                return all(self.holds(f, p) for p in self.window(now, w))
            case ir.Eventually(operand=f, window=w):
                return any(self.holds(f, p) for p in self.window(now, w))
            case ir.Next(operand=f):
                later = now + self.step / self.h
                return later <= self.end and self.holds(f, part_of(later))
            case ir.Last(operand=f, duration=d):
                first = max(Fraction(0), self.end - d / self.h)
                return all(self.holds(f, p) for p in parts_between(first, self.end))
            case ir.Until(left=a, right=b):
                return self.until(a, b, part)
            case _:
                raise TypeError(formula)

    def window(self, now: Fraction, window: ir.Window) -> range:
        first = now + window.lower / self.h
        last = self.end if window.upper is None else now + window.upper / self.h
        return parts_between(first, min(last, self.end))

    def until(self, left: ir.Formula, right: ir.Formula, part: int) -> bool:
        """``right`` at some instant t' of a part q, ``left`` from now to just before it.

        Of an interval that begins after now some instants precede t', so ``left`` holds there too;
        in the interval of now itself t' may be now.
        """
        for q in range(part, len(self.signal)):
            before = range(part, q)
            if q % 2 and q > part:
                before = range(part, q + 1)
            if self.holds(right, q) and all(self.holds(left, p) for p in before):
                return True
        return False


def signals(
    kinds: Sequence[frozenset[str]], parts: int, effectors: Sequence[int]
) -> Iterator[Signal]:
    """All signals that a continuous motion among closed regions can have.

    Args:
        kinds: the sets of regions that a point can be in.
        parts: 2 M + 1.
        effectors: the numbers of the effectors.
    """
    single: list[list[frozenset[str]]] = [[kind] for kind in kinds]
    for part in range(1, parts):
        grown = []
        for signal in single:
            for kind in kinds:
                inner, end = (kind, signal[-1]) if part % 2 else (signal[-1], kind)
                if inner <= end:
                    grown.append([*signal, kind])
        single = grown
    for choice in product(single, repeat=len(effectors)):
        yield [dict(zip(effectors, point, strict=True)) for point in zip(*choice, strict=True)]
