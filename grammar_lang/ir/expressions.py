"""Expressions of the intermediate representation: trees over exact rationals and pi.

The ``mentions`` of a frame step are the occurrences of modules whose coordinates, parameters or
constants its arguments name, in order of first mention.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import field
from fractions import Fraction
from typing import Literal, TypeAlias

from grammar_lang.source import Span, node

THIS = -1
"""The occurrence of the left side; the others are positions on the right side, from 0."""
LOCAL = -2
"""The occurrence of the local values of a production, and of a module's own frames."""
NOWHERE = Span(0, 0)

Function: TypeAlias = Literal["neg", "abs", "sqrt", "sin", "cos", "tan"]
Operator: TypeAlias = Literal["+", "-", "*", "/", "^"]
Axis: TypeAlias = Literal["x", "y", "z", "-x", "-y", "-z"]


@node
class Num:
    """An exact rational, in SI units."""

    value: Fraction


@node
class Pi:
    """The number pi."""


@node
class ParameterOf:
    """A parameter of the module at an occurrence."""

    occurrence: int
    name: str


@node
class DofOf:
    """The coordinate of a degree of freedom.

    In a frame it is the whole argument of a ``rot`` or ``move``; a module's own dynamics may read
    it too.
    """

    occurrence: int
    name: str


@node
class RateOf:
    """The rate of a degree of freedom; only in a module's own dynamics."""

    occurrence: int
    name: str


@node
class EffortOf:
    """The free input ``u`` of a degree of freedom; only in a module's own dynamics."""

    occurrence: int
    name: str


@node
class StateOf:
    """A state of the module itself; only in its dynamics."""

    occurrence: int
    name: str


@node
class InputOf:
    """A declared input of the module; only in its dynamics."""

    occurrence: int
    name: str


@node
class AttributeOf:
    """An attribute of a nonterminal or of the left side (``THIS``), or a local value.

    A ``LOCAL`` value is defined in the block that reads it: ``f`` of a ``let``, or a frame of a
    mounted module, such as ``Elbow.out``.
    """

    occurrence: int
    name: str


@node
class Unary:
    """A function of one scalar."""

    function: Function
    operand: Expr


@node
class Binary:
    """An operation on two scalars; the exponent of ``^`` is an integer ``Num``."""

    operator: Operator
    left: Expr
    right: Expr


@node
class Vector:
    """Three scalars; in the plane the third is zero."""

    x: Expr
    y: Expr
    z: Expr


@node
class World:
    """The fixed frame."""


@node
class Rot:
    """Rotation about an axis of the local frame by a scalar, or by one revolute dof."""

    axis: Axis
    angle: Expr
    mentions: tuple[int, ...] = field(default=(), compare=False, repr=False)


@node
class Move:
    """Translation along an axis of the local frame by a scalar, or by one prismatic dof."""

    axis: Axis
    distance: Expr
    mentions: tuple[int, ...] = field(default=(), compare=False, repr=False)


@node
class Shift:
    """Translation by a vector of the local frame."""

    vector: Expr
    mentions: tuple[int, ...] = field(default=(), compare=False, repr=False)


@node
class Compose:
    """The product of two frames; the left one is applied first (from the world outwards)."""

    left: Expr
    right: Expr


Expr: TypeAlias = (
    Num
    | Pi
    | ParameterOf
    | DofOf
    | RateOf
    | EffortOf
    | StateOf
    | InputOf
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


def leaves(expression: Expr) -> Iterator[Expr]:
    """The leaves of a scalar expression, from left to right."""
    todo: list[Expr] = [expression]
    while todo:
        current = todo.pop()
        match current:
            case Unary(_, operand):
                todo.append(operand)
            case Binary(_, left, right):
                todo += [right, left]
            case _:
                yield current


def factors(expr: Expr) -> Iterator[Expr]:
    """The factors of a product of frames, from the left; any other expression is its own factor."""
    todo = [expr]
    while todo:
        current = todo.pop()
        if isinstance(current, Compose):
            todo += [current.right, current.left]
        else:
            yield current


def with_leaves(
    expr: Expr, change: Callable[[Expr], Expr], mentions: tuple[int, ...] | None = None
) -> Expr:
    """An expression with every leaf replaced.

    Args:
        expr: the expression.
        change: maps a leaf to its replacement.
        mentions: if given, the new mentions of all frame steps.
    """

    def new(part: Expr) -> Expr:
        return with_leaves(part, change, mentions)

    match expr:
        case Unary(function, operand):
            return Unary(function, new(operand))
        case Binary(operator, left, right):
            return Binary(operator, new(left), new(right))
        case Vector(x, y, z):
            return Vector(new(x), new(y), new(z))
        case Rot(axis, angle, own):
            return Rot(axis, new(angle), own if mentions is None else mentions)
        case Move(axis, distance, own):
            return Move(axis, new(distance), own if mentions is None else mentions)
        case Shift(vector, own):
            return Shift(new(vector), own if mentions is None else mentions)
        case Compose(left, right):
            return Compose(new(left), new(right))
        case _:
            return change(expr)


# --- Depth and size -------------------------------------------------------------------------------

MAX_DEPTH = 120
MAX_NODES = 20_000
"""Bounds on expressions, so that all later traversals may be recursive."""


def children(expr: Expr) -> tuple[Expr, ...]:
    """The direct subexpressions of an expression."""
    match expr:
        case Unary(operand=part) | Rot(angle=part) | Move(distance=part):
            return (part,)
        case Shift(vector=part):
            return (part,)
        case Binary(left=left, right=right) | Compose(left=left, right=right):
            return (left, right)
        case Vector(x=x, y=y, z=z):
            return (x, y, z)
        case _:
            return ()


def too_large(expr: Expr) -> bool:
    """Whether an expression exceeds ``MAX_DEPTH`` or, counted as a tree, ``MAX_NODES``."""
    stack = [(expr, 0)]
    seen = 0
    while stack:
        node, depth = stack.pop()
        seen += 1
        if depth > MAX_DEPTH or seen > MAX_NODES:
            return True
        stack.extend((child, depth + 1) for child in children(node))
    return False
