"""The typed intermediate representation: names resolved, units converted to SI, spans kept.

Every node is frozen and compares without its span.  Expressions are trees over exact rationals
and pi; nothing is rounded here.  An *occurrence* is the position of a symbol on the right side of
its production, counted from 0; ``THIS`` stands for the left side.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from fractions import Fraction
from typing import Literal, TypeAlias

from grammar_lang.source import Source, Span

THIS = -1
NOWHERE = Span(0, 0)


# --- expressions -------------------------------------------------------------------------------

Function: TypeAlias = Literal["neg", "abs", "sqrt", "sin", "cos", "tan"]
Operator: TypeAlias = Literal["+", "-", "*", "/", "^"]
Axis: TypeAlias = Literal["x", "y", "z", "-x", "-y", "-z"]


@dataclass(frozen=True, slots=True)
class Num:
    """An exact rational, in SI units."""

    value: Fraction


@dataclass(frozen=True, slots=True)
class Pi:
    """The number pi."""


@dataclass(frozen=True, slots=True)
class ParameterOf:
    """A parameter of the module at an occurrence."""

    occurrence: int
    name: str


@dataclass(frozen=True, slots=True)
class DofOf:
    """The coordinate of a degree of freedom; stands alone in a ``rot`` or ``move``."""

    occurrence: int
    name: str


@dataclass(frozen=True, slots=True)
class AttributeOf:
    """An attribute of a nonterminal occurrence, or of the left side (``THIS``)."""

    occurrence: int
    name: str


@dataclass(frozen=True, slots=True)
class Unary:
    """A function of one scalar."""

    function: Function
    operand: Expr


@dataclass(frozen=True, slots=True)
class Binary:
    """An operation on two scalars; the exponent of ``^`` is an integer ``Num``."""

    operator: Operator
    left: Expr
    right: Expr


@dataclass(frozen=True, slots=True)
class Vector:
    """Three scalars; in the plane the third is zero."""

    x: Expr
    y: Expr
    z: Expr


@dataclass(frozen=True, slots=True)
class World:
    """The fixed frame."""


@dataclass(frozen=True, slots=True)
class Rot:
    """Rotation about an axis of the local frame; the angle is a scalar or one revolute dof."""

    axis: Axis
    angle: Expr


@dataclass(frozen=True, slots=True)
class Move:
    """Translation along an axis of the local frame; a scalar or one prismatic dof."""

    axis: Axis
    distance: Expr


@dataclass(frozen=True, slots=True)
class Shift:
    """Translation by a vector of the local frame."""

    vector: Expr


@dataclass(frozen=True, slots=True)
class Compose:
    """The product of two frames, left applied first (from the world outwards)."""

    left: Expr
    right: Expr


Expr: TypeAlias = (
    Num
    | Pi
    | ParameterOf
    | DofOf
    | AttributeOf
    | Unary
    | Binary
    | Vector
    | World
    | Rot
    | Move
    | Shift
    | Compose
)


# --- modules -----------------------------------------------------------------------------------

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
class Module:
    """A robot module (an element of Sigma).  Its constants are inlined where they are used."""

    name: str
    role: Role
    parameters: tuple[Parameter, ...]
    dofs: tuple[Dof, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


# --- grammars ----------------------------------------------------------------------------------

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


Accept: TypeAlias = (
    Contains | StartsWith | EndsWith | Count | Matches | AllOf | AnyOf | NotAccept
)


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


# --- workspaces --------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class HalfSpace:
    """``normal . p <= offset``, exact, in metres; ``span`` is where it is written."""

    normal: tuple[Fraction, ...]
    offset: Fraction
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Inequalities:
    """A closed convex polyhedron as an intersection of half-spaces."""

    rows: tuple[HalfSpace, ...]


@dataclass(frozen=True, slots=True)
class Hull:
    """The convex hull of points."""

    points: tuple[tuple[Fraction, ...], ...]


RegionKind: TypeAlias = Literal["bounds", "region", "obstacle", "target"]


@dataclass(frozen=True, slots=True)
class Region:
    """A named closed convex set of the workspace."""

    name: str
    kind: RegionKind
    shape: Inequalities | Hull
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Workspace:
    """Bounds and regions in the plane (dimension 2) or in space (3), regions as declared."""

    name: str
    dimension: Literal[2, 3]
    bounds: Region
    regions: tuple[Region, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)

    def region(self, name: str) -> Region:
        """The region of that name; KeyError if there is none."""
        for region in self.regions:
            if region.name == name:
                return region
        raise KeyError(name)


# --- tasks -------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class StartIn:
    """Start with some effector in a region; all rates at most ``rates`` (0: at rest)."""

    region: str
    effector: int | None
    rates: Fraction
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class StartAt:
    """Start at rest with one given value per degree of freedom, in word order."""

    values: tuple[Expr, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Reach:
    """Some effector (or the ``effector``-th, from 1) is in the region at the final instant."""

    region: str
    effector: int | None
    at_rest: bool
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Avoid:
    """All effectors, or the whole body, stay out of the regions by more than ``margin`` metres."""

    regions: tuple[str, ...]
    subject: Literal["effector", "body"]
    margin: Fraction
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Effort:
    """A bound on every free input of a kind; ``norm2`` bounds their Euclidean norm instead."""

    kind: DofKind
    bound: Fraction
    norm2: bool
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Task:
    """A problem: a robot family, a workspace, and what is to be done in how many steps."""

    name: str
    grammar: str
    workspace: str
    start: StartIn | StartAt
    reach: Reach
    avoid: tuple[Avoid, ...]
    effort: tuple[Effort, ...]
    steps: int
    step: Fraction
    slack: Fraction
    gravity: tuple[Fraction, ...]
    modules: int | None
    bounds_body: bool
    span: Span = field(default=NOWHERE, compare=False, repr=False)


# --- programs ----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Program:
    """A whole file.  ``terminals``: modules and edges in order of declaration."""

    modules: Mapping[str, Module]
    terminals: tuple[str, ...]
    grammars: Mapping[str, Grammar]
    workspaces: Mapping[str, Workspace]
    tasks: Mapping[str, Task]
    sources: tuple[Source, ...] = field(compare=False, repr=False)

    def is_module(self, name: str) -> bool:
        """Whether a terminal is a module (and not an edge)."""
        return name in self.modules
