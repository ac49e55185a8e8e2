"""Constant expressions where a number is required: bounds, coordinates, clauses of tasks."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Literal

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.elaboration.sorts import (
    UNKNOWN,
    DimensionUse,
    Scope,
    Sort,
    Typed,
    mismatch,
    require_scalar,
    scale,
    warn_implausible,
    warn_turn,
    wrong_sort,
)
from grammar_lang.elaboration.typecheck import Checker, plain_name, read_unit
from grammar_lang.ir import constants
from grammar_lang.source import Span
from grammar_lang.units import ONE, Dimension, Unit


@dataclass(slots=True)
class ClosedScope:
    """A scope without any names but ``pi``."""

    uses: list[DimensionUse] = field(default_factory=list[DimensionUse])

    def name(self, ident: s.Ident, sink: Sink) -> Typed:
        """``pi``, or an error."""
        return plain_name(ident, (), sink)

    def member(self, member: s.Member, sink: Sink) -> Typed:
        """Report an error: ``owner.name`` is not a constant."""
        message = f"`{member.owner.text}.{member.name.text}` is not a constant"
        hint = "a constant is made of numbers, units and `pi`"
        sink.error(Code.NOT_CONSTANT, message, member.span, hint)
        return UNKNOWN

    def dof(self, name: s.Member | s.Name) -> ir.Dof | None:
        """None: there are no degrees of freedom here."""
        del name
        return None

    def use_dof(self, name: s.Member | s.Name) -> ir.Expr:
        """Raise LookupError: never called, because there are no degrees of freedom here."""
        raise LookupError(name)

    def mentions(self, expressions: Iterable[s.Expr]) -> tuple[int, ...]:
        """Empty: there are no modules of a production here."""
        del expressions
        return ()


def not_rational(at: Span, sink: Sink, notes: Iterable[tuple[Span, str]] = ()) -> None:
    """Report a number that must be an exact rational, but is not evidently one."""
    sink.error(
        Code.NOT_RATIONAL,
        "this is not a rational number",
        at,
        "write a decimal or a fraction; angles in `rad`",
        notes,
    )


@dataclass(frozen=True, slots=True)
class ListUnit:
    """The trailing unit of a list, checked against the dimension that its place requires.

    ``broken`` means that the unit was reported, so that bare values are not reported again.
    """

    unit: Unit | None
    broken: bool = False


def list_unit(unit: s.Ident | None, dimension: Dimension | None, sink: Sink) -> ListUnit:
    """Read the trailing unit of a list; report it if it is unknown or of another dimension."""
    if unit is None:
        return ListUnit(None)
    found = read_unit(unit, sink)
    if found is None:
        return ListUnit(None, broken=True)
    if dimension is not None and found.dimension != dimension:
        wrong = Typed(ir.Pi(), Sort.SCALAR, found.dimension, found.angular)
        mismatch(wrong, dimension, unit.span, sink)
        return ListUnit(None, broken=True)
    return ListUnit(found)


NO_UNIT = ListUnit(None)


@dataclass(frozen=True, slots=True)
class Constants:
    """Reads constant expressions in a scope."""

    sink: Sink
    scope: Scope = field(default_factory=ClosedScope)

    def typed(self, expr: s.Expr, unit: ListUnit = NO_UNIT) -> Typed:
        """A closed scalar; UNKNOWN if an error was reported."""
        value = self._read(expr, unit)
        if value.dimension is not None:
            warn_implausible(value, value.dimension, expr, unit.unit, self.sink)
        return value

    def _read(self, expr: s.Expr, unit: ListUnit) -> Typed:
        """A closed scalar, without the check that it is plausible."""
        value = Checker(self.scope, self.sink).elaborate(expr)
        if value.sort is not Sort.SCALAR:
            wrong_sort(value, "a number", expr.span, self.sink)
            return UNKNOWN
        if not constants.is_closed(value.expr):
            message = "this depends on a parameter, so it is not a constant"
            hint = "write a number, or a module for each value"
            self.sink.error(Code.NOT_CONSTANT, message, expr.span, hint)
            return UNKNOWN
        if value.bare and unit.broken:
            return UNKNOWN
        if unit.unit is not None:
            value = scale(value, unit.unit, expr.span, self.sink)
        return value

    def scalar(
        self,
        expr: s.Expr,
        dimension: Dimension,
        unit: ListUnit = NO_UNIT,
        *,
        angle: bool = False,
    ) -> ir.Expr | None:
        """A closed scalar of that dimension; None if an error was reported."""
        before = len(self.sink.found)
        value = self._read(expr, unit)
        if angle:
            warn_turn(value, expr.span, self.sink)
        require_scalar(value, dimension, expr.span, self.sink)
        warn_implausible(value, dimension, expr, unit.unit, self.sink)
        return self._unless_error(value.expr, before, value)

    def _unless_error(self, expr: ir.Expr, before: int, value: Typed) -> ir.Expr | None:
        failed = value.sort is Sort.UNKNOWN or Sink(self.sink.found[before:]).has_errors
        return None if failed else expr

    def rational(
        self,
        expr: s.Expr,
        dimension: Dimension,
        unit: ListUnit = NO_UNIT,
    ) -> Fraction | None:
        """An exact rational of that dimension in SI units; None if an error was reported."""
        value = self.scalar(expr, dimension, unit)
        return None if value is None else self.exact(value, expr.span)

    def exact(self, value: ir.Expr, at: Span) -> Fraction | None:
        """The rational value of a closed expression; reported if it has none."""
        found = constants.rational(value)
        if found is None:
            not_rational(at, self.sink)
        return found

    def integer(self, expr: s.Expr, least: int | None, what: str) -> int | None:
        """A whole number of at least ``least``; None if an error was reported."""
        value = self.scalar(expr, ONE)
        if value is None:
            return None
        found = constants.rational(value)
        if found is None or found.denominator != 1 or (least is not None and found < least):
            bound = "" if least is None else f", at least {least}"
            message = f"{what} is a whole number{bound}"
            self.sink.error(Code.BAD_VALUE, message, expr.span, f"write a whole number{bound}")
            return None
        return found.numerator

    def interval(
        self, interval: s.Interval, dimension: Dimension | None, *, angle: bool = False
    ) -> tuple[ir.Interval, Typed] | None:
        """A closed interval, and a typed sample of it for its dimension and whether it is angular.

        Without a required dimension a bare interval is dimensionless.
        """
        unit = list_unit(interval.unit, dimension, self.sink)
        found = self._values((interval.lower, interval.upper), dimension, unit, angle=angle)
        if found is None:
            return None
        values, sample = found
        lower, upper = values
        if constants.less(upper, lower):
            self.sink.error(
                Code.EMPTY_INTERVAL,
                "this interval is empty: its lower bound exceeds its upper bound",
                interval.span,
                "swap the bounds",
            )
            return None
        return ir.Interval(lower, upper), sample

    def choices(self, choices: s.Choices) -> tuple[ir.Choices, Typed] | None:
        """A finite set of values, and a typed sample of it."""
        unit = list_unit(choices.unit, None, self.sink)
        found = self._values(choices.values, None, unit, angle=False)
        if found is None:
            return None
        values, sample = found
        seen: dict[ir.Expr, int] = {}
        for index, value in enumerate(values):
            if value in seen:
                notes = [(choices.values[seen[value]].span, "first here")]
                at = choices.values[index].span
                self.sink.error(Code.BAD_VALUE, "this value occurs twice", at, "remove one", notes)
                return None
            seen[value] = index
        return ir.Choices(values), sample

    def _values(
        self,
        exprs: tuple[s.Expr, ...],
        dimension: Dimension | None,
        unit: ListUnit,
        *,
        angle: bool,
    ) -> tuple[tuple[ir.Expr, ...], Typed] | None:
        """Values of one dimension: the required one, or that of the first value that has one."""
        typed = [self._read(e, unit) for e in exprs]
        if unit.broken or any(v.sort is Sort.UNKNOWN for v in typed):
            return None
        dimensions = (v.dimension for v in typed if v.dimension is not None)
        common = dimension or next(dimensions, ONE)
        sound = True
        for value, expr in zip(typed, exprs, strict=True):
            if angle:
                warn_turn(value, expr.span, self.sink)
            require_scalar(value, common, expr.span, self.sink)
            sound = sound and value.dimension in {None, common}
        if not sound:
            return None
        any(  # one warning is enough
            warn_implausible(value, common, expr, unit.unit, self.sink)
            for value, expr in zip(typed, exprs, strict=True)
        )
        sample = Typed(typed[0].expr, Sort.SCALAR, common, any(v.angular for v in typed))
        return tuple(v.expr for v in typed), sample


def coordinates(
    reader: Constants,
    items: tuple[s.Expr, ...],
    unit: ListUnit,
    dimension: Dimension,
    size: Literal[2, 3],
    at: Span,
) -> tuple[Fraction, ...] | None:
    """The exact coordinates of a point in the plane (2) or in space (3)."""
    if len(items) != size:
        message = f"expected {size} coordinates, found {len(items)}"
        where = "in the plane" if size == 2 else "in space"
        reader.sink.error(Code.OUT_OF_PLANE, message, at, f"a point {where} has {size} coordinates")
        return None
    values = [reader.rational(item, dimension, unit) for item in items]
    found = tuple(v for v in values if v is not None)
    return found if len(found) == size else None
