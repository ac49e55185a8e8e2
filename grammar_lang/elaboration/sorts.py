"""Sorts and dimensions of values, and checks that a value fits its place and is plausible."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from enum import Enum
from fractions import Fraction
from typing import Literal, Protocol

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.ir import constants
from grammar_lang.source import Span
from grammar_lang.units import (
    DENSITY,
    FORCE,
    FREQUENCY,
    LENGTH,
    MASS,
    ONE,
    SPEED,
    TIME,
    TORQUE,
    Dimension,
    Unit,
    describe,
    symbol,
)
from grammar_lang.units import unit as parse_unit

# --- Sorts and dimensions of values, and checks that a value fits its place -----------------------
#
# A value is a scalar, a vector or a frame.  A *bare* value (dimension None) is made of numbers
# without units; it takes the dimension that its place requires.


class Sort(Enum):
    """The sort of a value; UNKNOWN after an error, or if it is not yet inferred."""

    SCALAR = "a number"
    VECTOR = "a vector"
    FRAME = "a frame"
    UNKNOWN = "unknown"


@dataclass(frozen=True, slots=True)
class Typed:
    """An expression with its sort and dimension; ``declared`` is where its name is declared."""

    expr: ir.Expr
    sort: Sort
    dimension: Dimension | None
    angular: bool = False
    declared: Span | None = None

    @property
    def bare(self) -> bool:
        """Whether it takes the dimension that its place requires."""
        return self.dimension is None and self.sort in {Sort.SCALAR, Sort.VECTOR}


ZERO = ir.Num(Fraction(0))
UNKNOWN = Typed(ZERO, Sort.UNKNOWN, None)


def unknown(expr: ir.Expr) -> Typed:
    """An expression whose sort is not yet inferred; the expression is kept for what it reads."""
    return Typed(expr, Sort.UNKNOWN, None)


@dataclass(frozen=True, slots=True)
class DimensionUse:
    """An expression that is valid only in the plane (2) or only in space (3)."""

    only: Literal[2, 3]
    span: Span
    message: str


class Scope(Protocol):
    """The meaning of names at the place of an expression."""

    uses: list[DimensionUse]

    def name(self, ident: s.Ident, sink: Sink) -> Typed:
        """The value of a plain name; if it has none, report that and return UNKNOWN."""
        ...

    def member(self, member: s.Member, sink: Sink) -> Typed:
        """The value of ``owner.name``; if it has none, report that and return UNKNOWN."""
        ...

    def dof(self, name: s.Member | s.Name) -> ir.Dof | None:
        """The degree of freedom that ``owner.name``, or a plain name in its module, refers to."""
        ...

    def use_dof(self, name: s.Member | s.Name) -> ir.Expr:
        """Record that the degree of freedom is the whole argument of a ``rot`` or ``move``."""
        ...

    def mentions(self, expressions: Iterable[s.Expr]) -> tuple[int, ...]:
        """The occurrences of modules that expressions name, in order of first mention."""
        ...


def _describe(value: Typed) -> str:
    if value.sort is Sort.SCALAR and value.dimension is not None:
        angle = value.angular and value.dimension == ONE
        return "an angle" if angle else describe(value.dimension)
    return value.sort.value


def _known_already(declared: Span | None, sink: Sink) -> bool:
    if declared is None:
        return False
    return any(
        declared == span
        for found in sink.found
        if found.code is Code.UNIT_MISMATCH
        for span, _ in found.notes
    )


def mismatch(
    value: Typed, dimension: Dimension, at: Span, sink: Sink, hint: str | None = None
) -> None:
    """Report a wrong dimension, but only once for each declaration that causes it."""
    if _known_already(value.declared, sink):
        return
    if hint is None:
        unit = symbol(dimension)
        hint = f"write it in `{unit}`, as in `3 {unit}`"
        if dimension == ONE:
            hint = "write a plain number or an angle"
        elif value.declared is not None and value.dimension == ONE and not value.angular:
            hint = f"write its unit where it is declared, as in `3 {unit}`"
    notes = [] if value.declared is None else [(value.declared, "declared here")]
    message = f"expected {describe(dimension)}, found {_describe(value)}"
    sink.error(Code.UNIT_MISMATCH, message, at, hint, notes)


def wrong_sort(value: Typed, wanted: str, at: Span, sink: Sink) -> None:
    """Report a wrong sort, unless it is unknown because of an earlier error."""
    if value.sort is Sort.UNKNOWN:
        return
    hint = {
        Sort.SCALAR: "a frame is `world`, `rot(axis, angle)`, `move(axis, d)` or a product of them",
        Sort.VECTOR: "vectors may appear only in `move((x, y, z))` and `com:`",
        Sort.FRAME: "frames are joined with `*`, and may appear only in `frame:` or another frame",
    }[value.sort]
    if wanted == "a vector":
        hint = "a vector is `(x, y)`, or `(x, y, z)` in space"
    sink.error(Code.SORT_MISMATCH, f"expected {wanted}, found {_describe(value)}", at, hint)


def require_scalar(value: Typed, dimension: Dimension, at: Span, sink: Sink) -> ir.Expr:
    """The expression of a scalar of that dimension; anything else is reported."""
    if value.sort is not Sort.SCALAR:
        wrong_sort(value, describe(dimension), at, sink)
    elif value.dimension is not None and value.dimension != dimension:
        mismatch(value, dimension, at, sink)
    return value.expr


def require_vector(value: Typed, dimension: Dimension, at: Span, sink: Sink) -> ir.Expr:
    """The expression of a vector of that dimension; anything else is reported."""
    if value.sort is not Sort.VECTOR:
        wrong_sort(value, "a vector", at, sink)
    elif value.dimension is not None and value.dimension != dimension:
        mismatch(value, dimension, at, sink)
    return value.expr


def require_frame(value: Typed, at: Span, sink: Sink) -> ir.Expr:
    """The expression of a frame; anything else is reported."""
    if value.sort is not Sort.FRAME:
        wrong_sort(value, "a frame", at, sink)
    return value.expr


def warn_turn(value: Typed, at: Span, sink: Sink) -> None:
    """Warn of a bare angle above a full turn: it was probably meant in degrees."""
    if not value.bare or value.sort is not Sort.SCALAR or not constants.is_closed(value.expr):
        return
    try:
        size = abs(constants.to_float(value.expr))
    except ValueError:
        return
    if size > 2 * math.pi:
        sink.warning(
            Code.ANGLE_ABOVE_TURN,
            "this angle is more than a turn: a number without a unit is in radians",
            at,
            "write `deg` or `rad` after it",
        )


def finite(value: Typed, at: Span, sink: Sink) -> Typed:
    """The value; if it is closed but has no finite real value, report that and return UNKNOWN."""
    if value.sort is not Sort.SCALAR or not constants.is_closed(value.expr):
        return value
    try:
        constants.to_float(value.expr)
    except ValueError:
        message = "this has no finite value"
        hint = "it divides by zero, takes the root of a negative number or exceeds 1e308"
        if isinstance(value.expr, ir.Num):
            message, hint = "this number is too large", "use a smaller one"
        sink.error(Code.BAD_NUMBER, message, at, hint)
        return UNKNOWN
    return value


def folded(build: Callable[[], ir.Expr], at: Span, sink: Sink) -> ir.Expr | None:
    """The expression that ``build`` makes; None if its numbers are too large, which is reported."""
    try:
        return build()
    except constants.MagnitudeError:
        sink.error(Code.BAD_NUMBER, "this number is too large", at, "use a smaller one")
        return None


def scale(value: Typed, unit: Unit, at: Span, sink: Sink) -> Typed:
    """A bare value in a unit; a value that already has a dimension is unchanged."""
    if not value.bare:
        return value
    factor = constants.from_monomial((unit.factor, unit.pi_power))

    def times(expr: ir.Expr) -> ir.Expr:
        return constants.binary("*", expr, factor)

    def build() -> ir.Expr:
        match value.expr:
            case ir.Vector(x=x, y=y, z=z):
                return ir.Vector(times(x), times(y), times(z))
            case expr:
                return times(expr)

    expr = folded(build, at, sink)
    if expr is None:
        return UNKNOWN
    return finite(Typed(expr, value.sort, unit.dimension, unit.angular), at, sink)


# --- Implausible values: probably a wrong unit, or a digit too many -------------------------------
#
# One table gives generous bounds.  Zero is always plausible.  In intervals and choices each value
# is checked separately.  Bare angles above a full turn are checked by
# :func:`grammar_lang.elaboration.sorts.warn_turn`.


@dataclass(frozen=True, slots=True)
class Plausible:
    """The plausible sizes ``least <= size <= most`` of a quantity in SI units, and its usual units.

    ``units`` begins with the SI unit; ``least`` is 0 if every small value is plausible.
    """

    name: str
    least: float
    most: float
    units: tuple[str, ...]

    def holds(self, size: float) -> bool:
        """Whether a size in SI units is plausible."""
        return self.least <= size <= self.most


SMALLEST, LARGEST = 1e-100, 1e100
"""Bounds on quantities in SI units, chosen so that their squares, with a margin, are doubles."""
PLAUSIBLE: dict[Dimension, Plausible] = {
    LENGTH: Plausible("length", 1e-6, 1e4, ("m", "cm", "mm")),
    MASS: Plausible("mass", 1e-9, 1e6, ("kg", "g")),
    TIME: Plausible("time", 1e-6, 1e6, ("s", "ms", "min")),
    FORCE: Plausible("force", 0, 1e9, ("N",)),
    TORQUE: Plausible("torque", 0, 1e9, ("N*m", "N*cm", "N*mm")),
    FREQUENCY: Plausible("angular rate", 0, 1e5, ("rad/s", "deg/s")),
    SPEED: Plausible("speed", 0, 1e5, ("m/s", "cm/s", "mm/s")),
    DENSITY: Plausible("mass per length", 0, 1e6, ("kg/m", "g/m", "g/cm", "g/mm")),
}


def _factor(unit: Unit) -> float:
    return float(unit.factor) * math.pi**unit.pi_power


def _written(expr: s.Expr, unit: Unit | None) -> tuple[s.Number | None, Unit | None]:
    """The number in a plain or negated literal, and its unit, which may be that of its list."""
    while isinstance(expr, s.Negate):
        expr = expr.operand
    if not isinstance(expr, s.Number):
        return None, None
    return expr, unit if expr.unit is None else parse_unit(expr.unit.text)


def _hint(size: float, due: Plausible, expr: s.Expr, unit: Unit | None) -> str:
    """A unit that makes the value plausible, preferably close to 1; otherwise the usual range."""
    number, own = _written(expr, unit)
    if number is not None:
        plain = size if own is None else size / _factor(own)
        sizes = ((plain * _factor(u), name) for name in due.units if (u := parse_unit(name)))
        likely = [(abs(math.log10(new)), name) for new, name in sizes if due.holds(new)]
        if likely:
            where = f" a number without a unit is in `{due.units[0]}`" if own is None else ""
            return f"did you mean `{min(likely)[1]}`?{where}"
    return f"check the digits and the unit; usual is {_usual(due)}"


def _usual(due: Plausible) -> str:
    most = f"{due.most:g} {due.units[0]}"
    return f"at most {most}" if not due.least else f"{due.least:g} to {most}"


def _size(value: ir.Expr) -> float:
    """The size in floating point, but positive if the value is an exact non-zero number."""
    size = abs(constants.to_float(value))
    if not size and isinstance(value, ir.Num) and value.value:
        return math.ulp(0.0)
    return size


def warn_implausible(
    value: Typed, dimension: Dimension, written: s.Expr, unit: Unit | None, sink: Sink
) -> bool:
    """Report a closed scalar that is implausibly large or small; return whether it was reported.

    It is an error if floating point could not hold the squares of such numbers, otherwise a
    warning.

    Args:
        value: the value in SI units; other sorts and dimensions and open values are ignored.
        dimension: its dimension, or the one that its place requires.
        written: its syntax; a plain name is ignored, since its declaration is checked.
        unit: the unit of the list that contains it, if any.
        sink: collects the diagnostic.
    """
    due = PLAUSIBLE.get(dimension)
    if due is None or value.sort is not Sort.SCALAR or isinstance(written, s.Name | s.Member):
        return False
    if value.dimension not in {None, dimension} or not constants.is_closed(value.expr):
        return False
    try:
        size = _size(value.expr)
    except ValueError:
        return False
    if not size or (due.holds(size) and size >= SMALLEST):
        return False
    if not SMALLEST <= size <= LARGEST:
        message = f"{due.name} out of range: {size:.6g} {symbol(dimension)}"
        hint = f"write zero, or a size from {SMALLEST:g} to {LARGEST:g} in SI units"
        sink.error(Code.BAD_NUMBER, message, written.span, hint)
        return True
    message = f"implausible {due.name}: {size:.6g} {symbol(dimension)}"
    sink.warning(Code.IMPLAUSIBLE_VALUE, message, written.span, _hint(size, due, written, unit))
    return True


def warn_implausible_vector(
    value: Typed, dimension: Dimension, written: s.Expr, sink: Sink
) -> None:
    """As :func:`warn_implausible`, for each component of a vector."""
    if not isinstance(value.expr, ir.Vector) or not isinstance(written, s.Tuple):
        return
    unit = None if written.unit is None else parse_unit(written.unit.text)
    parts = (value.expr.x, value.expr.y, value.expr.z)
    for part, item in zip(parts, written.items, strict=False):
        warn_implausible(Typed(part, Sort.SCALAR, value.dimension), dimension, item, unit, sink)
