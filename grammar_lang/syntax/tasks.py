"""Syntax nodes of workspaces and tasks."""

from __future__ import annotations

from dataclasses import field
from typing import Literal, TypeAlias

from grammar_lang.source import Span, node
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
from grammar_lang.syntax.formulas import Formula, Pose
from grammar_lang.syntax.missions import Minimize, Mission

# --- workspaces ---------------------------------------------------------------------------------


@node
class Dimension:
    """``plane xy;`` (2) or ``space xyz;`` (3)."""

    value: Literal[2, 3]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Box:
    """``box [..] x [..] x [..]``."""

    sides: tuple[Interval, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Inequality:
    """``left comparison right``."""

    left: Expr
    comparison: Comparison
    right: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Polytope:
    """``polytope { inequality; … } unit``."""

    rows: tuple[Inequality, ...]
    unit: Ident | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Point:
    """``(a, b, …) unit``: a point, a vector or a list of coordinates."""

    items: tuple[Expr, ...]
    unit: Ident | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Hull:
    """``hull (..), (..), …``."""

    points: tuple[Point, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Round:
    """``ball (..) radius r``, ``capsule (..), (..) radius r``, or ``cylinder`` like a capsule."""

    kind: Literal["ball", "capsule", "cylinder"]
    points: tuple[Point, ...]
    radius: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


Shape: TypeAlias = Box | Polytope | Hull | Round


@node
class Region:
    """``region NAME shape;``, ``obstacle …``, ``target …``, or ``bounds shape;`` without a name."""

    kind: Literal["bounds", "region", "obstacle", "target"]
    name: Ident | None
    shape: Shape
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class ObstaclesFrom:
    """``obstacles from "path" in UNIT at FRAME;``; a part that is not written is None."""

    path: Ident
    unit: Ident | None
    frame: Expr | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Workspace:
    """``workspace NAME { … }``."""

    name: Ident
    items: tuple[Dimension | Region | ObstaclesFrom, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


# --- tasks -------------------------------------------------------------------------------------


@node
class Robot:
    """``robot NAME;``."""

    name: Ident
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class TaskWorkspace:
    """``workspace NAME;``."""

    name: Ident
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class StartIn:
    """``start in R by effector n at rest held;``, or ``rates <= v``; parts not written are None."""

    region: Ident
    effector: Expr | None
    rates: Expr | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    held: bool = False


@node
class StartAt:
    """``start at (…);``."""

    point: Point
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class FinalRates:
    """``at rest for d`` (``bound`` is None) or ``rates <= bound for d``."""

    bound: Expr | None
    duration: Expr | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Reach:
    """``reach R by effector n aligned … at rest;``, or ``rates <= v``."""

    region: Ident
    effector: Expr | None
    poses: tuple[Pose, ...]
    rates: FinalRates | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Avoid:
    """``avoid R1, R2 with subject margin d except M1 M2, M3 M4;``."""

    regions: tuple[Ident, ...]
    subject: Literal["effector", "body"]
    margin: Expr | None
    excepted: tuple[tuple[Ident, Ident], ...] = ()
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Effort:
    """``effort <= v norm 2;``; ``norm`` is the text of the number."""

    bound: Expr
    norm: Ident | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Horizon:
    """``horizon k steps of dt;``, or ``horizon at most k steps of dt;``."""

    steps: Expr
    step: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    at_most: bool = False


@node
class Slack:
    """``slack expr;``."""

    value: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Gravity:
    """``gravity (gx, gy) unit;``."""

    point: Point
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Modules:
    """``modules <= n;``."""

    comparison: Comparison
    bound: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class BoundsBody:
    """``bounds with body;``."""

    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Fixing:
    """``OCCURRENCE.NAME = expr`` after ``fixed``."""

    occurrence: Ident
    name: Ident
    value: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class From:
    """``from SYMBOLS fixed L1.length = 2 m, …;``."""

    word: tuple[Ident, ...]
    fixed: tuple[Fixing, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Satisfy:
    """``satisfy FORMULA;``."""

    formula: Formula
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Control:
    """``control open loop;`` or ``control feedback;``."""

    loop: Literal["open loop", "feedback"]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Repeat:
    """``repeat;``."""

    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class RobustRadii:
    """``robust start 1 mm 0.1 deg;`` or ``robust measure 0.1 deg, 0.5 deg/s;``."""

    of: Literal["start", "measure"]
    values: tuple[Expr, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Payload:
    """``payload m by effector n;``."""

    mass: Expr
    effector: Expr | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Carry:
    """``carry m from A to B by effector n rates <= v;``."""

    mass: Expr
    source: Ident
    target: Ident
    effector: Expr | None
    rates: FinalRates | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class RobustPercent:
    """``robust effort 0.5 %;``, ``… % of bound;``, ``robust mass 5 % of M;`` or ``payload``."""

    of: Literal["effort", "effort of bound", "mass", "payload"]
    percent: Expr
    module: Ident | None = None
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
    | Control
    | Repeat
    | Payload
    | Carry
    | Minimize
    | RobustRadii
    | RobustPercent
)


@node
class Task:
    """``task NAME { … }``."""

    name: Ident
    items: tuple[TaskItem, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Include:
    """``include "path";``, or ``include std "path";`` for a file of the library."""

    path: Ident
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    std: bool = False


Item: TypeAlias = Module | Edges | Grammar | Semantics | Workspace | Task | Mission | Include


@node
class File:
    """The items of a file in the order written, and what could not be parsed.

    ``broken`` are the spans of items with a syntax error; those of their statements that could be
    parsed are still in ``items``.  ``skipped`` are the words in the text that was left out: a name
    that is one of them is not reported as missing.
    """

    items: tuple[Item, ...]
    broken: tuple[Span, ...] = ()
    skipped: frozenset[str] = frozenset()
