"""Arguments of the builder as syntax nodes; what is a text is read by the parser of the language.

Each function has the name of the argument, for its faults: there is one message about one argument.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from decimal import Decimal
from fractions import Fraction
from math import isfinite
from numbers import Real
from typing import Any, TypeAlias

from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Sink
from grammar_lang.formatting.phrases import is_name
from grammar_lang.parsing.parse import parse
from grammar_lang.syntax import tasks as t
from srgc.faults import UsageFault

Number: TypeAlias = int | float | Decimal
Quantity: TypeAlias = str | Number
"""A text as "0.5 m" or "2 * radius", or a number in the SI unit that its argument has."""
Range: TypeAlias = str | tuple[Quantity, Quantity]
"""The lowest and the highest value, or a text as "[0.5, 5] m"."""
Vector: TypeAlias = str | Sequence[Quantity]
"""Coordinates, or a text as "(0, -9.81) m/s^2"."""

LONGEST = 60
"""Of what is shown of an argument, in characters."""

# --- texts ----------------------------------------------------------------------------------------


def read(before: str, text: object, behind: str, name: str, what: str) -> Any:
    """The one statement of the one item that a text makes with what stands before and behind it.

    Args:
        before: the text up to the argument.
        text: the argument.
        behind: the text from there on.
        name: that of the argument.
        what: it has to be, in words.

    Raises:
        UsageFault: it is no text, the parser refuses it, or it is more than that.
    """
    (found,) = read_all(before, text, behind, name, what, most=1)
    return found


def read_all(
    before: str, text: object, behind: str, name: str, what: str, most: int | None = None
) -> tuple[Any, ...]:
    """As :func:`read`, all statements of the item; of a block of semantics those of the block."""
    if not isinstance(text, str):
        raise UsageFault(f"`{name}` is {what}, not {shown(text)}")
    sink = Sink()
    items = parse(f"{before}{text}\n{behind}", sink).items
    if sink.found:
        first = sink.sorted()[0]
        raise UsageFault(f"`{name}`: {first.message}, in {shown(text)}", hint=first.hint)
    parts: tuple[Any, ...] = ()
    if len(items) == 1:
        item: Any = items[0]
        parts = item.blocks if isinstance(item, s.Semantics) else item.items
    if not parts or (most is not None and len(parts) > most):
        raise UsageFault(f"`{name}` is {what}, not {shown(text)}")
    return parts


def shown(value: object) -> str:
    """A value as messages show it."""
    text = repr(value)
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 3]}..."


def ident(text: object, name: str) -> s.Ident:
    """A name.

    Raises:
        UsageFault: it cannot be one.
    """
    if isinstance(text, str) and is_name(text):
        return s.Ident(text)
    hint = "a name has letters from A to Z, digits and `_`, and is not a reserved word"
    raise UsageFault(f"`{name}` is a name, not {shown(text)}", hint=hint)


def is_quotable(text: object) -> bool:
    """Whether a text can stand in quotes: on one line, not empty, with one kind of them."""
    if not isinstance(text, str) or not text.isprintable():
        return False
    return text != "" and not {"'", '"'} <= {*text}


def symbols(names: Iterable[str], name: str) -> tuple[s.Ident, ...]:
    """Symbols of words, which may be signs, as "[".

    Raises:
        UsageFault: there is none, or one cannot be written.
    """
    found = tuple(names)
    for each in found:
        if not is_quotable(each):
            raise UsageFault(f"`{name}` are symbols, which {shown(each)} is not")
    if not found:
        raise UsageFault(f"`{name}` are one symbol or more")
    return tuple(map(s.Ident, found))


# --- quantities -----------------------------------------------------------------------------------


def unit_of(unit: str | None, name: str = "unit") -> s.Ident | None:
    """A unit, None for none.

    Raises:
        UsageFault: it is no unit.
    """
    if unit is None:
        return None
    const = read("module M { const k = 1 ", unit, ";}", name, 'a unit, as "m/s"')
    if not isinstance(const.value, s.Number) or const.value.unit is None:
        raise UsageFault(f'`{name}` is a unit, as "m/s", not {shown(unit)}')
    return s.Ident(const.value.unit.text)


def expression(value: object, name: str, unit: str | None = None) -> s.Expr:
    """A quantity, or an expression of the language.

    Args:
        value: a text, which says its unit itself, a number, or several of them as a vector.
        name: that of the argument.
        unit: of numbers; None: they are in SI units or plain.

    Raises:
        UsageFault: it is none.
    """
    if isinstance(value, str):
        found = read("module M { const k = ", value, ";}", name, "one expression")
        if isinstance(found, s.Const):
            return found.value
        raise UsageFault(f"`{name}` is one expression, not {shown(value)}")
    if isinstance(value, Sequence) and not isinstance(value, bytes) and len(value) > 1:
        return s.Tuple(*_with_common_unit([expression(each, name, unit) for each in value]))
    return number(value, name, unit_of(unit))


def number(value: object, name: str, unit: s.Ident | None) -> s.Expr:
    """A number of Python with a unit; a double is the shortest decimal that reads back as it.

    Raises:
        UsageFault: it is no number, or not finite.
    """
    decimal = isinstance(value, Decimal | Real) and not isinstance(value, bool)
    if not decimal or not isfinite(value):  # type: ignore[arg-type]
        raise UsageFault(f'`{name}` is a finite number, or a text as "0.5 m", not {shown(value)}')
    exact = Fraction(str(value)) if isinstance(value, int | Decimal) else _shortest(value)
    node = s.Number(abs(exact), unit)
    return s.Negate(node) if exact < 0 else node


def _shortest(value: Any) -> Fraction:
    return Fraction(repr(float(value)))


def whole(value: object, name: str, least: int = 1) -> s.Expr:
    """A whole number, or an expression that is one.

    Raises:
        UsageFault: it is none, or too small.
    """
    if isinstance(value, str):
        return expression(value, name)
    if not isinstance(value, int) or isinstance(value, bool) or value < least:
        raise UsageFault(f"`{name}` is a whole number from {least} on, not {shown(value)}")
    return s.Number(Fraction(value), None)


# --- ranges, choices, vectors ---------------------------------------------------------------------


def interval(value: object, name: str, unit: str | None = None) -> s.Interval:
    """A lowest and a highest value.

    Raises:
        UsageFault: it is no range.
    """
    what = 'a lowest and a highest value, as ("0.5 m", "5 m") or "[0.5, 5] m"'
    if isinstance(value, str):
        found = read("module M { param k in ", value, ";}", name, what)
        if isinstance(found, s.Param) and isinstance(found.domain, s.Interval):
            return found.domain
        raise UsageFault(f"`{name}` is {what}, not {shown(value)}")
    if not isinstance(value, Sequence) or len(value) != 2:
        raise UsageFault(f"`{name}` is {what}, not {shown(value)}")
    (low, high), common = _with_common_unit([expression(each, name, unit) for each in value])
    return s.Interval(low, high, common)


def symmetric(value: object, name: str, unit: str) -> s.Interval:
    """A range, or the largest size of a value.

    Raises:
        UsageFault: it is neither.
    """
    if isinstance(value, str) and not value.lstrip().startswith("["):
        most = expression(value, name)
    elif isinstance(value, str | Sequence):
        return interval(value, name, unit)
    else:
        most = expression(value, name, unit)
    (low, high), common = _with_common_unit([s.Negate(most), most])
    return s.Interval(low, high, common)


def choices(value: object, name: str, unit: str | None = None) -> s.Choices:
    """Several values.

    Raises:
        UsageFault: it is no sequence of values.
    """
    what = 'values in a list, as ["0.6 m", "0.9 m"], or a text as "{0.6, 0.9} m"'
    if isinstance(value, str):
        found = read("module M { param k in ", value, ";}", name, what)
        if isinstance(found, s.Param) and isinstance(found.domain, s.Choices):
            return found.domain
        raise UsageFault(f"`{name}` is {what}, not {shown(value)}")
    if not isinstance(value, Sequence) or not value:
        raise UsageFault(f"`{name}` is {what}, not {shown(value)}")
    return s.Choices(*_with_common_unit([expression(each, name, unit) for each in value]))


def point(value: object, name: str, unit: str | None) -> t.Point:
    """Coordinates, of a point or a vector.

    Raises:
        UsageFault: they are none.
    """
    what = 'coordinates, as (0, -9.81) or "(0, -9.81) m/s^2"'
    if isinstance(value, str):
        found = read("task T { gravity ", value, ";}", name, what)
        if isinstance(found, t.Gravity):
            return found.point
        raise UsageFault(f"`{name}` is {what}, not {shown(value)}")
    if not isinstance(value, Sequence) or not value:
        raise UsageFault(f"`{name}` is {what}, not {shown(value)}")
    return t.Point(*_with_common_unit([expression(each, name, unit) for each in value]))


def _with_common_unit(values: Sequence[s.Expr]) -> tuple[tuple[s.Expr, ...], s.Ident | None]:
    """Values without their unit, and that unit, if all are numbers with one and the same."""
    units = {_unit(each) for each in values}
    unit = units.pop()
    if units or unit is None:
        return tuple(values), None
    return tuple(map(_bare, values)), unit


def _unit(value: s.Expr) -> s.Ident | None:
    match value:
        case s.Number(unit=unit):
            return unit
        case s.Negate(operand=operand):
            return _unit(operand)
        case _:
            return None


def _bare(value: s.Expr) -> s.Expr:
    match value:
        case s.Number(value=amount):
            return s.Number(amount, None)
        case s.Negate(operand=operand):
            return s.Negate(_bare(operand))
        case _:
            return value
