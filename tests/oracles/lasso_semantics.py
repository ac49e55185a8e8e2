"""The meaning of formulas on signals that go on for ever, read off the definitions.

A signal is as in :mod:`tests.oracles.formula_semantics`, without its last instant: parts
0 .. 2 M - 1 of [0, M h), of which those from ``2 L`` on come again and again.  The parts of the
infinite signal are numbered on; nothing is known of time sets here.
"""

from __future__ import annotations

from fractions import Fraction

from grammar_lang import ir
from tests.oracles.formula_semantics import Meaning, Signal, instant, part_of


class Endless(Meaning):
    def __init__(self, signal: Signal, loop: int, h: Fraction, step: Fraction) -> None:
        assert len(signal) % 2 == loop % 2 == 0
        super().__init__(signal, h, step)
        self.loop = loop
        self.known: dict[tuple[ir.Formula, int], bool] = {}

    def folded(self, part: int) -> int:
        """The part of the lasso that the infinite signal is in."""
        round_ = len(self.signal) - self.loop
        return part if part < self.loop else self.loop + (part - self.loop) % round_

    def enough(self, part: int) -> int:
        """From a part on all that ever comes has come before this one, twice."""
        return max(part, self.loop) + 2 * (len(self.signal) - self.loop)

    def holds(self, formula: ir.Formula, part: int = 0) -> bool:
        at = formula, self.folded(part)
        if at not in self.known:
            self.known[at] = super().holds(*at)
        return self.known[at]

    def in_time(self, formula: ir.Formula, part: int) -> bool:
        match formula:
            case ir.Always(operand=f, window=w):
                return all(self.holds(f, p) for p in self.parts(part, w))
            case ir.Eventually(operand=f, window=w):
                return any(self.holds(f, p) for p in self.parts(part, w))
            case ir.Next(operand=f):
                return self.holds(f, part_of(instant(part) + self.step / self.h))
            case ir.Until(left=a, right=b):
                return self.until(a, b, part)
            case _:
                raise TypeError(formula)

    def parts(self, part: int, window: ir.Window) -> range:
        first = part_of(instant(part) + window.lower / self.h)
        if window.upper is None:
            return range(first, self.enough(first))
        return range(first, part_of(instant(part) + window.upper / self.h) + 1)

    def until(self, left: ir.Formula, right: ir.Formula, part: int) -> bool:
        for q in range(part, self.enough(part)):
            # Of an interval that begins after now some instants precede the one of ``right``.
            last = q + 1 if q % 2 and q > part else q
            if self.holds(right, q):
                return all(self.holds(left, p) for p in range(part, last))
            if not self.holds(left, q):
                return False
        return False
