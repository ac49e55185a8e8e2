"""Necessary conditions on the order of events in a motion, whatever the times between them.

A motion that satisfies ``eventually F`` has an instant at which F holds: an *event*. Every operator
that holds at one instant, and asks for another, adds one event. The motion is cut into slots
(:mod:`compiler.tasks.formula_slots`) at all its events, in whatever order and at whatever times
they happen, so the clauses require each event at one of the cuts. Nothing is known about the length
of a slot: a window of time is a condition about which only this is known, that ``always`` without
the window implies it and that it implies ``eventually`` without the window.

The clauses hold for every motion, however long. They see contradictions that the slots between
named times do not, such as ``(not A until B) and (not B until A)``, and are not sufficient either:
an operator that asks for an event again and again adds none.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass

from compiler.tasks.endless_slots import EndlessSlots
from compiler.tasks.formula_slots import Slots
from compiler.tasks.necessary_conditions import (
    AT_ANY_TIME,
    ConditionWriter,
    NecessaryConditions,
    Regions,
    Temporal,
    has_no_last_part,
    written_conditions,
)
from compiler.tasks.region_slots import Node
from grammar_lang import ir

EVENT_LIMIT = 64
"""With more events the order is not examined."""


def order_conditions(program: ir.Program, task: ir.Task) -> NecessaryConditions | None:
    """The demands of a task on the order of events; None if they are too large.

    Also None for an endless motion with a last part, which is reported where it is read.
    """
    count = sum(events(clause.formula) for clause in task.demanded)
    count += task.repeat and task.reach is not None
    if count > EVENT_LIMIT or has_no_last_part(task):
        return None

    def writer(regions: Regions, effectors: Sequence[int]) -> ConditionWriter:
        kind = EndlessSlots if task.repeat else Slots
        return _OrderWriter(
            kind(count + 1, regions.signatures, effectors), regions, task, task.step
        )

    return written_conditions(program, task, writer)


def events(formula: ir.Formula, *, positive: bool = True) -> int:
    """How many instants a formula at one instant asks for, or its negation if not ``positive``."""
    match formula:
        case ir.Not(operand=operand):
            return events(operand, positive=not positive)
        case ir.And(operands=operands) | ir.Or(operands=operands):
            return sum(events(part, positive=positive) for part in operands)
        case ir.Implies(left=left, right=right):
            return events(left, positive=not positive) + events(right, positive=positive)
        case ir.Eventually(operand=operand) | ir.Next(operand=operand) if positive:
            return 1 + events(operand)
        case ir.Always(operand=operand) if not positive:
            return 1 + events(operand, positive=False)
        case ir.Until(right=right) if positive:
            return 1 + events(right)
        case _:
            return 0


@dataclass(slots=True)
class _OrderWriter(ConditionWriter):
    """Writes the demands with every event at the end of a slot."""

    def required(self, formula: ir.Formula) -> int:
        return self._at(formula, positive=True)[0]

    def temporal(self, formula: Temporal) -> Node:
        slots, end = self.slots, self.slots.count + 1
        match formula:
            case ir.Until(left=left, right=right):
                return slots.until(self.node(left), self.node(right))
            case ir.Always(operand=operand, window=window):
                always = slots.always(self.node(operand), 0, end)
                if window == AT_ANY_TIME:
                    return always
                return slots.disjunction([always, slots.free(formula)])
            case ir.Eventually(operand=operand, window=window):
                eventually = slots.eventually(self.node(operand), 0, end)
                if window == AT_ANY_TIME:
                    return eventually
                return slots.conjunction([eventually, slots.free(formula)])
            case ir.Next(operand=operand):
                eventually = slots.eventually(self.node(operand), 0, end)
                return slots.conjunction([eventually, slots.free(formula)])
            case ir.Last(operand=operand):
                ending = slots.last_part(self.node(operand), 0)
                return slots.conjunction([ending, slots.free(formula)])

    # --- a formula or its negation at each instant between slots --------------------------------

    def _at(self, formula: ir.Formula, *, positive: bool) -> list[int]:
        """For each instant a literal that is true only if the formula may hold there."""
        match formula:
            case ir.Not(operand=operand):
                return self._at(operand, positive=not positive)
            case ir.And(operands=operands) | ir.Or(operands=operands):
                parts = [self._at(part, positive=positive) for part in operands]
                return self._combined(parts, every=isinstance(formula, ir.And) is positive)
            case ir.Implies(left=left, right=right):
                parts = [self._at(left, positive=not positive), self._at(right, positive=positive)]
                return self._combined(parts, every=not positive)
            case ir.Eventually(operand=operand) | ir.Next(operand=operand) if positive:
                return self._sometime(self._at(operand, positive=True))
            case ir.Always(operand=operand) if not positive:
                return self._sometime(self._at(operand, positive=False))
            case ir.Until(left=left, right=right) if positive:
                return self._until(self.node(left), self._at(right, positive=True))
            case _:
                node = self.node(formula)
                return self._instants(self.slots.row(node if positive else -node).some)

    def _instants(self, row: Sequence[int]) -> list[int]:
        return list(row[: 2 * self.slots.count + 1 : 2])

    def _implying(self, bodies: Iterable[Sequence[int]]) -> int:
        """A new variable that implies a clause for each body."""
        variable = self.slots.variable()
        self.slots.clauses += [(-variable, *body) for body in bodies]
        return variable

    def _combined(self, parts: Sequence[Sequence[int]], *, every: bool) -> list[int]:
        return [
            self._implying([[part] for part in at] if every else [at])
            for at in zip(*parts, strict=True)
        ]

    def _sometime(self, part: Sequence[int]) -> list[int]:
        """``part`` at an instant or a later one."""
        found = [part[-1]]
        for here in reversed(part[:-1]):
            found.append(self._implying([[here, found[-1]]]))
        return found[::-1]

    def _until(self, left: Node, right: Sequence[int]) -> list[int]:
        """``right`` at an instant or a later one, and ``left`` at all times before that."""
        row, found = self.slots.row(left), [right[-1]]
        for k in reversed(range(len(right) - 1)):
            here = [row.some[2 * k], row.every[2 * k + 1], found[-1]]
            found.append(self._implying([right[k], each] for each in here))
        return found[::-1]
