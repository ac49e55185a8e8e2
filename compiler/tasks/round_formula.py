"""Formulas about one round that are sufficient for motions that go on for ever.

For the search: consider a motion on [0, T] that returns at T to where it was at the beginning of
its loop, and repeats [loop, T] for ever. It satisfies a formula F at 0 for ever if it satisfies
``on_one_round(F)`` at 0 on the finite trace. The converse is false: this refutes nothing.

If the translation of a subformula holds at an instant of [0, T] on the finite trace, the subformula
holds there on the endless motion. Negations are pushed inwards on the way. What a nested operator
demands beyond T is demanded of the whole loop, by ``last``.
"""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from grammar_lang import ir

_EVER = ir.Window(Fraction(0), None)


def on_one_round(formula: ir.Formula, loop: Fraction, end: Fraction) -> ir.Formula:
    """The demand on a trace of ``end`` seconds whose last part, from ``loop`` on, repeats."""
    return _Translation(end - loop, end).of(formula, positive=True, at_first=True)


@dataclass(frozen=True, slots=True)
class _Translation:
    """The translation for a round of ``round`` seconds that ends at ``end`` seconds."""

    round: Fraction
    end: Fraction

    def of(self, formula: ir.Formula, *, positive: bool, at_first: bool) -> ir.Formula:
        """Translate a formula, or its negation, at the instant 0 or at any instant."""
        match formula:
            case ir.Atom():
                return formula if positive else ir.Not(formula)
            case ir.Not(operand=part):
                return self.of(part, positive=not positive, at_first=at_first)
            case ir.And(operands=parts) | ir.Or(operands=parts):
                found = tuple(self.of(p, positive=positive, at_first=at_first) for p in parts)
                return ir.And(found) if isinstance(formula, ir.And) is positive else ir.Or(found)
            case ir.Implies(left=left, right=right):
                whole = ir.Or((ir.Not(left), right))
                return self.of(whole, positive=positive, at_first=at_first)
            case (
                ir.Always(operand=part, window=window) | ir.Eventually(operand=part, window=window)
            ):
                inner = self.of(part, positive=positive, at_first=False)
                if isinstance(formula, ir.Always) is positive:
                    return self.always(inner, window, at_first=at_first)
                return self.eventually(inner, window, at_first=at_first)
            case ir.Next(operand=part):
                inner = self.of(part, positive=positive, at_first=False)
                return ir.Next(inner) if at_first else self.for_ever(inner)
            case ir.Until(left=left, right=right):
                return self.until(left, right, positive=positive, at_first=at_first)
            case ir.Last():
                raise ValueError("a motion that goes on for ever has no last part")

    def for_ever(self, inner: ir.Formula) -> ir.Formula:
        """At every instant from now on."""
        return ir.And((ir.Always(inner, _EVER), ir.Last(self.round, inner)))

    def in_loop(self, inner: ir.Formula) -> ir.Formula:
        """At some instant of every round."""
        return ir.Not(ir.Last(self.round, ir.Not(inner)))

    def always(self, inner: ir.Formula, window: ir.Window, *, at_first: bool) -> ir.Formula:
        if at_first and window.upper is None and window.lower == 0:
            return ir.Always(inner, _EVER)
        if at_first and window.upper is not None and window.upper <= self.end:
            return ir.Always(inner, window)
        return self.for_ever(inner)

    def eventually(self, inner: ir.Formula, window: ir.Window, *, at_first: bool) -> ir.Formula:
        here = ir.Eventually(inner, window)
        if at_first and window == _EVER:
            return here
        if window.upper is None or window.upper - window.lower >= self.end:
            return ir.Or((here, self.in_loop(inner)))
        return here

    def until(
        self, left: ir.Formula, right: ir.Formula, *, positive: bool, at_first: bool
    ) -> ir.Formula:
        if not positive:
            # The right one never holds, or not before the left one has failed.
            failing = self.of(right, positive=False, at_first=False)
            both = ir.And((self.of(left, positive=False, at_first=False), failing))
            return ir.Or((ir.Until(failing, both), self.for_ever(failing)))
        inner = self.of(left, positive=True, at_first=False)
        goal = self.of(right, positive=True, at_first=False)
        here = ir.Until(inner, goal)
        if at_first:
            return here
        return ir.Or((here, ir.And((self.for_ever(inner), self.in_loop(goal)))))
