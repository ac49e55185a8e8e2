"""``robust start`` and ``robust effort``: disturbances that a motion has to bear."""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import Literal, TypeAlias

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.codes import Code
from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.elaboration.closed import Constants, not_rational
from grammar_lang.elaboration.sorts import Sort, Typed
from grammar_lang.ir import constants
from grammar_lang.source import Span
from grammar_lang.syntax import tasks as t
from grammar_lang.units import FREQUENCY, LENGTH, ONE, SPEED, Dimension, describe

Radius: TypeAlias = Literal["length", "angle", "speed", "angular_rate"]

_KINDS: dict[Dimension, Radius] = {
    LENGTH: "length",
    ONE: "angle",
    SPEED: "speed",
    FREQUENCY: "angular_rate",
}
_ARTICLED: dict[Radius, str] = {
    "length": "a length",
    "angle": "an angle",
    "speed": "a speed",
    "angular_rate": "an angular rate",
}
_HINT = (
    "write a length, an angle, a speed or an angular rate: `1 mm`, `0.1 deg`, `1 mm/s`, `1 deg/s`"
)

# pi = 3.14159265358979323846264338327950288419...
_PI_BELOW = Fraction(314159265358979323846264338327950288, 10**35)
_PI_ABOVE = _PI_BELOW + Fraction(1, 10**35)


def _at_least(value: constants.Monomial) -> Fraction:
    """A rational at least a positive ``q * pi**k``, and above it by less than 1e-30 of it."""
    factor, power = value
    return factor * (_PI_ABOVE**power if power >= 0 else 1 / _PI_BELOW**-power)


@dataclass(slots=True)
class _Reader:
    sink: Sink
    radii: dict[Radius, tuple[Fraction, Span]] = field(
        default_factory=dict[Radius, tuple[Fraction, Span]]
    )
    effort: tuple[Fraction, Span] | None = None

    def start(self, item: t.RobustStart) -> None:
        for expr in item.values:
            value = Constants(self.sink).typed(expr)
            kind = self._kind(value, expr.span)
            if kind is not None:
                self._radius(kind, value, expr)

    def _kind(self, value: Typed, at: Span) -> Radius | None:
        if value.sort is not Sort.SCALAR:
            return None
        if value.dimension is None:
            self.sink.error(Code.UNIT_MISMATCH, "a disturbance without a unit", at, _HINT)
            return None
        kind = _KINDS.get(value.dimension)
        if kind is None or (kind == "angle" and not value.angular):
            message = f"{describe(value.dimension)} is no disturbance of a start"
            self.sink.error(Code.UNIT_MISMATCH, message, at, _HINT)
            return None
        return kind

    def _radius(self, kind: Radius, value: Typed, expr: s.Expr) -> None:
        if kind in self.radii:
            message = f"a second disturbance by {_ARTICLED[kind]}"
            notes = [(self.radii[kind][1], "first here")]
            self.sink.error(Code.REPEATED_CLAUSE, message, expr.span, "remove one", notes)
            return
        # A larger disturbance is bounded than the one written, where that one is irrational.
        exact = constants.evident(value.expr)
        if exact is None:
            not_rational(expr.span, self.sink)
        elif exact[0] <= 0:
            message = "the disturbance is not positive"
            self.sink.error(Code.BAD_VALUE, message, expr.span, "write more than zero")
        self.radii[kind] = (Fraction(0) if exact is None else _at_least(exact), expr.span)

    def percent(self, item: t.RobustEffort) -> None:
        if self.effort is not None:
            notes = [(self.effort[1], "first here")]
            message = "a second `robust effort`"
            self.sink.error(Code.REPEATED_CLAUSE, message, item.span, "remove one", notes)
            return
        value = Constants(self.sink).rational(item.percent, ONE)
        if value is not None and not 0 < value < 100:
            message = "the disturbance of the efforts is not between 0 % and 100 %"
            hint = "write a percentage such as `5 %`"
            self.sink.error(Code.BAD_VALUE, message, item.percent.span, hint)
        self.effort = ((value or Fraction(0)) / 100, item.span)


def lower_robust(items: tuple[t.TaskItem, ...], sink: Sink) -> ir.Robust | None:
    """What the ``robust`` clauses of a task say together; None where there is none."""
    reader = _Reader(sink)
    spans: list[Span] = []
    for item in items:
        match item:
            case t.RobustStart():
                reader.start(item)
                spans.append(item.span)
            case t.RobustEffort():
                reader.percent(item)
                spans.append(item.span)
            case _:
                pass
    if not spans:
        return None
    radii = {kind: value for kind, (value, _) in reader.radii.items()}
    none = Fraction(0)
    return ir.Robust(
        angle=radii.get("angle", none),
        length=radii.get("length", none),
        angular_rate=radii.get("angular_rate", none),
        speed=radii.get("speed", none),
        effort=none if reader.effort is None else reader.effort[0],
        spans=tuple(spans),
    )
