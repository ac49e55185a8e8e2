"""Values of joint coordinates and rates in a task: the start, and the rates at the end."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.elaboration.closed import Constants, list_unit, not_rational
from grammar_lang.elaboration.sorts import Sort, Typed, mismatch, warn_turn, wrong_sort
from grammar_lang.ir.enclosures import rational_bounds
from grammar_lang.source import Span
from grammar_lang.syntax import tasks as t
from grammar_lang.units import FREQUENCY, LENGTH, ONE, SPEED, TIME, Dimension

COORDINATES: Mapping[ir.DofKind, Dimension] = {"revolute": ONE, "prismatic": LENGTH}
"""The dimension of a coordinate; a bare number fits either kind."""
RATES: Mapping[ir.DofKind, Dimension] = {"revolute": FREQUENCY, "prismatic": SPEED}


def _of_kinds(
    value: Typed,
    dimensions: Mapping[ir.DofKind, Dimension],
    kinds: tuple[ir.DofKind, ...],
    at: Span,
    sink: Sink,
) -> bool:
    """Whether a value has the dimension required by one of the ``kinds`` of joints."""
    if value.sort is not Sort.SCALAR:
        wrong_sort(value, "a number", at, sink)
        return False
    due = [dimensions[kind] for kind in kinds or tuple(dimensions)]
    if value.dimension is None or value.dimension in due:
        return True
    mismatch(value, due[0], at, sink)
    return False


def start_rates(expr: s.Expr, kinds: tuple[ir.DofKind, ...], sink: Sink) -> Fraction:
    """The bound on all rates at the start, in SI units; zero if it could not be read.

    Args:
        expr: the bound as written, an angular rate or a speed.
        kinds: the kinds of joints of the family; empty: any.
        sink: collects the errors.
    """
    reader = Constants(sink)
    value = reader.typed(expr)
    if not _of_kinds(value, RATES, kinds, expr.span, sink):
        return Fraction(0)
    exact = reader.exact(value.expr, expr.span)
    if exact is not None and exact < 0:
        sink.error(Code.BAD_VALUE, "the rates are negative", expr.span, "write zero or more")
    return exact or Fraction(0)


def final_rates(
    item: t.FinalRates,
    kinds: tuple[ir.DofKind, ...],
    sink: Sink,
    hint: str = "write `at rest`, or more than zero",
) -> ir.FinalRates:
    """The bound on the rates at the end of a motion, and how long it applies.

    Args:
        item: the syntax of the bound.
        kinds: the kinds of joints of the family; empty: any.
        sink: collects the errors.
        hint: what to write instead of rates that are not positive.
    """
    bounds, duration = (ir.REST_RATE, ir.REST_RATE), Fraction(0)
    if item.bound is not None:
        bounds = _final_bounds(item.bound, kinds, sink, hint)
    if item.duration is not None:
        value = Constants(sink).rational(item.duration, TIME)
        if value is not None and value <= 0:
            message = "the duration is not positive"
            sink.error(Code.BAD_VALUE, message, item.duration.span, "write more than zero")
        duration = max(value or Fraction(0), Fraction(0))
    return ir.FinalRates(*bounds, duration)


def _final_bounds(
    expr: s.Expr, kinds: tuple[ir.DofKind, ...], sink: Sink, hint: str
) -> tuple[Fraction, Fraction]:
    """Rational lower and upper bounds of the value written; zero if an error was reported."""
    none = Fraction(0), Fraction(0)
    value = Constants(sink).typed(expr)
    if not _of_kinds(value, RATES, kinds, expr.span, sink):
        return none
    bounds = rational_bounds(value.expr)
    if bounds is None:
        not_rational(expr.span, sink)
        return none
    if bounds[1] <= 0:
        sink.error(Code.BAD_VALUE, "the rates are not positive", expr.span, hint)
        return none
    return bounds


def check_duration(task: t.Task, reach: ir.Reach | None, horizon: Fraction, sink: Sink) -> None:
    """Report a stay at the end that is longer than the motion, of ``horizon`` seconds."""
    if reach is None or reach.rates is None or reach.rates.duration <= horizon:
        return
    written = next(item for item in task.items if isinstance(item, t.Reach))
    at = written.span
    if written.rates is not None and written.rates.duration is not None:
        at = written.rates.duration.span
    message = "the end of the motion lasts longer than the horizon"
    sink.error(Code.BAD_VALUE, message, at, "write a shorter time, or a longer horizon")


def start_values(
    point: t.Point, span: Span, kinds: tuple[ir.DofKind, ...], sink: Sink
) -> ir.StartAt:
    """The start at these coordinates; wrong ones are reported and left out.

    Args:
        point: the coordinates, in the order of the word.
        span: the whole clause.
        kinds: the kinds of joints of the family; empty: any.
        sink: collects the errors.
    """
    reader, unit = Constants(sink), list_unit(point.unit, None, sink)
    found: list[tuple[ir.Expr, ir.DofKind | None, Span]] = []
    for item in point.items:
        value = reader.typed(item, unit)
        if kinds == ("revolute",):
            warn_turn(value, item.span, sink)
        if _of_kinds(value, COORDINATES, kinds, item.span, sink):
            due = (kind for kind, each in COORDINATES.items() if each == value.dimension)
            found.append((value.expr, next(due, None), item.span))
    values, kinds_due, places = zip(*found, strict=True) if found else ((), (), ())
    return ir.StartAt(values, span, kinds_due, places)
