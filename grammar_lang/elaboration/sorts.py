"""Sorts and dimensions of values; whether a value fits its place and is plausible."""

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

# --- Sorts and dimensions of values, and the checks that a value fits its place -------------------
#
# A value is a scalar, a vector or a frame.  A *bare* value (dimension None) is made of numbers
# without units; it takes the dimension that its place requires.


class Sort(Enum):
    """What a value is; UNKNOWN after an error, or where it is not yet inferred."""

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
        """Whether it takes the dimension of its place."""
        return self.dimension is None and self.sort in {Sort.SCALAR, Sort.VECTOR}


ZERO = ir.Num(Fraction(0))
UNKNOWN = Typed(ZERO, Sort.UNKNOWN, None)


def unknown(expr: ir.Expr) -> Typed:
    """An expression of a sort that is not yet inferred; what it reads is kept."""
    return Typed(expr, Sort.UNKNOWN, None)


@dataclass(frozen=True, slots=True)
class DimensionUse:
    """Something that makes sense in the plane (2) or in space (3) only."""

    only: Literal[2, 3]
    span: Span
    message: str


class Scope(Protocol):
    """What names mean where an expression stands."""

    uses: list[DimensionUse]

    def name(self, ident: s.Ident, sink: Sink) -> Typed:
        """The value of a plain name; reports it and returns UNKNOWN if there is none."""
        ...

    def member(self, member: s.Member, sink: Sink) -> Typed:
        """The value of ``owner.name``; reports it and returns UNKNOWN if there is none."""
        ...

    def dof(self, name: s.Member | s.Name) -> ir.Dof | None:
        """The degree of freedom that ``owner.name``, or a plain name in its module, is."""
        ...

    def use_dof(self, name: s.Member | s.Name) -> ir.Expr:
        """Take note that the degree of freedom stands alone in a ``rot`` or ``move`` here."""
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
    """Report a wrong dimension, once for each declaration that is to blame."""
    if _known_already(value.declared, sink):
        return
    if hint is None:
        unit = symbol(dimension)
        hint = f"write it in `{unit}`, as in `3 {unit}`"
        if dimension == ONE:
            hint = "write a plain number or an angle"
    notes = [] if value.declared is None else [(value.declared, "declared here")]
    message = f"expected {describe(dimension)}, found {_describe(value)}"
    sink.error(Code.UNIT_MISMATCH, message, at, hint, notes)


def wrong_sort(value: Typed, wanted: str, at: Span, sink: Sink) -> None:
    """Report a wrong sort; silent where the sort is unknown because of an earlier error."""
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
    """The expression of a scalar of that dimension; whatever else it is, is reported."""
    if value.sort is not Sort.SCALAR:
        wrong_sort(value, describe(dimension), at, sink)
    elif value.dimension is not None and value.dimension != dimension:
        mismatch(value, dimension, at, sink)
    return value.expr


def require_vector(value: Typed, dimension: Dimension, at: Span, sink: Sink) -> ir.Expr:
    """The expression of a vector of that dimension."""
    if value.sort is not Sort.VECTOR:
        wrong_sort(value, "a vector", at, sink)
    elif value.dimension is not None and value.dimension != dimension:
        mismatch(value, dimension, at, sink)
    return value.expr


def require_frame(value: Typed, at: Span, sink: Sink) -> ir.Expr:
    """The expression of a frame."""
    if value.sort is not Sort.FRAME:
        wrong_sort(value, "a frame", at, sink)
    return value.expr


def warn_turn(value: Typed, at: Span, sink: Sink) -> None:
    """Warn of a bare angle above a turn: it was probably meant in degrees."""
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
    """The value, or UNKNOWN (reported) where it is closed and has no finite real value."""
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
    """The expression that ``build`` makes; numbers too large to represent are reported."""
    try:
        return build()
    except constants.MagnitudeError:
        sink.error(Code.BAD_NUMBER, "this number is too large", at, "use a smaller one")
        return None


def scale(value: Typed, unit: Unit, at: Span, sink: Sink) -> Typed:
    """A bare value in a unit; a value with a dimension of its own is left as it is."""
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


# --- Values that nobody builds a robot with: probably a wrong unit, or a digit too many -----------
#
# One table says what is plausible, generously.  Zero always is; intervals and choices are judged
# value by value.  Bare angles above a turn are :func:`grammar_lang.elaboration.sorts.warn_turn`'s.


@dataclass(frozen=True, slots=True)
class Plausible:
    """The sizes ``least <= size <= most`` of a quantity, in SI, and the units it may be meant in.

    ``units`` begins with the SI unit; ``least`` is 0 where every small value is plausible.
    """

    name: str
    least: float
    most: float
    units: tuple[str, ...]

    def holds(self, size: float) -> bool:
        """Whether a size in SI units is plausible."""
        return self.least <= size <= self.most


SMALLEST, LARGEST = 1e-100, 1e100
"""Of a quantity in SI units; the squares of such numbers, and some more, are doubles."""
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
    """The only number of an expression and its unit, of its own or of its list."""
    while isinstance(expr, s.Negate):
        expr = expr.operand
    if not isinstance(expr, s.Number):
        return None, None
    return expr, unit if expr.unit is None else parse_unit(expr.unit.text)


def _hint(size: float, due: Plausible, expr: s.Expr, unit: Unit | None) -> str:
    """The unit that makes the value plausible, the nearest to one of it; else what is usual."""
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
    """The size in floating point; positive where the value is an exact number and is not zero."""
    size = abs(constants.to_float(value))
    if not size and isinstance(value, ir.Num) and value.value:
        return math.ulp(0.0)
    return size


def warn_implausible(
    value: Typed, dimension: Dimension, written: s.Expr, unit: Unit | None, sink: Sink
) -> bool:
    """Whether a closed scalar is out of all proportion, which is then reported.

    It is an error where floating point could not hold the squares of such numbers.

    Args:
        value: the value in SI; nothing is said of one of another sort or dimension, or of one that
            is not closed.
        dimension: what it is, or what its place takes it for.
        written: how it is written; a name alone was judged where it is declared.
        unit: the unit of the list in which it stands, if any.
        sink: takes the diagnostic.
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
    """The same of each component of a vector."""
    if not isinstance(value.expr, ir.Vector) or not isinstance(written, s.Tuple):
        return
    unit = None if written.unit is None else parse_unit(written.unit.text)
    parts = (value.expr.x, value.expr.y, value.expr.z)
    for part, item in zip(parts, written.items, strict=False):
        warn_implausible(Typed(part, Sort.SCALAR, value.dimension), dimension, item, unit, sink)
