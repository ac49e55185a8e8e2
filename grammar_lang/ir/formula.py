"""Formulas of the intermediate representation: linear temporal logic on the finite trace [0, T].

They speak of where effectors are, and of how their frames are turned there.

Times are exact, in seconds.  Windows are closed and relative to the instant where the formula is
evaluated; whatever of them lies after T is cut off.
"""

from __future__ import annotations

from dataclasses import field
from fractions import Fraction
from typing import TypeAlias

from grammar_lang.ir.expressions import NOWHERE, Axis, Expr
from grammar_lang.source import Span, node


@node
class Aligned:
    """An axis of an effector's frame points along a direction of the world, ``within`` an angle.

    The direction is not zero, the angle closed, in rad and between 0 and a half turn.
    """

    axis: Axis
    direction: tuple[Fraction, ...]
    within: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Oriented:
    """An effector's frame is turned from the world's by ``turns``, ``within`` an angle.

    Turns are about axes of the frame, one after the other, by closed angles in rad; the angle is
    that of the rotation between both frames, between 0 and a half turn.
    """

    turns: tuple[tuple[Axis, Expr], ...]
    within: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


Pose: TypeAlias = Aligned | Oriented


@node
class Atom:
    """The ``effector``-th effector (from 1, in word order) is in the region, in all ``poses``.

    ``numbered`` says that the number is written; a plain region is the only effector's.
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
    """Conjunction of two or more."""

    operands: tuple[Formula, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Or:
    """Disjunction of two or more."""

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
    """Strong: ``right`` holds at some instant from now on, ``left`` at all instants before it."""

    left: Formula
    right: Formula
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Window:
    """The instants from ``lower`` to ``upper`` seconds after the present one; None: to the end."""

    lower: Fraction
    upper: Fraction | None


@node
class Always:
    """At every instant of the window."""

    operand: Formula
    window: Window
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Eventually:
    """At some instant of the window."""

    operand: Formula
    window: Window
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Next:
    """One step of the horizon later; false at the last instant."""

    operand: Formula
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Last:
    """Throughout the last ``duration`` seconds, [T - duration, T]."""

    duration: Fraction
    operand: Formula
    span: Span = field(default=NOWHERE, compare=False, repr=False)


Formula: TypeAlias = Atom | Not | And | Or | Implies | Until | Always | Eventually | Next | Last
