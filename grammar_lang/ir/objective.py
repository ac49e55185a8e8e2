"""What a task or a mission minimizes."""

from __future__ import annotations

from dataclasses import field
from fractions import Fraction
from typing import Literal, TypeAlias

from grammar_lang.ir.expressions import NOWHERE
from grammar_lang.source import Span, node

ObjectiveKind: TypeAlias = Literal["modules", "mass", "time", "energy", "effort", "sum", "changes"]


@node
class Objective:
    """An objective, from which later ones may depart by the part ``within`` of its least value.

    ``modules`` is the number of modules, ``mass`` that of all bodies without loads (kg), ``time``
    how long the motion takes (s), ``energy`` what its drives turn over (J), ``effort`` the largest
    share of its bound that an input uses, ``changes`` what the robots of a mission cost to rebuild,
    ``sum`` the sum of an ``attribute`` over the modules of the word.  Of ``sum``, ``amounts`` has
    the modules of the grammar with the attribute in order of declaration, each with its value in SI
    units, or None where it is a parameter; the others count as zero.  ``unit`` is the SI unit of
    the sum as text, empty for a plain number.
    """

    kind: ObjectiveKind
    within: Fraction = Fraction(0)
    attribute: str | None = None
    amounts: tuple[tuple[str, Fraction | None], ...] = ()
    unit: str = ""
    span: Span = field(default=NOWHERE, compare=False, repr=False)
