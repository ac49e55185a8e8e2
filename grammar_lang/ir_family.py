"""Modules, grammars and semantics of the intermediate representation."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from grammar_lang.ir_expressions import NOWHERE, AttributeOf, Axis, Expr
from grammar_lang.source import Span

Role: TypeAlias = Literal["base", "joint", "link", "effector"]
DofKind: TypeAlias = Literal["revolute", "prismatic"]


@dataclass(frozen=True, slots=True)
class Interval:
    """A closed interval of constants (closed expressions, SI)."""

    lower: Expr
    upper: Expr


@dataclass(frozen=True, slots=True)
class Choices:
    """A finite set of constants, in the order written."""

    values: tuple[Expr, ...]


@dataclass(frozen=True, slots=True)
class Parameter:
    """A design parameter (an element of Xi, Definition 5); ``unit`` is its SI unit as text."""

    name: str
    domain: Interval | Choices
    unit: str
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Dof:
    """A degree of freedom about or along an axis of the local frame; None means unlimited."""

    name: str
    kind: DofKind
    axis: Axis
    range: Interval | None
    rate: Interval | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class State:
    """A state of a module's own and its derivative; ``unit`` is its SI unit as text.

    Without an ``initial`` value (closed, SI) it starts at zero.
    """

    name: str
    unit: str
    initial: Expr | None
    derivative: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Input:
    """A declared input with its bounds; ``unit`` is its SI unit as text."""

    name: str
    domain: Interval
    unit: str
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Torque:
    """The generalised force on a degree of freedom, instead of its free input alone."""

    dof: str
    value: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Module:
    """A robot module (an element of Sigma).  Its constants are inlined where they are used.

    ``states``, ``inputs`` and ``torques`` are its own dynamics (Definition 5); the module itself
    is the occurrence ``THIS`` there.
    """

    name: str
    role: Role
    parameters: tuple[Parameter, ...]
    dofs: tuple[Dof, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    states: tuple[State, ...] = ()
    inputs: tuple[Input, ...] = ()
    torques: tuple[Torque, ...] = ()


SymbolKind: TypeAlias = Literal["module", "edge", "nonterminal"]


@dataclass(frozen=True, slots=True)
class Symbol:
    """An occurrence of a symbol on a right side; ``alias`` is how its production calls it."""

    name: str
    kind: SymbolKind
    alias: str | None = None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Production:
    """``label: left -> right``; an empty right side derives the empty word."""

    label: str
    left: str
    right: tuple[Symbol, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class RSymbol:
    """A regular expression of one symbol."""

    name: str


@dataclass(frozen=True, slots=True)
class REmpty:
    """The regular expression of the empty word."""


@dataclass(frozen=True, slots=True)
class RSequence:
    """Juxtaposition."""

    parts: tuple[Regex, ...]


@dataclass(frozen=True, slots=True)
class RChoice:
    """Alternation ``|``."""

    parts: tuple[Regex, ...]


@dataclass(frozen=True, slots=True)
class RRepeat:
    """``*``, ``+`` or ``?``."""

    part: Regex
    mark: Literal["*", "+", "?"]


Regex: TypeAlias = RSymbol | REmpty | RSequence | RChoice | RRepeat
Comparison: TypeAlias = Literal["<=", "<", ">=", ">", "=="]


@dataclass(frozen=True, slots=True)
class Contains:
    """The word has ``word`` as a factor."""

    word: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class StartsWith:
    """The word has ``word`` as a prefix."""

    word: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class EndsWith:
    """The word has ``word`` as a suffix."""

    word: tuple[str, ...]


@dataclass(frozen=True, slots=True)
class Count:
    """The number of occurrences of a symbol; of all symbols where ``symbol`` is None."""

    symbol: str | None
    comparison: Comparison
    bound: int


@dataclass(frozen=True, slots=True)
class Matches:
    """The whole word matches a regular expression."""

    regex: Regex


@dataclass(frozen=True, slots=True)
class AllOf:
    """Conjunction; empty: every word."""

    parts: tuple[Accept, ...]


@dataclass(frozen=True, slots=True)
class AnyOf:
    """Disjunction."""

    parts: tuple[Accept, ...]


@dataclass(frozen=True, slots=True)
class NotAccept:
    """Complement."""

    part: Accept


Accept: TypeAlias = Contains | StartsWith | EndsWith | Count | Matches | AllOf | AnyOf | NotAccept


@dataclass(frozen=True, slots=True)
class AttributeRule:
    """``target = value``: synthesized where the target is ``THIS``, else inherited."""

    target: AttributeOf
    value: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Rod:
    """A uniform rod along an axis from the frame's origin; ``radius`` makes it a capsule."""

    frame: Expr
    axis: Axis
    length: Expr
    density: Expr
    radius: Expr | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class PointMass:
    """A point mass at the frame's origin."""

    frame: Expr
    mass: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Solid:
    """A rigid body; inertia about its com: one number in the plane, six (xx yy zz xy xz yz)."""

    frame: Expr
    mass: Expr
    com: Expr
    inertia: tuple[Expr, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Effector:
    """An effector at the frame's origin."""

    frame: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


Emission: TypeAlias = Rod | PointMass | Solid | Effector


@dataclass(frozen=True, slots=True)
class SemanticBlock:
    """The semantic rules of one production."""

    rules: tuple[AttributeRule, ...]
    emissions: tuple[Emission, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Grammar:
    """An SRG (Definition 3) with its accept condition and, where given, its semantics (FRG).

    ``nonterminals`` is in order of first appearance, the start symbol first.
    """

    name: str
    start: str
    nonterminals: tuple[str, ...]
    productions: tuple[Production, ...]
    accept: Accept
    semantics: Mapping[str, SemanticBlock] | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)
