"""Write expressions, conditions and formulas as text of the language; the parser's inverse.

Parentheses are written only where the grammar needs them.
"""

from __future__ import annotations

import re
from collections.abc import Iterable
from fractions import Fraction
from typing import assert_never

from grammar_lang import syntax as s
from grammar_lang.ir.expression_text import number_text
from grammar_lang.parsing.tables import RESERVED, tables
from grammar_lang.syntax import formulas as f

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_]*")

# --- names ----------------------------------------------------------------------------------------


def is_name(text: str) -> bool:
    """Whether a text is a name of the language."""
    return _NAME.fullmatch(text) is not None and text not in RESERVED


def symbol(ident: s.Ident) -> str:
    """A symbol of a word; quoted if it is not a name, or is a keyword of the language."""
    plain = is_name(ident.text) and ident.text not in tables().words
    return ident.text if plain else quoted(ident)


def quoted(ident: s.Ident) -> str:
    """A text in quotes; it must not contain both kinds of quote."""
    mark = "'" if '"' in ident.text else '"'
    return f"{mark}{ident.text}{mark}"


def word(symbols: Iterable[s.Ident]) -> str:
    """Symbols separated by spaces."""
    return " ".join(map(symbol, symbols))


def listed(names: Iterable[s.Ident]) -> str:
    """Names separated by commas."""
    return ", ".join(name.text for name in names)


# --- expressions ----------------------------------------------------------------------------------

_SUM, _PRODUCT, _FACTOR, _POWER, _ATOM = range(5)
_RANKS: dict[s.Operator, tuple[int, int, int]] = {
    "+": (_SUM, _SUM, _PRODUCT), "-": (_SUM, _SUM, _PRODUCT),
    "*": (_PRODUCT, _PRODUCT, _FACTOR), "/": (_PRODUCT, _PRODUCT, _FACTOR),
    "^": (_POWER, _ATOM, _FACTOR),
}  # fmt: skip
"""The rank of each operation, and the least ranks of its left and right operands."""


def expression(node: s.Expr, least: int = _SUM) -> str:
    """An expression, in parentheses if its rank is below ``least``.

    Raises:
        ValueError: a number in it was too large to be read.
    """
    text, rank = _ranked(node)
    return text if rank >= least else f"({text})"


def _ranked(node: s.Expr) -> tuple[str, int]:
    match node:
        case s.Number() | s.Scaled() | s.Tuple():
            # A unit would take the exponent if its number were the base of a power.
            return _atom(node), _ATOM if node.unit is None else _POWER
        case s.Binary(operator=operator, left=left, right=right):
            rank, before, behind = _RANKS[operator]
            sign = operator if operator == "^" else f" {operator} "
            return f"{expression(left, before)}{sign}{expression(right, behind)}", rank
        case s.Negate(operand=operand):
            return f"-{expression(operand, _FACTOR)}", _FACTOR
        case _:
            return _atom(node), _ATOM


def _atom(
    node: s.Number
    | s.Name
    | s.AxisName
    | s.Member
    | s.WorldName
    | s.Call
    | s.Tuple
    | s.Scaled
    | s.Text,
) -> str:
    match node:
        case s.Number(value=value, unit=unit):
            return f"{_digits(value)}{_behind(unit)}"
        case s.Name(ident=ident):
            return ident.text
        case s.AxisName(axis=axis):
            return axis
        case s.Member(owner=owner, name=name):
            return f"{owner.text}.{name.text}"
        case s.WorldName():
            return "world"
        case s.Call(function=function, arguments=given):
            return f"{function.text}({arguments(given)})"
        case s.Tuple(items=items, unit=unit):
            return row(items, unit)
        case s.Scaled(operand=operand, unit=unit):
            inner = expression(operand)
            inner = inner if isinstance(operand, s.Call) else f"({inner})"
            return f"{inner} {unit.text}"
        case s.Text(ident=ident):
            return quoted(ident)
        case _:
            assert_never(node)


def _digits(value: Fraction | None) -> str:
    if value is None:
        raise ValueError("this number is too large to be written")
    return number_text(value)


def arguments(given: Iterable[s.Argument]) -> str:
    """The arguments of a call or of an emission."""
    return ", ".join(
        f"{'' if each.name is None else f'{each.name.text}: '}{expression(each.value)}"
        for each in given
    )


def row(items: Iterable[s.Expr], unit: s.Ident | None) -> str:
    """Expressions in parentheses, followed by the unit."""
    return f"({', '.join(map(expression, items))}){_behind(unit)}"


def domain(node: s.Interval | s.Choices) -> str:
    """An interval, or a set of values."""
    inner = ", ".join(map(expression, _values(node)))
    inner = f"[{inner}]" if isinstance(node, s.Interval) else f"{{{inner}}}"
    return f"{inner}{_behind(node.unit)}"


def _values(node: s.Interval | s.Choices) -> tuple[s.Expr, ...]:
    return (node.lower, node.upper) if isinstance(node, s.Interval) else node.values


def _behind(unit: s.Ident | None) -> str:
    return "" if unit is None else f" {unit.text}"


def quantity(node: s.Expr) -> str:
    """A number with its unit and sign; any other expression is put in parentheses."""
    match node:
        case s.Number():
            return expression(node)
        case s.Negate(operand=operand):
            return f"-{quantity(operand)}"
        case s.Scaled(operand=operand, unit=unit):
            return f"({expression(operand)}) {unit.text}"
        case _:
            return f"({expression(node)})"


# --- conditions on words --------------------------------------------------------------------------

_PREPOSITIONS = {"contains": "contains", "starts": "starts with", "ends": "ends with"}


def condition(node: s.Condition, within: str = "") -> str:
    """A condition; ``within`` is the operator around it (``and``, ``or`` or ``not``) or empty."""
    match node:
        case s.Or(parts=parts):
            text, inner = " or ".join(condition(part, "or") for part in parts), within != ""
        case s.And(parts=parts):
            text, inner = " and ".join(condition(part, "and") for part in parts), within in _TIGHT
        case s.Not(part=part):
            text, inner = f"not {condition(part, 'not')}", False
        case s.Factor(where=where, word=symbols):
            text, inner = f"{_PREPOSITIONS[where]} {word(symbols)}", False
        case s.Count(symbol=counted, comparison=comparison, bound=bound):
            amount = "length" if counted is None else f"count({symbol(counted)})"
            text, inner = f"{amount} {comparison} {expression(bound)}", False
        case s.Matches(regex=pattern):
            text, inner = f"matches {regex(pattern)}", False
        case _:
            assert_never(node)
    return f"({text})" if inner else text


_TIGHT = frozenset({"and", "not"})


def regex(node: s.Regex, least: int = 0) -> str:
    """A regular expression, in parentheses if its rank is below ``least``.

    A choice has rank 0, a sequence 1, a repetition 2, a symbol 3.
    """
    match node:
        case s.RegexChoice(parts=parts):
            text, rank = " | ".join(regex(part, 1) for part in parts), 0
        case s.RegexSequence(parts=parts):
            text, rank = " ".join(regex(part, 2) for part in parts), 1
        case s.RegexRepeat(part=part, mark=mark):
            text, rank = f"{regex(part, 3)}{mark}", 2
        case s.RegexSymbol(symbol=ident):
            text, rank = symbol(ident), 3
        case s.RegexEmpty():
            text, rank = "empty", 3
        case _:
            assert_never(node)
    return text if rank >= least else f"({text})"


# --- poses and formulas ---------------------------------------------------------------------------


def effector(number: s.Expr | None) -> str:
    """`` by effector n``, or nothing."""
    return "" if number is None else f" by effector {expression(number)}"


def pose(node: f.Pose) -> str:
    """A pose, with a space before it."""
    match node:
        case f.Aligned(axis=axis, direction=direction, unit=unit, within=within):
            return f" aligned {axis} to {row(direction, unit)} within {expression(within)}"
        case f.Oriented(frame=frame, within=within):
            return f" oriented {expression(frame)} within {expression(within)}"
        case _:
            assert_never(node)


_IMPLIES, _OR, _AND, _UNTIL, _UNARY = range(5)


def formula(node: f.Formula, least: int = _IMPLIES) -> str:
    """A formula, in parentheses if its rank is below ``least``."""
    match node:
        case f.Binary(operator="implies", left=left, right=right):
            text, rank = f"{formula(left, _OR)} implies {formula(right)}", _IMPLIES
        case f.Binary(left=left, right=right):
            text, rank = f"{formula(left, _UNARY)} until {formula(right, _UNTIL)}", _UNTIL
        case f.Joined(operator=operator, operands=operands):
            rank = _OR if operator == "or" else _AND
            text = f" {operator} ".join(formula(each, rank + 1) for each in operands)
        case f.Unary(operator=operator, operand=operand, window=window):
            text, rank = f"{operator}{_window(window)} {formula(operand, _UNARY)}", _UNARY
        case f.Last(duration=duration, operand=operand):
            text, rank = f"last[{expression(duration)}] {formula(operand, _UNARY)}", _UNARY
        case f.Atom(region=region, effector=number, poses=poses):
            text, rank = f"{region.text}{effector(number)}{''.join(map(pose, poses))}", _UNARY
        case _:
            assert_never(node)
    return text if rank >= least else f"({text})"


def _window(node: f.Window | None) -> str:
    if node is None:
        return ""
    return f"[{expression(node.lower)}, {expression(node.upper)}]"
