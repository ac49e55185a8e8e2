"""Objectives: the quantities that a task or a mission minimizes."""

from __future__ import annotations

from dataclasses import field
from fractions import Fraction
from typing import Literal, TypeAlias

from grammar_lang.ir.expressions import NOWHERE
from grammar_lang.source import Span, node

ObjectiveKind: TypeAlias = Literal["modules", "mass", "time", "energy", "effort", "sum", "changes"]


@node
class Objective:
    """A quantity to minimize; later ones may raise its least value by the fraction ``within``.

    ``modules`` is the number of modules, ``mass`` the mass of all bodies without loads (kg),
    ``time`` the duration of the motion (s), ``energy`` the energy that its drives exchange (J),
    ``effort`` the largest fraction of its bound that an input uses, and ``changes`` the price of
    rebuilding the robots of a mission.  ``sum`` is the sum of an ``attribute`` over the modules of
    the word.  Its ``amounts`` are the modules of the grammar with the attribute, in declaration
    order, each with its value in SI units or None for a parameter; other modules count as zero.
    ``unit`` is the SI unit of the sum as text, empty for a plain number.
    """

    kind: ObjectiveKind
    within: Fraction = Fraction(0)
    attribute: str | None = None
    amounts: tuple[tuple[str, Fraction | None], ...] = ()
    unit: str = ""
    span: Span = field(default=NOWHERE, compare=False, repr=False)
