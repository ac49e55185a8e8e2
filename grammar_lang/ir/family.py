"""Modules, grammars and semantics of the intermediate representation."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from grammar_lang.ir.emissions import Emission, Emitted, Visual
from grammar_lang.ir.expressions import NOWHERE, AttributeOf, Axis, EffortOf, Expr, leaves
from grammar_lang.source import Span, node

Role: TypeAlias = Literal["base", "joint", "link", "effector"]
DofKind: TypeAlias = Literal["revolute", "prismatic"]


@node
class Interval:
    """A closed interval of constants (closed expressions, SI)."""

    lower: Expr
    upper: Expr


@node
class Choices:
    """A finite set of constants, in the order written."""

    values: tuple[Expr, ...]


@node
class Parameter:
    """A design parameter (an element of Xi, Definition 5); ``unit`` is its SI unit as text."""

    name: str
    domain: Interval | Choices
    unit: str
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Dof:
    """A degree of freedom about or along an axis of the local frame; None means unlimited.

    ``effort`` bounds its free input.  ``inertia`` is the rotor inertia times the square of the gear
    ratio; it moves with this joint only.  ``accel`` bounds the absolute acceleration, ``coulomb``
    is the effort of dry friction, and ``gear`` is the gear ratio, which exports state.  All are
    closed and in SI units.  ``named`` is the name of its joint in exports, if it has its own.
    """

    name: str
    kind: DofKind
    axis: Axis
    range: Interval | None
    rate: Interval | None
    effort: Expr | None = None
    inertia: Expr | None = None
    accel: Expr | None = None
    coulomb: Expr | None = None
    gear: Expr | None = None
    named: str | None = None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class State:
    """A state of a module's own dynamics and its derivative; ``unit`` is its SI unit as text.

    Without an ``initial`` value (closed, SI) it starts at zero.
    """

    name: str
    unit: str
    initial: Expr | None
    derivative: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Input:
    """A declared input with its bounds; ``unit`` is its SI unit as text."""

    name: str
    domain: Interval
    unit: str
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Torque:
    """The generalised force on a degree of freedom, which replaces its free input."""

    dof: str
    value: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Module:
    """A robot module (an element of Sigma).  Its constants are inlined where they are used.

    ``states``, ``inputs`` and ``torques`` are its own dynamics (Definition 5), in which ``THIS`` is
    the module itself.  ``named`` is its name in exports, if it has its own.
    """

    name: str
    role: Role
    parameters: tuple[Parameter, ...]
    dofs: tuple[Dof, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    states: tuple[State, ...] = ()
    inputs: tuple[Input, ...] = ()
    torques: tuple[Torque, ...] = ()
    named: str | None = None

    @property
    def free_dofs(self) -> tuple[Dof, ...]:
        """The degrees of freedom with a free input ``u``: all but those whose torque needs none."""
        expressions = [state.derivative for state in self.states]
        expressions += [torque.value for torque in self.torques]
        found = [leaf for expression in expressions for leaf in leaves(expression)]
        read = {leaf.name for leaf in found if isinstance(leaf, EffortOf)}
        driven = {torque.dof for torque in self.torques} - read
        return tuple(dof for dof in self.dofs if dof.name not in driven)


SymbolKind: TypeAlias = Literal["module", "edge", "nonterminal"]


@node
class Symbol:
    """An occurrence of a symbol on a right side; ``alias`` is its own name there, if any."""

    name: str
    kind: SymbolKind
    alias: str | None = None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Production:
    """``label: left -> right``; an empty right side derives the empty word."""

    label: str
    left: str
    right: tuple[Symbol, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class RSymbol:
    """A regular expression of one symbol."""

    name: str


@node
class REmpty:
    """The regular expression of the empty word."""


@node
class RSequence:
    """Juxtaposition."""

    parts: tuple[Regex, ...]


@node
class RChoice:
    """Alternation ``|``."""

    parts: tuple[Regex, ...]


@node
class RRepeat:
    """``*``, ``+`` or ``?``."""

    part: Regex
    mark: Literal["*", "+", "?"]


Regex: TypeAlias = RSymbol | REmpty | RSequence | RChoice | RRepeat
Comparison: TypeAlias = Literal["<=", "<", ">=", ">", "=="]


@node
class Contains:
    """The word has ``word`` as a factor."""

    word: tuple[str, ...]


@node
class StartsWith:
    """The word has ``word`` as a prefix."""

    word: tuple[str, ...]


@node
class EndsWith:
    """The word has ``word`` as a suffix."""

    word: tuple[str, ...]


@node
class Count:
    """The number of occurrences of a symbol, or of all symbols if ``symbol`` is None."""

    symbol: str | None
    comparison: Comparison
    bound: int


@node
class Matches:
    """The whole word matches a regular expression."""

    regex: Regex


@node
class AllOf:
    """Conjunction; if empty, every word is accepted."""

    parts: tuple[Accept, ...]


@node
class AnyOf:
    """Disjunction."""

    parts: tuple[Accept, ...]


@node
class NotAccept:
    """Complement."""

    part: Accept


Accept: TypeAlias = Contains | StartsWith | EndsWith | Count | Matches | AllOf | AnyOf | NotAccept


@node
class AttributeRule:
    """``target = value``: synthesized if the target is ``THIS``, otherwise inherited.

    ``mentions`` are the occurrences of modules that the value names, in order of first mention.
    For an emission, they are those in its arguments other than the frame.
    """

    target: AttributeOf
    value: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    mentions: tuple[int, ...] = field(default=(), compare=False, repr=False)


def owners(production: Production, emission: Emission) -> tuple[int, ...]:
    """The positions of the modules on the right side that may own an emitted body.

    If the production has only one module, that one; otherwise the modules that its quantities name,
    or all of them if it names none.  Empty if the production has no module.
    """
    modules = tuple(i for i, x in enumerate(production.right) if x.kind == "module")
    return modules if len(modules) < 2 else emission.mentions or modules


@node
class SemanticBlock:
    """The semantic rules of one production.

    ``visuals`` are kept apart from the emissions: only drawing and exports use them.
    """

    rules: tuple[AttributeRule, ...]
    emissions: tuple[Emission, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    visuals: tuple[Visual, ...] = ()


def semantic_block(
    rules: Iterable[AttributeRule], emitted: Iterable[Emitted], span: Span
) -> SemanticBlock:
    """The semantic block of a production, with emissions and visuals separated, each in order."""
    emissions, visuals = list[Emission](), list[Visual]()
    for each in emitted:
        if isinstance(each, Visual):
            visuals.append(each)
        else:
            emissions.append(each)
    return SemanticBlock(tuple(rules), tuple(emissions), span, tuple(visuals))


@dataclass(frozen=True, slots=True)
class Grammar:
    """An SRG (Definition 3) with its accept condition and, if given, its semantics (FRG).

    ``nonterminals`` are in order of first appearance, the start symbol first.  ``listed`` are the
    modules that a grammar from ports names, whether or not they occur in a robot.
    """

    name: str
    start: str
    nonterminals: tuple[str, ...]
    productions: tuple[Production, ...]
    accept: Accept
    semantics: Mapping[str, SemanticBlock] | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    listed: frozenset[str] = field(default=frozenset(), compare=False, repr=False)
