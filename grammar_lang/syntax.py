"""The abstract syntax of a file: one frozen dataclass per rule of ``srg.lark``.

Nothing is resolved here: names are text with a span, numbers are exact rationals with the text of
their unit.  Nodes compare without their spans.
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


# --- expressions -------------------------------------------------------------------------------

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


# --- modules -----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Unsupported:
    """A construct of the language that this version recognises and refuses."""

    what: str
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Role:
    """``role NAME;``."""

    name: Ident
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Param:
    """``param NAME in domain;``."""

    name: Ident
    domain: Interval | Choices
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Const:
    """``const NAME = expr;``."""

    name: Ident
    value: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Dof:
    """``dof NAME: kind axis in interval rate in interval;``."""

    name: Ident
    kind: Literal["revolute", "prismatic"]
    axis: Literal["x", "y", "z", "-x", "-y", "-z"]
    range: Interval | None
    rate: Interval | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


ModuleItem: TypeAlias = Role | Param | Const | Dof | Unsupported


@dataclass(frozen=True, slots=True)
class Module:
    """``module NAME { … }``."""

    name: Ident
    items: tuple[ModuleItem, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Edges:
    """``edge a, '[';``."""

    names: tuple[Ident, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


# --- grammars ----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class StartSymbol:
    """``start NAME;``."""

    name: Ident
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Occurrence:
    """A symbol of a right side, with the name given to it."""

    alias: Ident | None
    symbol: Ident


@dataclass(frozen=True, slots=True)
class Production:
    """``label: left -> right;``."""

    label: Ident
    left: Ident
    right: tuple[Occurrence, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class RegexSymbol:
    """One symbol."""

    symbol: Ident


@dataclass(frozen=True, slots=True)
class RegexEmpty:
    """``empty``."""


@dataclass(frozen=True, slots=True)
class RegexSequence:
    """Juxtaposition."""

    parts: tuple[Regex, ...]


@dataclass(frozen=True, slots=True)
class RegexChoice:
    """Alternation."""

    parts: tuple[Regex, ...]


@dataclass(frozen=True, slots=True)
class RegexRepeat:
    """``*``, ``+`` or ``?``."""

    part: Regex
    mark: Literal["*", "+", "?"]


Regex: TypeAlias = RegexSymbol | RegexEmpty | RegexSequence | RegexChoice | RegexRepeat
Comparison: TypeAlias = Literal["<=", "<", ">=", ">", "=="]


@dataclass(frozen=True, slots=True)
class Factor:
    """``contains``, ``starts with`` or ``ends with`` a word."""

    where: Literal["contains", "starts", "ends"]
    word: tuple[Ident, ...]


@dataclass(frozen=True, slots=True)
class Count:
    """``count(SYM) <= expr``; without a symbol: ``length <= expr``."""

    symbol: Ident | None
    comparison: Comparison
    bound: Expr


@dataclass(frozen=True, slots=True)
class Matches:
    """``matches REGEX``."""

    regex: Regex


@dataclass(frozen=True, slots=True)
class Not:
    """Negation."""

    part: Condition


@dataclass(frozen=True, slots=True)
class And:
    """Conjunction."""

    parts: tuple[Condition, ...]


@dataclass(frozen=True, slots=True)
class Or:
    """Disjunction."""

    parts: tuple[Condition, ...]


Condition: TypeAlias = Factor | Count | Matches | Not | And | Or


@dataclass(frozen=True, slots=True)
class Accept:
    """``accept condition;``."""

    condition: Condition
    span: Span = field(default=NOWHERE, compare=False, repr=False)


GrammarItem: TypeAlias = StartSymbol | Production | Accept


@dataclass(frozen=True, slots=True)
class Grammar:
    """``grammar NAME { … }``."""

    name: Ident
    items: tuple[GrammarItem, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


# --- semantics ---------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Rule:
    """``owner.name = expr;``."""

    target: Member
    value: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Emission:
    """``kind(argument: expr, …);``."""

    kind: Ident
    arguments: tuple[Argument, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Block:
    """``label { … }``."""

    label: Ident
    statements: tuple[Rule | Emission, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Semantics:
    """``semantics NAME { … }``."""

    grammar: Ident
    blocks: tuple[Block, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)
