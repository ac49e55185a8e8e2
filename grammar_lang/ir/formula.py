"""Formulas of the intermediate representation: linear temporal logic on the finite trace [0, T].

Times are exact, in seconds.  Windows are closed and relative to the instant where the formula is
evaluated; whatever of them lies after T is cut off.
"""

from __future__ import annotations

from dataclasses import field
from fractions import Fraction
from typing import TypeAlias

from grammar_lang.ir.expressions import NOWHERE
from grammar_lang.source import Span, node


@node
class Atom:
    """The ``effector``-th effector (from 1, in word order) is in the region.

    ``numbered`` says that the number is written; a plain region is the only effector's.
    """

    region: str
    effector: int
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    numbered: bool = field(default=True, compare=False, repr=False)


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
