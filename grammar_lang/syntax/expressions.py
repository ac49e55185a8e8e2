"""The abstract syntax of expressions, intervals and sets of values.

Numbers are exact rationals with the text of their unit.  Comparison of nodes ignores their spans.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import field
from fractions import Fraction
from typing import Literal, TypeAlias

from grammar_lang.source import Span, node

NOWHERE = Span(0, 0)


@node
class Ident:
    """A name as written; ``this`` denotes the owner of a synthesized attribute."""

    text: str
    span: Span = field(default=NOWHERE, compare=False, repr=False)


Operator: TypeAlias = Literal["+", "-", "*", "/", "^"]


@node
class Number:
    """A literal with an optional unit; ``value`` is None if it is too large to represent."""

    value: Fraction | None
    unit: Ident | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Name:
    """A plain name in an expression."""

    ident: Ident

    @property
    def span(self) -> Span:
        """The span of the name."""
        return self.ident.span


@node
class AxisName:
    """``x``, ``y`` or ``z``: an axis, or a coordinate of the workspace."""

    axis: Literal["x", "y", "z"]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Member:
    """``owner.name``."""

    owner: Ident
    name: Ident
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class WorldName:
    """``world``: the fixed frame."""

    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Text:
    """``"…"``: the path of a file, as an argument."""

    ident: Ident
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Argument:
    """``expr``, ``name: expr`` or ``name: "…"``."""

    name: Ident | None
    value: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Call:
    """``function(arguments)``."""

    function: Ident
    arguments: tuple[Argument, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Tuple:
    """``(a, b, …)``; the unit applies to the bare numbers."""

    items: tuple[Expr, ...]
    unit: Ident | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Scaled:
    """``(expr) unit``."""

    operand: Expr
    unit: Ident
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Negate:
    """``-expr``."""

    operand: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Binary:
    """``left operator right``."""

    operator: Operator
    left: Expr
    right: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


Expr: TypeAlias = (
    Number | Name | AxisName | Member | WorldName | Call | Tuple | Scaled | Negate | Binary | Text
)


@node
class Interval:
    """``[lower, upper] unit``."""

    lower: Expr
    upper: Expr
    unit: Ident | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Choices:
    """``{v1, v2, …} unit``."""

    values: tuple[Expr, ...]
    unit: Ident | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


# --- names in expressions ---------------------------------------------------------------------


def readings(expressions: Iterable[Expr]) -> Iterator[Name | Member]:
    """Every ``name`` and every ``owner.name`` in the expressions, found without recursion."""
    stack = list(expressions)
    while stack:
        match stack.pop():
            case Name() | Member() as found:
                yield found
            case Call(arguments=arguments):
                stack.extend(argument.value for argument in arguments)
            case Tuple(items=items):
                stack.extend(items)
            case Scaled(operand=operand) | Negate(operand=operand):
                stack.append(operand)
            case Binary(left=left, right=right):
                stack.extend((left, right))
            case Number() | AxisName() | WorldName() | Text():
                pass


def bounds(domain: Interval | Choices | None) -> tuple[Expr, ...]:
    """The expressions of an interval or of a set of values."""
    match domain:
        case Interval(lower=lower, upper=upper):
            return lower, upper
        case Choices(values=values):
            return values
        case None:
            return ()
