"""Formulas of ``satisfy``, in linear temporal logic on the finite trace [0, T]: names and times.

Sources: De Giacomo & Vardi, *Linear temporal logic and linear dynamic logic on finite traces*
(2013) for the finite trace; Alur, Feder & Henzinger, *The benefits of relaxing punctuality* (1996)
for the windows.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.elaboration.closed import Constants
from grammar_lang.syntax import formulas as f
from grammar_lang.units import TIME

_ALWAYS = ir.Window(Fraction(0), None)


@dataclass(frozen=True, slots=True)
class _Reader:
    region: Callable[[s.Ident], str]
    poses: Callable[[Sequence[f.Pose]], tuple[ir.Pose, ...]]
    sink: Sink

    @property
    def constants(self) -> Constants:
        return Constants(self.sink)

    def formula(self, formula: f.Formula) -> ir.Formula:
        match formula:
            case f.Atom():
                return self._atom(formula)
            case f.Unary():
                return self._unary(formula)
            case f.Last(duration=duration, operand=operand, span=span):
                time = self._time(duration, "the duration")
                return ir.Last(time, self.formula(operand), span)
            case f.Joined(operator=operator, operands=operands, span=span):
                parts = tuple(self.formula(part) for part in operands)
                return ir.And(parts, span) if operator == "and" else ir.Or(parts, span)
            case f.Binary(operator=operator, left=left, right=right, span=span):
                kind = ir.Until if operator == "until" else ir.Implies
                return kind(self.formula(left), self.formula(right), span)

    def _atom(self, atom: f.Atom) -> ir.Atom:
        name, poses = self.region(atom.region), self.poses(atom.poses)
        if atom.effector is None:
            return ir.Atom(name, 1, atom.span, numbered=False, poses=poses)
        number = self.constants.integer(atom.effector, 1, "an effector's number")
        return ir.Atom(name, number or 1, atom.span, poses=poses)

    def _unary(self, formula: f.Unary) -> ir.Formula:
        operand, span = self.formula(formula.operand), formula.span
        match formula.operator:
            case "not":
                return ir.Not(operand, span)
            case "next":
                return ir.Next(operand, span)
            case "always":
                return ir.Always(operand, self._window(formula.window), span)
            case "eventually":
                return ir.Eventually(operand, self._window(formula.window), span)

    def _time(self, expr: s.Expr, what: str) -> Fraction:
        """A time of at least zero; zero if an error was reported."""
        value = self.constants.rational(expr, TIME)
        if value is not None and value < 0:
            hint = "write zero or more: formulas are about the present and the future"
            self.sink.error(Code.BAD_VALUE, f"{what} is negative", expr.span, hint)
            return Fraction(0)
        return value or Fraction(0)

    def _window(self, window: f.Window | None) -> ir.Window:
        if window is None:
            return _ALWAYS
        before = len(self.sink.found)
        lower = self._time(window.lower, "the beginning of the window")
        upper = self._time(window.upper, "the end of the window")
        if not Sink(self.sink.found[before:]).has_errors and upper < lower:
            self.sink.error(
                Code.EMPTY_INTERVAL,
                "this window is empty: it ends before it begins",
                window.span,
                "swap the bounds",
            )
        return ir.Window(lower, upper)


def lower_formula(
    formula: f.Formula,
    region: Callable[[s.Ident], str],
    poses: Callable[[Sequence[f.Pose]], tuple[ir.Pose, ...]],
    sink: Sink,
) -> ir.Formula:
    """The formula; errors in it are reported.

    Args:
        formula: its syntax, whose depth the parser bounds.
        region: returns the name of a region; reports it if there is no such region.
        poses: reads the poses of an effector and reports their errors.
        sink: collects the errors.
    """
    return _Reader(region, poses, sink).formula(formula)
