"""The abstract syntax of expressions, intervals and sets of values.

Numbers are exact rationals with the text of their unit.  Nodes compare without their spans.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from fractions import Fraction
from typing import Literal, TypeAlias

from grammar_lang.source import Span

NOWHERE = Span(0, 0)


@dataclass(frozen=True, slots=True)
class Ident:
    """A name as written; ``this`` is the owner of a synthesized attribute."""

    text: str
    span: Span = field(default=NOWHERE, compare=False, repr=False)


Operator: TypeAlias = Literal["+", "-", "*", "/", "^"]


@dataclass(frozen=True, slots=True)
class Number:
    """A literal with an optional unit; ``value`` is None where it is too large to represent."""

    value: Fraction | None
    unit: Ident | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Name:
    """A plain name in an expression."""

    ident: Ident

    @property
    def span(self) -> Span:
        """Where it stands."""
        return self.ident.span


@dataclass(frozen=True, slots=True)
class AxisName:
    """``x``, ``y`` or ``z``: an axis, or a coordinate of the workspace."""

    axis: Literal["x", "y", "z"]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Member:
    """``owner.name``."""

    owner: Ident
    name: Ident
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class WorldName:
    """The fixed frame."""

    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Argument:
    """``expr`` or ``name: expr``."""

    name: Ident | None
    value: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Call:
    """``function(arguments)``."""

    function: Ident
    arguments: tuple[Argument, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Tuple:
    """``(a, b, …)``; the unit applies to the bare numbers."""

    items: tuple[Expr, ...]
    unit: Ident | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Scaled:
    """``(expr) unit``."""

    operand: Expr
    unit: Ident
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Negate:
    """``-expr``."""

    operand: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Binary:
    """``left operator right``."""

    operator: Operator
    left: Expr
    right: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


Expr: TypeAlias = (
    Number | Name | AxisName | Member | WorldName | Call | Tuple | Scaled | Negate | Binary
)


@dataclass(frozen=True, slots=True)
class Interval:
    """``[lower, upper] unit``."""

    lower: Expr
    upper: Expr
    unit: Ident | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Choices:
    """``{v1, v2, …} unit``."""

    values: tuple[Expr, ...]
    unit: Ident | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)
