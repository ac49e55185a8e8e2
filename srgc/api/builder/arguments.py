"""Convert arguments of the builder to syntax nodes; the parser of the language reads texts.

Each function gets the name of the argument for its error messages.
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
"""A text such as "0.5 m" or "2 * radius", or a number in the SI unit of the argument."""
Range: TypeAlias = str | tuple[Quantity, Quantity]
"""The lowest and the highest value, or a text such as "[0.5, 5] m"."""
Vector: TypeAlias = str | Sequence[Quantity]
"""Coordinates, or a text such as "(0, -9.81) m/s^2"."""

LONGEST = 60
"""The longest representation of an argument in a message, in characters."""

# --- texts ----------------------------------------------------------------------------------------


def read(before: str, text: object, behind: str, name: str, what: str) -> Any:
    """Parse an argument within an item that has no other statement.

    Args:
        before: the text of the item before the argument.
        text: the argument.
        behind: the text of the item after the argument.
        name: the name of the argument.
        what: what the argument has to be, for messages.

    Raises:
        UsageFault: the argument is not a text, the parser refuses it, or it is more than one
            statement.
    """
    (found,) = read_all(before, text, behind, name, what, most=1)
    return found


def read_all(
    before: str, text: object, behind: str, name: str, what: str, most: int | None = None
) -> tuple[Any, ...]:
    """Like :func:`read`, but return all statements of the item, or the blocks of semantics.

    Raises:
        UsageFault: as of :func:`read`.
    """
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
    """The representation of a value in messages."""
    text = repr(value)
    return text if len(text) <= LONGEST else f"{text[: LONGEST - 3]}..."


def ident(text: object, name: str) -> s.Ident:
    """A name.

    Raises:
        UsageFault: the argument is not a name.
    """
    if isinstance(text, str) and is_name(text):
        return s.Ident(text)
    hint = "a name has letters from A to Z, digits and `_`, and is not a reserved word"
    raise UsageFault(f"`{name}` is a name, not {shown(text)}", hint=hint)


def is_quotable(text: object) -> bool:
    """Whether a text can be quoted: it is not empty, on one line, with one kind of quotes."""
    if not isinstance(text, str) or not text.isprintable():
        return False
    return text != "" and not {"'", '"'} <= {*text}


def quotable(text: object, name: str) -> s.Ident:
    """A text that stands in quotes.

    Raises:
        UsageFault: the argument is no text that can be quoted.
    """
    if is_quotable(text):
        return s.Ident(str(text))
    raise UsageFault(
        f"`{name}` is a text on one line with one kind of quotes at most, not {shown(text)}"
    )


def symbols(names: Iterable[str], name: str) -> tuple[s.Ident, ...]:
    """Symbols of words, which may be signs such as "[".

    Raises:
        UsageFault: there is none, or one of them cannot be quoted.
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
    """A unit, or None.

    Raises:
        UsageFault: the text is not a unit.
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
        value: a text with its unit, a number, or a sequence of them for a vector.
        name: the name of the argument.
        unit: the unit of numbers; if None, they have SI units or no unit.

    Raises:
        UsageFault: the value is none of these.
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
    """A Python number with a unit; a float stands for the shortest decimal that reads back as it.

    Raises:
        UsageFault: the value is not a finite number.
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
        UsageFault: the value is not a whole number, or is too small.
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
        UsageFault: the value is not a range.
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
    """A range, or the largest absolute value.

    Raises:
        UsageFault: the value is neither.
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
        UsageFault: the value is not a sequence of values.
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
    """The coordinates of a point or the components of a vector.

    Raises:
        UsageFault: the value is not a sequence of quantities.
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
    """The values without their unit and that unit, if all are numbers with the same unit."""
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
