"""The instants at which a formula holds, given when its atoms hold: exact, in dense time."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from math import inf
from operator import and_, or_
from typing import NamedTuple, assert_never

from compiler.tasks.lasso import Lasso
from compiler.tasks.time_set import TimeSet
from grammar_lang import ir
from grammar_lang.ir.formula_parts import operands

# --- The instants at which a formula holds, given when its atoms hold -----------------------------
#
# Source: Maler & Nickovic, *Monitoring temporal properties of continuous signals* (2004), section
# 4, with windows cut off at the end of the trace; three values as in Kleene's strong logic.


class AtomKey(NamedTuple):
    """A region, the number of an effector from 1, and the required orientations of its frame."""

    region: str
    effector: int
    poses: tuple[ir.Pose, ...] = ()


@dataclass(frozen=True, slots=True)
class Verdicts:
    """The instants at which a formula certainly holds, and those at which it may hold."""

    must: TimeSet
    may: TimeSet

    @property
    def negated(self) -> Verdicts:
        """The verdicts on the negated formula."""
        return Verdicts(self.may.complement, self.must.complement)


def key(atom: ir.Atom) -> AtomKey:
    """The key of an atom."""
    return AtomKey(atom.region, atom.effector, atom.poses)


def satisfied(
    formula: ir.Formula, signals: Mapping[AtomKey, TimeSet], end: Fraction, step: Fraction
) -> TimeSet:
    """The instants of [0, ``end``] at which a formula holds.

    Args:
        formula: the formula to monitor.
        signals: when each of its atoms holds.
        end: the length T of the trace, s.
        step: the delay of ``next``, s.
    """
    exact = {atom: Verdicts(signal, signal) for atom, signal in signals.items()}
    return monitor(formula, exact, end, step).must


def monitor(
    formula: ir.Formula,
    signals: Mapping[AtomKey, Verdicts],
    end: Fraction,
    step: Fraction,
    known: Mapping[ir.Formula, Verdicts] | None = None,
    loop: Fraction | None = None,
) -> Verdicts:
    """The instants at which a formula certainly holds, and those at which it may hold.

    For all signals between the bounds on the atoms, the instants at which the formula holds lie
    between the two answers: every operator except negation is monotone.

    Args:
        formula: the formula to monitor.
        signals: bounds on the signals of its atoms.
        end: the length T of the trace, s.
        step: the delay of ``next``, s.
        known: bounds on parts other than atoms, beyond what follows from the atoms.
        loop: the start of [loop, T), which repeats for ever; the answer and all inputs are about
            [0, T) then. None if the trace ends.
    """
    if isinstance(formula, ir.Atom):
        return signals[key(formula)]
    parts = [monitor(part, signals, end, step, known, loop) for part in operands(formula)]
    lasso = None if loop is None else Lasso(loop, end)
    found = _value(formula, parts, _Time(end, step, lasso))
    if known is None or formula not in known:
        return found
    return Verdicts(found.must | known[formula].must, found.may & known[formula].may)


def _value(formula: ir.Formula, parts: list[Verdicts], time: _Time) -> Verdicts:
    """The verdicts that follow for a formula from those on its operands."""
    if isinstance(formula, ir.Not):
        return parts[0].negated
    if isinstance(formula, ir.Implies):
        parts = [parts[0].negated, parts[1]]
    must = time.value(formula, [part.must for part in parts])
    if all(part.must == part.may for part in parts):
        return Verdicts(must, must)
    return Verdicts(must, time.value(formula, [part.may for part in parts]))


@dataclass(frozen=True, slots=True)
class _Time:
    end: Fraction
    step: Fraction
    lasso: Lasso | None

    def before(self, times: TimeSet, lower: Fraction, upper: Fraction | None) -> TimeSet:
        """The instants with one of ``times`` from ``lower`` to ``upper`` seconds later."""
        if self.lasso is None:
            return times.before(lower, upper)
        return self.lasso.before(times, lower, upper)

    def value(self, formula: ir.Formula, parts: Sequence[TimeSet]) -> TimeSet:
        """When a formula holds, given when its parts do (for ``implies``, left part negated)."""
        match formula:
            case ir.And():
                return reduce(and_, parts)
            case ir.Or() | ir.Implies():
                return reduce(or_, parts)
            case ir.Until():
                return parts[0].until(parts[1]) if self.lasso is None else self.lasso.until(*parts)
            case ir.Eventually(window=window):
                return self.before(parts[0], window.lower, window.upper)
            case ir.Always(window=window):
                return self.before(parts[0].complement, window.lower, window.upper).complement
            case ir.Next():
                return self.before(parts[0], self.step, self.step)
            case ir.Last(duration=duration):
                if self.lasso is not None:
                    raise ValueError("a motion that goes on for ever has no last part")
                span = TimeSet.closed(self.end, [(self.end - duration, self.end)])
                throughout = span <= parts[0]
                return TimeSet.all(self.end) if throughout else TimeSet(self.end)
            case ir.Atom() | ir.Not():
                raise ValueError("atoms and negations have no value of their own")
            case _:
                assert_never(formula)


# --- The parts of a formula that concern one instant only, and their value there ------------------


_CONNECTIVES = ir.Not | ir.And | ir.Or | ir.Implies


def boolean_parts(formula: ir.Formula) -> tuple[ir.Formula, ...]:
    """The largest parts without temporal operators, except atoms, from left to right."""
    found: dict[ir.Formula, None] = {}
    if _timeless(formula, found):
        found[formula] = None
    return tuple(part for part in found if not isinstance(part, ir.Atom))


def _timeless(formula: ir.Formula, found: dict[ir.Formula, None]) -> bool:
    """Whether a formula has no temporal operator; if it has, its timeless operands are recorded."""
    parts = operands(formula)
    timeless = [_timeless(part, found) for part in parts]
    if isinstance(formula, ir.Atom) or (isinstance(formula, _CONNECTIVES) and all(timeless)):
        return True
    found.update((part, None) for part, alone in zip(parts, timeless, strict=True) if alone)
    return False


def boolean_value(formula: ir.Formula, values: Mapping[AtomKey, bool]) -> bool:
    """The value of a formula without temporal operators, given the values of its atoms.

    Raises:
        ValueError: it has a temporal operator.
    """
    if isinstance(formula, ir.Atom):
        return values[key(formula)]
    parts = (boolean_value(part, values) for part in operands(formula))
    match formula:
        case ir.Not():
            return not next(parts)
        case ir.And():
            return all(parts)
        case ir.Or():
            return any(parts)
        case ir.Implies():
            return not next(parts) or next(parts)
        case _:
            raise ValueError("the formula speaks of several instants")


# --- How far a motion is from violating a formula: a lower bound, from bounds piece by piece ------
#
# The space robustness of signal temporal logic replaces an atom by the signed distance to the
# boundary of its region, negation by the change of sign, conjunction and ``always`` by infima,
# disjunction and ``eventually`` by suprema. Suppose an atom counts as true only if the point is at
# least r deep inside, and as false only if it is at least r outside. If the two-valued monitor
# still accepts, the robustness is at least r (by induction over the formula). Bisection finds the
# largest such r among the bounds.
#
# Source: Donze & Maler, *Robust satisfaction of temporal logic over real-valued signals* (2010),
# definition 3.


@dataclass(frozen=True, slots=True)
class Piece:
    """Bounds for an atom throughout [``first``, ``last``], in seconds and metres.

    ``inside`` is a lower bound of the distance to the complement of the region, zero unless the
    point is certainly inside; ``outside`` is a lower bound of the distance to the region, zero
    unless the point is certainly outside.
    """

    first: Fraction
    last: Fraction
    inside: float
    outside: float


Trace = Mapping[AtomKey, Sequence[Piece]]
"""Pieces with ascending beginnings for each atom; nothing is known where there are none."""


@dataclass(frozen=True, slots=True)
class Monitored:
    """A formula over a trace of length ``end``; ``step`` is the delay of ``next``.

    With a ``loop`` the trace goes on for ever: [loop, end) repeats.
    """

    formula: ir.Formula
    end: Fraction
    step: Fraction
    loop: Fraction | None = None

    def holds(
        self, trace: Trace, level: float, known: Mapping[ir.Formula, Verdicts] | None = None
    ) -> bool:
        """Whether the formula certainly holds at 0 if atoms count only with a bound >= ``level``.

        At level 0 an atom counts wherever it is certain at all, and ``known`` counts too.
        """
        signals = {atom: self._verdicts(pieces, level) for atom, pieces in trace.items()}
        return 0 in monitor(self.formula, signals, self.end, self.step, known, self.loop).must

    def _verdicts(self, pieces: Sequence[Piece], level: float) -> Verdicts:
        def counts(bound: float) -> bool:
            return bound > 0 and bound >= level

        must = self._where(pieces, lambda piece: counts(piece.inside))
        return Verdicts(must, self._where(pieces, lambda piece: counts(piece.outside)).complement)

    def _where(self, pieces: Sequence[Piece], chosen: Callable[[Piece], bool]) -> TimeSet:
        """The union of the chosen pieces; neighbours are joined first, which is much faster."""
        runs: list[tuple[Fraction, Fraction]] = []
        for piece in pieces:
            if not chosen(piece):
                continue
            # Neighbours mostly share one number, which compares faster.
            near = bool(runs) and (runs[-1][1] is piece.first or runs[-1][1] == piece.first)
            if near and piece.first != self.loop:
                runs[-1] = runs[-1][0], piece.last
            else:
                runs.append((piece.first, piece.last))
        return self.union(runs)

    def union(self, spans: Sequence[tuple[Fraction, Fraction]]) -> TimeSet:
        """The union of closed spans of the prefix and of the loop, with ascending beginnings.

        Bounds at the end of the prefix hold for the first round only: at the beginning of the loop
        only spans that begin there count.
        """
        found, loop = TimeSet.closed(self.end, spans), self.loop
        if loop is None or any(first == loop for first, _ in spans):
            return found
        return found & TimeSet.closed(self.end, [(loop, loop)]).complement

    def robustness(self, trace: Trace) -> float | None:
        """The largest level at which the formula certainly holds at 0; None if it never does.

        It is infinite if no atom matters.
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
