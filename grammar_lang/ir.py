"""The typed intermediate representation: names resolved, units converted to SI, spans kept.

Every node is frozen and compares without its span.  Expressions are trees over exact rationals
and pi; nothing is rounded here.  An *occurrence* is the position of a symbol on the right side of
its production, counted from 0; ``THIS`` stands for the left side.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from grammar_lang.ir_expressions import (
    NOWHERE,
    THIS,
    AttributeOf,
    Axis,
    Binary,
    Compose,
    DofOf,
    Expr,
    Function,
    Move,
    Num,
    Operator,
    ParameterOf,
    Pi,
    Rot,
    Shift,
    Unary,
    Vector,
    World,
)
from grammar_lang.ir_family import (
    Accept,
    AllOf,
    AnyOf,
    AttributeRule,
    Choices,
    Comparison,
    Contains,
    Count,
    Dof,
    DofKind,
    Effector,
    Emission,
    EndsWith,
    Grammar,
    Interval,
    Matches,
    Module,
    NotAccept,
    Parameter,
    PointMass,
    Production,
    RChoice,
    Regex,
    REmpty,
    Rod,
    Role,
    RRepeat,
    RSequence,
    RSymbol,
    SemanticBlock,
    Solid,
    StartsWith,
    Symbol,
    SymbolKind,
)
from grammar_lang.ir_task import (
    Avoid,
    Effort,
    HalfSpace,
    Hull,
    Inequalities,
    Reach,
    Region,
    RegionKind,
    StartAt,
    StartIn,
    Task,
    Workspace,
)
from grammar_lang.source import Source

__all__ = [
    "NOWHERE",
    "THIS",
    "Accept",
    "AllOf",
    "AnyOf",
    "AttributeOf",
    "AttributeRule",
    "Avoid",
    "Axis",
    "Binary",
    "Choices",
    "Comparison",
    "Compose",
    "Contains",
    "Count",
    "Dof",
    "DofKind",
    "DofOf",
    "Effector",
    "Effort",
    "Emission",
    "EndsWith",
    "Expr",
    "Function",
    "Grammar",
    "HalfSpace",
    "Hull",
    "Inequalities",
    "Interval",
    "Matches",
    "Module",
    "Move",
    "NotAccept",
    "Num",
    "Operator",
    "Parameter",
    "ParameterOf",
    "Pi",
    "PointMass",
    "Production",
    "Program",
    "RChoice",
    "REmpty",
    "RRepeat",
    "RSequence",
    "RSymbol",
    "Reach",
    "Regex",
    "Region",
    "RegionKind",
    "Rod",
    "Role",
    "Rot",
    "SemanticBlock",
    "Shift",
    "Solid",
    "StartAt",
    "StartIn",
    "StartsWith",
    "Symbol",
    "SymbolKind",
    "Task",
    "Unary",
    "Vector",
    "Workspace",
    "World",
]


@dataclass(frozen=True, slots=True)
class Program:
    """A whole file.  ``terminals``: modules and edges in order of declaration."""

    modules: Mapping[str, Module]
    terminals: tuple[str, ...]
    grammars: Mapping[str, Grammar]
    workspaces: Mapping[str, Workspace]
    tasks: Mapping[str, Task]
    sources: tuple[Source, ...] = field(compare=False, repr=False)

    def is_module(self, name: str) -> bool:
        """Whether a terminal is a module (and not an edge)."""
        return name in self.modules
