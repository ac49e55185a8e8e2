"""How far a motion is from breaking a formula: a lower bound, from bounds slice by slice.

The space robustness of signal temporal logic replaces an atom by the signed distance to the
boundary of its region, negation by the change of sign, conjunction and ``always`` by infima,
disjunction and ``eventually`` by suprema.  If the two-valued monitor still accepts when an atom
counts as true only where it is at least r deep inside, and as false only where it is at least r
outside, then the robustness is at least r (by induction over the formula).  The largest such r
among the bounds is sought by bisection.

Source: Donze & Maler, *Robust satisfaction of temporal logic over real-valued signals* (2010),
definition 3.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import inf

from compiler.tasks.monitor import AtomKey, TimeSet, Verdicts, monitor
from grammar_lang import ir


@dataclass(frozen=True, slots=True)
class Piece:
    """What is known of an atom throughout [``first``, ``last``], in seconds and metres.

    ``inside`` is a lower bound of the distance to the complement of the region, zero unless the
    point is certainly inside; ``outside`` one of the distance to the region, likewise.
    """

    first: Fraction
    last: Fraction
    inside: float
    outside: float


Trace = Mapping[AtomKey, Sequence[Piece]]
"""Pieces with ascending beginnings per atom; where there is none, nothing is known."""


@dataclass(frozen=True, slots=True)
class Monitored:
    """A formula over a trace of length ``end``; ``step`` is how much later ``next`` is."""

    formula: ir.Formula
    end: Fraction
    step: Fraction

    def holds(
        self, trace: Trace, level: float, known: Mapping[ir.Formula, Verdicts] | None = None
    ) -> bool:
        """Whether the formula certainly holds at 0 with atoms that count from ``level`` on.

        At level 0 an atom counts where it is certain at all, and ``known`` counts too.
        """
        signals = {atom: self._verdicts(pieces, level) for atom, pieces in trace.items()}
        return 0 in monitor(self.formula, signals, self.end, self.step, known).must

    def _verdicts(self, pieces: Sequence[Piece], level: float) -> Verdicts:
        def counts(bound: float) -> bool:
            return bound > 0 and bound >= level

        must = self._where(pieces, lambda piece: counts(piece.inside))
        return Verdicts(must, self._where(pieces, lambda piece: counts(piece.outside)).complement)

    def _where(self, pieces: Sequence[Piece], chosen: Callable[[Piece], bool]) -> TimeSet:
        """The union of some pieces; runs of neighbours are joined first, which is much faster."""
        runs: list[tuple[Fraction, Fraction]] = []
        for piece in pieces:
            if not chosen(piece):
                continue
            # Neighbours mostly share one number, which compares faster.
            if runs and (runs[-1][1] is piece.first or runs[-1][1] == piece.first):
                runs[-1] = runs[-1][0], piece.last
            else:
                runs.append((piece.first, piece.last))
        return TimeSet.closed(self.end, runs)

    def robustness(self, trace: Trace) -> float | None:
        """The largest level at which the formula certainly holds at 0; None if it never does.

        Infinite where no atom matters.
        """
        levels = sorted(
            {bound for pieces in trace.values() for p in pieces for bound in _bounds(p)}
        )
        levels.append(inf)
        if not self.holds(trace, levels[0]):
            return None
        low, high = 0, len(levels) - 1
        while low < high:
            middle = (low + high + 1) // 2
            low, high = (middle, high) if self.holds(trace, levels[middle]) else (low, middle - 1)
        return levels[low]


def _bounds(piece: Piece) -> list[float]:
    return [bound for bound in (piece.inside, piece.outside) if bound > 0]
