"""Expressions of the intermediate representation: trees over exact rationals and pi."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from typing import Literal, TypeAlias

from grammar_lang.source import Span

THIS = -1
"""The occurrence of the left side; others are positions on the right side, from 0."""
NOWHERE = Span(0, 0)

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
    """The coordinate of a degree of freedom.

    In frames it stands alone in a ``rot`` or ``move``; a module's own dynamics may read it too.
    """

    occurrence: int
    name: str


@dataclass(frozen=True, slots=True)
class RateOf:
    """The rate of a degree of freedom; only in a module's own dynamics."""

    occurrence: int
    name: str


@dataclass(frozen=True, slots=True)
class EffortOf:
    """The free input ``u`` of a degree of freedom; only in a module's own dynamics."""

    occurrence: int
    name: str


@dataclass(frozen=True, slots=True)
class StateOf:
    """A state of the module's own; only in its dynamics."""

    occurrence: int
    name: str


@dataclass(frozen=True, slots=True)
class InputOf:
    """A declared input of the module; only in its dynamics."""

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
