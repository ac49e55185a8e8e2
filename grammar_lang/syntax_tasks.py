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
)
from grammar_lang.syntax_formulas import Formula

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
class ObstaclesFrom:
    """``obstacles from "path";``."""

    path: Ident
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Workspace:
    """``workspace NAME { … }``."""

    name: Ident
    items: tuple[Dimension | Region | ObstaclesFrom, ...]
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


@dataclass(frozen=True, slots=True)
class Fixing:
    """``OCCURRENCE.NAME = expr`` after ``fixed``."""

    occurrence: Ident
    name: Ident
    value: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class From:
    """``from SYMBOLS fixed L1.length = 2 m, …;``."""

    word: tuple[Ident, ...]
    fixed: tuple[Fixing, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Satisfy:
    """``satisfy FORMULA;``."""

    formula: Formula
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class RobustStart:
    """``robust start 1 mm 0.1 deg;``."""

    values: tuple[Expr, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class RobustEffort:
    """``robust effort 0.5 %;``; the value counts hundredths."""

    percent: Expr
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
    | From
    | Satisfy
    | RobustStart
    | RobustEffort
)


@dataclass(frozen=True, slots=True)
class Task:
    """``task NAME { … }``."""

    name: Ident
    items: tuple[TaskItem, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@dataclass(frozen=True, slots=True)
class Include:
    """``include "path";``."""

    path: Ident
    span: Span = field(default=NOWHERE, compare=False, repr=False)


Item: TypeAlias = Module | Edges | Grammar | Semantics | Workspace | Task | Include


@dataclass(frozen=True, slots=True)
class File:
    """The items of a file in the order written, and what could not be read.

    ``broken`` are the spans of items with a syntax error; statements that could be read are in
    ``items`` all the same.  ``skipped`` are the words that stand in what was left out: whoever
    misses a name that is one of them says nothing.
    """

    items: tuple[Item, ...]
    broken: tuple[Span, ...] = ()
    skipped: frozenset[str] = frozenset()
