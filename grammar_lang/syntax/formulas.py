"""Syntax nodes of ``satisfy``, in linear temporal logic on finite traces, and of effector poses."""

from __future__ import annotations

from dataclasses import field
from typing import Literal, TypeAlias

from grammar_lang.source import Span, node
from grammar_lang.syntax import NOWHERE, Expr, Ident

# --- poses --------------------------------------------------------------------------------------


@node
class Aligned:
    """``aligned axis to (a, b, c) within angle``; ``axis`` is x, y or z, possibly with a sign."""

    axis: str
    direction: tuple[Expr, ...]
    unit: Ident | None
    within: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Oriented:
    """``oriented frame within angle``."""

    frame: Expr
    within: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


Pose: TypeAlias = Aligned | Oriented

# --- formulas -----------------------------------------------------------------------------------


@node
class Atom:
    """``R by effector n``, with all of ``poses``."""

    region: Ident
    effector: Expr | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    poses: tuple[Pose, ...] = ()


@node
class Window:
    """``[lower, upper]`` after an operator."""

    lower: Expr
    upper: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Unary:
    """``not F``, ``next F``, and ``always F`` or ``eventually F`` with an optional window."""

    operator: Literal["not", "next", "always", "eventually"]
    operand: Formula
    window: Window | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Last:
    """``last[duration] F``."""

    duration: Expr
    operand: Formula
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Joined:
    """Two or more formulas joined by ``and`` or by ``or``."""

    operator: Literal["and", "or"]
    operands: tuple[Formula, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Binary:
    """``left until right`` or ``left implies right``."""

    operator: Literal["until", "implies"]
    left: Formula
    right: Formula
    span: Span = field(default=NOWHERE, compare=False, repr=False)


Formula: TypeAlias = Atom | Unary | Last | Joined | Binary
