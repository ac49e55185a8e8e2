"""Missions: several tasks for one robot, or for robots that are rebuilt from task to task."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from fractions import Fraction

from grammar_lang.ir.expressions import NOWHERE
from grammar_lang.ir.objective import Objective
from grammar_lang.source import Span, node


@node
class Prices:
    """What it costs to add a module, to remove one, and to change a parameter that is free.

    ``change`` is zero where the price is not written: such a change is free of charge.
    """

    add: Fraction = Fraction(1)
    remove: Fraction = Fraction(1)
    change: Fraction = Fraction(0)


@node
class Mission:
    """Tasks in their order, of one grammar.

    Without ``prices`` one robot does all of them.  With ``prices`` it is rebuilt between tasks:
    modules that are kept keep the values of their parameters but for those that are ``free``, each
    the name of a module and one of its parameters; ``most`` bounds what all changes cost together.
    ``clauses`` are the places of ``tasks``, ``one robot``, ``reconfigure``, ``free``, ``changes``
    and ``minimize``, ``named`` those of the names of the tasks.
    """

    name: str
    tasks: tuple[str, ...]
    prices: Prices | None = None
    free: frozenset[tuple[str, str]] = frozenset()
    most: Fraction | None = None
    minimize: tuple[Objective, ...] = ()
    span: Span = field(default=NOWHERE, compare=False, repr=False)
    clauses: Mapping[str, Span] = field(default_factory=dict[str, Span], compare=False, repr=False)
    named: tuple[Span, ...] = field(default=(), compare=False, repr=False)
