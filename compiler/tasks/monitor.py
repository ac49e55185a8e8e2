"""When a formula holds, from when its atoms do: exact, in dense time."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from heapq import merge
from math import inf
from operator import and_, or_
from typing import TypeAlias, assert_never

from compiler.tasks.formula_parts import operands
from grammar_lang import ir

# --------------------------------------------------------------------------------------------------
# Sets of instants: finite unions of intervals of [0, T] with exact ends, each open or closed.
#
# A cut (t, 0) lies just before the instant t, a cut (t, 1) just after it.  A set is the strictly
# ascending sequence of the cuts at which one enters and leaves it: [a, b) is (a, 0), (b, 0), the
# instant a alone (a, 0), (a, 1).  So every set has one form, and open and closed ends need no
# cases.


Cut: TypeAlias = tuple[Fraction, int]
BEFORE, AFTER = 0, 1
_START: Cut = (Fraction(0), BEFORE)


@dataclass(frozen=True, slots=True)
class TimeSet:
    """A subset of [0, ``end``]; ``cuts`` as in the head of this file, none outside [0, end]."""

    end: Fraction
    cuts: tuple[Cut, ...] = ()

    @staticmethod
    def all(end: Fraction) -> TimeSet:
        """[0, end]."""
        return TimeSet(end, (_START, (end, AFTER)))

    @staticmethod
    def closed(end: Fraction, intervals: Iterable[tuple[Fraction, Fraction]]) -> TimeSet:
        """The union of closed intervals with ascending beginnings, cut off at 0 and ``end``."""
        return _union_of(end, (((a, BEFORE), (b, AFTER)) for a, b in intervals))

    def __contains__(self, time: Fraction | int) -> bool:
        return bisect_left(self.cuts, (Fraction(time), AFTER)) % 2 == 1

    def __bool__(self) -> bool:
        return bool(self.cuts)

    @property
    def intervals(self) -> tuple[tuple[Cut, Cut], ...]:
        """The maximal intervals, ascending, each as the cuts at its ends."""
        return tuple(zip(self.cuts[::2], self.cuts[1::2], strict=True))

    @property
    def complement(self) -> TimeSet:
        """The other instants of [0, end]."""
        last: Cut = (self.end, AFTER)
        head = self.cuts[1:] if self.cuts[:1] == (_START,) else (_START, *self.cuts)
        return TimeSet(self.end, head[:-1] if head[-1:] == (last,) else (*head, last))

    def __or__(self, other: TimeSet) -> TimeSet:
        return _combined(self, other, lambda depth: depth >= 1)

    def __and__(self, other: TimeSet) -> TimeSet:
        return _combined(self, other, lambda depth: depth >= 2)

    def __le__(self, other: TimeSet) -> bool:
        return (self & other) == self

    def before(self, lower: Fraction, upper: Fraction | None) -> TimeSet:
        """The instants t such that the set has one in [t + lower, t + upper] (None: to the end)."""
        if upper is None:
            latest = (self.cuts[-1][0] - lower, self.cuts[-1][1]) if self.cuts else _START
            return _union_of(self.end, [(_START, latest)])
        return _union_of(
            self.end,
            (((a - upper, p), (b - lower, q)) for (a, p), (b, q) in self.intervals),
        )

    def until(self, right: TimeSet) -> TimeSet:
        """The instants from which on this set holds to just before some instant of ``right``.

        The instants of ``right`` are among them.  From any other t, inside a maximal interval with
        supremum h, an instant t' of ``right`` is due with t < t' <= h: whether h is in the interval
        does not matter, since only the instants before t' count.
        """
        found: list[tuple[Cut, Cut]] = []
        goals, number, latest = right.intervals, 0, Fraction(-1)
        for low, (high, _) in self.intervals:
            while number < len(goals) and goals[number][0] < (high, AFTER):
                latest = goals[number][1][0]
                number += 1
            # The last of them may go on beyond h, and into the next interval.
            found.append((low, (min(latest, high), BEFORE)))
        return _union_of(self.end, found) | right


def _combined(left: TimeSet, right: TimeSet, chosen: Callable[[int], bool]) -> TimeSet:
    """The instants that are in a number of the two sets for which ``chosen`` is true."""
    if left.end != right.end:
        raise ValueError("time sets of different horizons")
    turns = merge(
        ((cut, -1 if i % 2 else 1) for i, cut in enumerate(left.cuts)),
        ((cut, -1 if i % 2 else 1) for i, cut in enumerate(right.cuts)),
    )
    cuts: list[Cut] = []
    depth = 0
    for cut, change in turns:
        before = chosen(depth)
        depth += change
        if chosen(depth) != before:
            if cuts and cuts[-1] == cut:
                cuts.pop()
            else:
                cuts.append(cut)
    return TimeSet(left.end, tuple(cuts))


def _union_of(end: Fraction, intervals: Iterable[tuple[Cut, Cut]]) -> TimeSet:
    """The union of intervals with ascending beginnings, cut off at 0 and ``end``."""
    cuts: list[Cut] = []
    last: Cut = (end, AFTER)
    for low, high in intervals:
        first, final = max(low, _START), min(high, last)
        if first >= final:
            continue
        if cuts and first <= cuts[-1]:
            cuts[-1] = max(cuts[-1], final)
        else:
            cuts += (first, final)
    return TimeSet(end, tuple(cuts))


# --- When a formula holds, from when its atoms do: exact, in dense time ---------------------------
#
# Source: Maler & Nickovic, *Monitoring temporal properties of continuous signals* (2004), section
# 4, with windows cut off at the end of the trace; three values as in Kleene's strong logic.


AtomKey: TypeAlias = tuple[str, int]
"""A region and an effector's number, from 1."""


@dataclass(frozen=True, slots=True)
class Verdicts:
    """The instants at which a formula certainly holds, and those at which it may hold."""

    must: TimeSet
    may: TimeSet

    @property
    def negated(self) -> Verdicts:
        """The same of its negation."""
        return Verdicts(self.may.complement, self.must.complement)


def key(atom: ir.Atom) -> AtomKey:
    """What an atom speaks of."""
    return atom.region, atom.effector


def satisfied(
    formula: ir.Formula, signals: Mapping[AtomKey, TimeSet], end: Fraction, step: Fraction
) -> TimeSet:
    """The instants of [0, ``end``] at which a formula holds.

    Args:
        formula: what to monitor.
        signals: when each of its atoms holds.
        end: the length T of the trace, s.
        step: how much later ``next`` is, s.
    """
    exact = {atom: Verdicts(signal, signal) for atom, signal in signals.items()}
    return monitor(formula, exact, end, step).must


def monitor(
    formula: ir.Formula,
    signals: Mapping[AtomKey, Verdicts],
    end: Fraction,
    step: Fraction,
    known: Mapping[ir.Formula, Verdicts] | None = None,
) -> Verdicts:
    """The instants at which a formula certainly holds, and those at which it may.

    Whatever signals lie between what is known of the atoms, the instants at which the formula holds
    lie between the two answers: every operator but negation is monotone.

    Args:
        formula: what to monitor.
        signals: what is known of its atoms.
        end: the length T of the trace, s.
        step: how much later ``next`` is, s.
        known: what is known of parts, atoms excepted, beyond what follows from the atoms.
    """
    if isinstance(formula, ir.Atom):
        return signals[key(formula)]
    parts = [monitor(part, signals, end, step, known) for part in operands(formula)]
    found = _value(formula, parts, _Time(end, step))
    if known is None or formula not in known:
        return found
    return Verdicts(found.must | known[formula].must, found.may & known[formula].may)


def _value(formula: ir.Formula, parts: list[Verdicts], time: _Time) -> Verdicts:
    """What follows for a formula from what is known of its operands."""
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

    def value(self, formula: ir.Formula, parts: Sequence[TimeSet]) -> TimeSet:
        """When a formula holds, given when its parts do (of ``implies``, the negated left one)."""
        match formula:
            case ir.And():
                return reduce(and_, parts)
            case ir.Or() | ir.Implies():
                return reduce(or_, parts)
            case ir.Until():
                return parts[0].until(parts[1])
            case ir.Eventually(window=window):
                return parts[0].before(window.lower, window.upper)
            case ir.Always(window=window):
                return parts[0].complement.before(window.lower, window.upper).complement
            case ir.Next():
                return parts[0].before(self.step, self.step)
            case ir.Last(duration=duration):
                span = TimeSet.closed(self.end, [(self.end - duration, self.end)])
                throughout = span <= parts[0]
                return TimeSet.all(self.end) if throughout else TimeSet(self.end)
            case ir.Atom() | ir.Not():
                raise ValueError("atoms and negations have no value of their own")
            case _:
                assert_never(formula)


# --- The parts of a formula that speak of one instant only, and their value there -----------------


_CONNECTIVES = ir.Not | ir.And | ir.Or | ir.Implies


def boolean_parts(formula: ir.Formula) -> tuple[ir.Formula, ...]:
    """The largest parts without operators of time, atoms excepted, from left to right."""
    found: dict[ir.Formula, None] = {}
    if _timeless(formula, found):
        found[formula] = None
    return tuple(part for part in found if not isinstance(part, ir.Atom))


def _timeless(formula: ir.Formula, found: dict[ir.Formula, None]) -> bool:
    """Whether a formula has no operator of time; if it has, its timeless operands are found."""
    parts = operands(formula)
    timeless = [_timeless(part, found) for part in parts]
    if isinstance(formula, ir.Atom) or (isinstance(formula, _CONNECTIVES) and all(timeless)):
        return True
    found.update((part, None) for part, alone in zip(parts, timeless, strict=True) if alone)
    return False


def boolean_value(formula: ir.Formula, values: Mapping[AtomKey, bool]) -> bool:
    """The value of a formula without operators of time, given those of its atoms.

    Raises:
        ValueError: it has such an operator.
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


# --- How far a motion is from breaking a formula: a lower bound, from bounds slice by slice -------
#
# The space robustness of signal temporal logic replaces an atom by the signed distance to the
# boundary of its region, negation by the change of sign, conjunction and ``always`` by infima,
# disjunction and ``eventually`` by suprema.  If the two-valued monitor still accepts when an atom
# counts as true only where it is at least r deep inside, and as false only where it is at least r
# outside, then the robustness is at least r (by induction over the formula).  The largest such r
# among the bounds is sought by bisection.
#
# Source: Donze & Maler, *Robust satisfaction of temporal logic over real-valued signals* (2010),
# definition 3.


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
