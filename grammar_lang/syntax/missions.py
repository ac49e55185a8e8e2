"""Syntax nodes of missions, and of the objectives of tasks and missions."""

from __future__ import annotations

from dataclasses import field
from typing import Literal, TypeAlias

from grammar_lang.source import Span, node
from grammar_lang.syntax import NOWHERE, Comparison, Expr, Ident


@node
class Objective:
    """``NAME(NAME) within p %``: an objective; the name in parentheses is an attribute."""

    name: Ident
    attribute: Ident | None
    within: Expr | None
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Minimize:
    """``minimize OBJECTIVE then OBJECTIVE;``."""

    objectives: tuple[Objective, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class MissionTasks:
    """``tasks A, B;``: the tasks, in this order."""

    names: tuple[Ident, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class OneRobot:
    """``one robot;``."""

    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Price:
    """``add 2``: the price of a change of one module, or of one parameter."""

    of: Literal["add", "remove", "change"]
    value: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Reconfigure:
    """``reconfigure add 2, remove 1, change 0.5;``."""

    prices: tuple[Price, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Freed:
    """``L.length`` in a ``free``: a parameter of a module."""

    module: Ident
    name: Ident
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Free:
    """``free L.length, M.width;``."""

    parameters: tuple[Freed, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)


@node
class Changes:
    """``changes <= n;``."""

    comparison: Comparison
    bound: Expr
    span: Span = field(default=NOWHERE, compare=False, repr=False)


MissionItem: TypeAlias = MissionTasks | OneRobot | Reconfigure | Free | Changes | Minimize


@node
class Mission:
    """``mission NAME { … }``."""

    name: Ident
    items: tuple[MissionItem, ...]
    span: Span = field(default=NOWHERE, compare=False, repr=False)
