"""When a formula holds, from when its atoms do: exact, in dense time.

Source: Maler & Nickovic, *Monitoring temporal properties of continuous signals* (2004), section 4,
with windows cut off at the end of the trace; three values as in Kleene's strong logic.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from functools import reduce
from operator import and_, or_
from typing import TypeAlias, assert_never

from compiler.specifications.subformulas import operands
from compiler.specifications.time_set import TimeSet
from grammar_lang import ir

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
