"""Values that nobody builds a robot with: probably a wrong unit, or a digit too many.

One table says what is plausible, generously.  Zero always is; intervals and choices are judged
value by value.  Bare angles above a turn are :func:`grammar_lang.elaboration.sorts.warn_turn`'s.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.codes import Code
from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.elaboration.sorts import Sort, Typed
from grammar_lang.ir import constants
from grammar_lang.units import (
    DENSITY,
    FORCE,
    FREQUENCY,
    LENGTH,
    MASS,
    SPEED,
    TIME,
    TORQUE,
    Dimension,
    Unit,
    symbol,
)
from grammar_lang.units import unit as parse_unit


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
    """Whether a closed scalar is out of all proportion, which is then warned of.

    Args:
        value: the value in SI; nothing is said of one of another sort or dimension, or of one that
            is not closed.
        dimension: what it is, or what its place takes it for.
        written: how it is written; a name alone was judged where it is declared.
        unit: the unit of the list in which it stands, if any.
        sink: takes the warning.
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
    if not size or due.holds(size):
        return False
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
