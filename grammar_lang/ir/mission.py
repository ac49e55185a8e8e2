"""Missions: several tasks for one robot, or for a robot that is rebuilt between tasks."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import field
from fractions import Fraction

from grammar_lang.ir.expressions import NOWHERE
from grammar_lang.ir.objective import Objective
from grammar_lang.source import Span, node


@node
class Prices:
    """The prices of adding a module, of removing one, and of changing a free parameter.

    ``change`` is zero unless its price is written: such a change then costs nothing.
    """

    add: Fraction = Fraction(1)
    remove: Fraction = Fraction(1)
    change: Fraction = Fraction(0)


@node
class Mission:
    """A sequence of tasks for one grammar.

    Without ``prices``, one robot does all of them.  With ``prices``, the robot is rebuilt between
    tasks.  Modules that stay keep their parameter values, except for the ``free`` parameters, each
    given by a module and a parameter name.  ``most`` bounds the total price of all changes.
    ``clauses`` are the places of ``tasks``, ``one robot``, ``reconfigure``, ``free``, ``changes``
    and ``minimize``; ``named`` are the places of the task names.
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
