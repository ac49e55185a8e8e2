"""Formulas of the intermediate representation: linear temporal logic on the finite trace [0, T].

They state where effectors are and how their frames are oriented.

Times are exact, in seconds.  Windows are closed and relative to the instant at which the formula is
evaluated; the part of a window after T is cut off.
"""

from __future__ import annotations

from dataclasses import field
from fractions import Fraction
from typing import TypeAlias

from grammar_lang.ir.expressions import NOWHERE, Axis, Expr
from grammar_lang.source import Span, node


@node
class Aligned:
    """An axis of an effector's frame is within an angle of a direction of the world.

    The direction is not zero.  The angle ``within`` is closed, in rad and between 0 and a half
    turn.
    """

    axis: Axis
    direction: tuple[Fraction, ...]
    within: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Oriented:
    """An effector's frame is within an angle of the world's frame rotated by ``turns``.

    The turns are about axes of the rotated frame, one after the other, by closed angles in rad.
    ``within`` bounds the angle of the rotation between the two frames; it is between 0 and a half
    turn.
    """

    turns: tuple[tuple[Axis, Expr], ...]
    within: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


Pose: TypeAlias = Aligned | Oriented


@node
class Atom:
    """The ``effector``-th effector (from 1, in word order) is in the region, with all ``poses``.

    ``numbered`` is whether the number is written; a region without it means the only effector.
    """

    region: str
    effector: int
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    numbered: bool = field(default=True, compare=False, repr=False)
    poses: tuple[Pose, ...] = ()


@node
class Not:
    """Negation."""

    operand: Formula
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class And:
    """Conjunction of two or more operands."""

    operands: tuple[Formula, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Or:
    """Disjunction of two or more operands."""

    operands: tuple[Formula, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Implies:
    """``left`` is false or ``right`` is true."""

    left: Formula
    right: Formula
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Until:
    """Strong until: ``right`` holds at some instant from now on, ``left`` at all before it."""

    left: Formula
    right: Formula
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Window:
    """The instants from ``lower`` to ``upper`` seconds from now; ``upper`` is None for the end."""

    lower: Fraction
    upper: Fraction | None


@node
class Always:
    """The operand holds at every instant of the window."""

    operand: Formula
    window: Window
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Eventually:
    """The operand holds at some instant of the window."""

    operand: Formula
    window: Window
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Next:
    """The operand holds one step of the horizon later; false at the last instant."""

    operand: Formula
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Last:
    """The operand holds throughout the last ``duration`` seconds, [T - duration, T]."""

    duration: Fraction
    operand: Formula
    span: Span = field(default=NOWHERE, compare=False, repr=False)


Formula: TypeAlias = Atom | Not | And | Or | Implies | Until | Always | Eventually | Next | Last
