"""The abstract syntax of workspaces and tasks, and of a whole file.

Continues :mod:`grammar_lang.syntax` with the rules of the last two parts of ``srg.lark``.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, TypeAlias

from grammar_lang.source import Span
from grammar_lang.syntax import (
    NOWHERE,
    Comparison,
    Edges,
    Expr,
    Grammar,
    Ident,
    Interval,
    Module,
    Semantics,
    Unsupported,
)

# --- workspaces --------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Dimension:
    """``plane xy;`` (2) or ``space xyz;`` (3)."""

    value: Literal[2, 3]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Box:
    """``box [..] x [..] x [..]``."""

    sides: tuple[Interval, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Inequality:
    """``left comparison right``."""

    left: Expr
    comparison: Comparison
    right: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Polytope:
    """``polytope { inequality; … } unit``."""

    rows: tuple[Inequality, ...]
    unit: Ident | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Point:
    """``(a, b, …) unit``: a point, a vector or a list of coordinates."""

    items: tuple[Expr, ...]
    unit: Ident | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Hull:
    """``hull (..), (..), …``."""

    points: tuple[Point, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


Shape: TypeAlias = Box | Polytope | Hull


@dataclass(frozen=True, slots=True)
class Region:
    """``region NAME shape;`` and its like; ``bounds`` has no name."""

    kind: Literal["bounds", "region", "obstacle", "target"]
    name: Ident | None
    shape: Shape
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Workspace:
    """``workspace NAME { … }``."""

    name: Ident
    items: tuple[Dimension | Region | Unsupported, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


# --- tasks -------------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True)
class Robot:
    """``robot NAME;``."""

    name: Ident
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class TaskWorkspace:
    """``workspace NAME;``."""

    name: Ident
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class StartIn:
    """``start in R by effector n at rest;``, or ``rates <= v``; None where not written."""

    region: Ident
    effector: Expr | None
    rates: Expr | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class StartAt:
    """``start at (…);``."""

    point: Point
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Reach:
    """``reach R by effector n at rest;``."""

    region: Ident
    effector: Expr | None
    at_rest: bool
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Avoid:
    """``avoid R1, R2 with subject margin d;``."""

    regions: tuple[Ident, ...]
    subject: Literal["effector", "body"]
    margin: Expr | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Effort:
    """``effort <= v norm 2;``; ``norm`` is the text of the number."""

    bound: Expr
    norm: Ident | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Horizon:
    """``horizon k steps of dt;``."""

    steps: Expr
    step: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Slack:
    """``slack expr;``."""

    value: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Gravity:
    """``gravity (gx, gy) unit;``."""

    point: Point
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Modules:
    """``modules <= n;``."""

    comparison: Comparison
    bound: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class BoundsBody:
    """``bounds with body;``."""

    span: Span = field(default=NOWHERE, compare=False, repr=False)


TaskItem: TypeAlias = (
    Robot
    | TaskWorkspace
    | StartIn
    | StartAt
    | Reach
    | Avoid
    | Effort
    | Horizon
    | Slack
    | Gravity
    | Modules
    | BoundsBody
    | Unsupported
)


@dataclass(frozen=True, slots=True)
class Task:
    """``task NAME { … }``."""

    name: Ident
    items: tuple[TaskItem, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


Item: TypeAlias = Module | Edges | Grammar | Semantics | Workspace | Task | Unsupported


@dataclass(frozen=True, slots=True)
class File:
    """The items of a file in the order written."""

    items: tuple[Item, ...]
