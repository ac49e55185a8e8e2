"""The abstract syntax of modules, grammars and semantics: one node class per rule.

Nothing is resolved here: names are text with a span.  Comparison of nodes ignores their spans.
"""

from __future__ import annotations

from dataclasses import field
from typing import Literal, TypeAlias

from grammar_lang.source import Span, node
from grammar_lang.syntax.expressions import (
    NOWHERE,
    Argument,
    Choices,
    Expr,
    Ident,
    Interval,
    Member,
    bounds,
)

# --- modules -----------------------------------------------------------------------------------


@node
class Role:
    """``role NAME;``."""

    name: Ident
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Named:
    """``named "text";``: the name of the part in exports."""

    text: Ident
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Param:
    """``param NAME in domain;``."""

    name: Ident
    domain: Interval | Choices
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Const:
    """``const NAME = expr;``."""

    name: Ident
    value: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Dof:
    """``dof NAME: kind axis in interval rate in interval accel <= v effort <= v named "text";``."""

    name: Ident
    kind: Literal["revolute", "prismatic"]
    axis: Literal["x", "y", "z", "-x", "-y", "-z"]
    range: Interval | None
    rate: Interval | None
    accel: Expr | None
    effort: Expr | None
    named: Ident | None = None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class DrivePart:
    """``gear expr``, ``rotor expr``, ``viscous expr`` or ``coulomb expr``."""

    kind: Literal["gear", "rotor", "viscous", "coulomb"]
    value: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Drive:
    """``drive NAME: part …;``."""

    name: Ident
    parts: tuple[DrivePart, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class State:
    """``state NAME unit = initial;``."""

    name: Ident
    unit: Ident | None
    initial: Expr | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Input:
    """``input NAME in [lo, hi] unit;``."""

    name: Ident
    domain: Interval
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Derivative:
    """``der(NAME) = expr;``."""

    name: Ident
    value: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Torque:
    """``torque(NAME) = expr;``."""

    name: Ident
    value: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Frame:
    """``frame NAME = expr;``."""

    name: Ident
    value: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Port:
    """``port NAME: TYPE gender;``."""

    name: Ident
    type: Ident
    gender: Literal["male", "female"] | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Emission:
    """``kind(argument: expr, …);``."""

    kind: Ident
    arguments: tuple[Argument, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


Dynamics: TypeAlias = Drive | State | Input | Derivative | Torque
ModuleItem: TypeAlias = Role | Named | Param | Const | Dof | Dynamics | Frame | Port | Emission


def module_expressions(item: ModuleItem) -> tuple[Expr, ...]:
    """The expressions in a statement of a module."""
    match item:
        case Param(domain=domain) | Input(domain=domain):
            return bounds(domain)
        case Const(value=value) | Derivative(value=value) | Torque(value=value):
            return (value,)
        case Frame(value=value):
            return (value,)
        case Emission(arguments=arguments):
            return tuple(argument.value for argument in arguments)
        case Dof(range=ranged, rate=rate, accel=accel, effort=effort):
            largest = tuple(bound for bound in (accel, effort) if bound is not None)
            return (*bounds(ranged), *bounds(rate), *largest)
        case Drive(parts=parts):
            return tuple(part.value for part in parts)
        case State(initial=initial):
            return () if initial is None else (initial,)
        case Role() | Named() | Port():
            return ()


@node
class Module:
    """``module NAME { … }``."""

    name: Ident
    items: tuple[ModuleItem, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


def owns_body(module: Module) -> bool:
    """Whether a module has frames, ports or emissions of its own."""
    return any(isinstance(item, Frame | Port | Emission) for item in module.items)


@node
class Edges:
    """``edge a, '[';``."""

    names: tuple[Ident, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


# --- grammars ----------------------------------------------------------------------------------


@node
class StartSymbol:
    """``start NAME;``."""

    name: Ident
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Occurrence:
    """A symbol on a right side, with its alias if it has one."""

    alias: Ident | None
    symbol: Ident


@node
class Production:
    """``label: left -> right;``."""

    label: Ident
    left: Ident
    right: tuple[Occurrence, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class RegexSymbol:
    """One symbol."""

    symbol: Ident


@node
class RegexEmpty:
    """``empty``."""


@node
class RegexSequence:
    """Juxtaposition."""

    parts: tuple[Regex, ...]


@node
class RegexChoice:
    """Alternation."""

    parts: tuple[Regex, ...]


@node
class RegexRepeat:
    """``*``, ``+`` or ``?``."""

    part: Regex
    mark: Literal["*", "+", "?"]


Regex: TypeAlias = RegexSymbol | RegexEmpty | RegexSequence | RegexChoice | RegexRepeat
Comparison: TypeAlias = Literal["<=", "<", ">=", ">", "=="]


@node
class Factor:
    """``contains``, ``starts with`` or ``ends with`` a word."""

    where: Literal["contains", "starts", "ends"]
    word: tuple[Ident, ...]


@node
class Count:
    """``count(SYM) <= expr``; without a symbol: ``length <= expr``."""

    symbol: Ident | None
    comparison: Comparison
    bound: Expr


@node
class Matches:
    """``matches REGEX``."""

    regex: Regex


@node
class Not:
    """Negation."""

    part: Condition


@node
class And:
    """Conjunction."""

    parts: tuple[Condition, ...]


@node
class Or:
    """Disjunction."""

    parts: tuple[Condition, ...]


Condition: TypeAlias = Factor | Count | Matches | Not | And | Or


@node
class Accept:
    """``accept condition;``."""

    condition: Condition
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Listed:
    """``with NAME, …;``: the modules of a grammar from ports."""

    names: tuple[Ident, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


GrammarItem: TypeAlias = StartSymbol | Listed | Production | Accept


@node
class Grammar:
    """``grammar NAME { … }``, or ``grammar NAME from ports { … }``."""

    name: Ident
    items: tuple[GrammarItem, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    from_ports: bool = False


# --- semantics ---------------------------------------------------------------------------------


@node
class Rule:
    """``owner.name = expr;``."""

    target: Member
    value: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Let:
    """``let NAME = expr;``."""

    name: Ident
    value: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


def statement_expressions(statement: Rule | Emission | Let) -> tuple[Expr, ...]:
    """The expressions in a statement of a semantic block."""
    match statement:
        case Rule(value=value) | Let(value=value):
            return (value,)
        case Emission(arguments=arguments):
            return tuple(argument.value for argument in arguments)


@node
class Block:
    """``label { … }``."""

    label: Ident
    statements: tuple[Rule | Emission | Let, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Semantics:
    """``semantics NAME { … }``."""

    grammar: Ident
    blocks: tuple[Block, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)
