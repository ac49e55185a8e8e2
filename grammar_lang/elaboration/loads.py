"""Loads of effectors: point masses throughout the motion, or picked up and put down."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from typing import TypeVar

from grammar_lang import ir
from grammar_lang import syntax as s
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.elaboration.closed import Constants
from grammar_lang.elaboration.joint_values import final_rates
from grammar_lang.source import Span
from grammar_lang.syntax import tasks as t
from grammar_lang.units import MASS

Load = TypeVar("Load", ir.Payload, ir.Carry)


def lower_payloads(task: t.Task, reaching: int | None, sink: Sink) -> tuple[ir.Payload, ...]:
    """The ``payload`` clauses; wrong ones are reported and left out.

    Args:
        task: the task.
        reaching: the effector (from 1) in the task's ``reach``; it carries the load if the
            clause names no other.
        sink: collects the errors.
    """
    reader, found = Constants(sink), dict[int | None, ir.Payload]()
    for item in task.items:
        if isinstance(item, t.Payload):
            number, mass = _load(item, reaching, "payload", reader, sink)
            if mass is not None and _is_first(number, found, "payload", item.span, sink):
                found[number] = ir.Payload(mass, number, item.span)
    return tuple(found.values())


def lower_carries(
    task: t.Task,
    reaching: int | None,
    place: Callable[[s.Ident], str],
    kinds: tuple[ir.DofKind, ...],
    sink: Sink,
) -> tuple[ir.Carry, ...]:
    """The ``carry`` clauses; wrong ones are reported and left out.

    Args:
        task: the task.
        reaching: as in :func:`lower_payloads`.
        place: returns the name of a region; reports it if there is no such region.
        kinds: the kinds of joints of the family; empty: any.
        sink: collects the errors.
    """
    reader, found = Constants(sink), dict[int | None, ir.Carry]()
    repeat = next((item for item in task.items if isinstance(item, t.Repeat)), None)
    for item in task.items:
        if not isinstance(item, t.Carry):
            continue
        if repeat is not None:
            notes = [(repeat.span, "the motion goes on for ever")]
            message = "a motion that goes on for ever cannot `carry`"
            hint = "write `payload m;` for what it holds all the time, or remove `repeat;`"
            sink.error(Code.BAD_VALUE, message, item.span, hint, notes)
        number, mass = _load(item, reaching, "load", reader, sink)
        source, target = place(item.source), place(item.target)
        rates = ir.FinalRates()
        if item.rates is not None:
            rates = final_rates(item.rates, kinds, sink, "write more than zero")
        if mass is not None and _is_first(number, found, "carry", item.span, sink):
            found[number] = ir.Carry(mass, number, source, target, rates, item.span)
    return tuple(found.values())


def _load(
    item: t.Payload | t.Carry, reaching: int | None, what: str, reader: Constants, sink: Sink
) -> tuple[int | None, Fraction | None]:
    """The effector (from 1) that carries a load, and the mass; the mass is None after an error."""
    number, mass = reaching, reader.rational(item.mass, MASS)
    if item.effector is not None:
        number = reader.integer(item.effector, 1, "an effector's number")
    if mass is not None and mass <= 0:
        message = f"the {what} is not positive"
        sink.error(Code.BAD_VALUE, message, item.mass.span, "write more than zero")
        return number, None
    return number, mass


def _is_first(
    number: int | None, found: dict[int | None, Load], name: str, span: Span, sink: Sink
) -> bool:
    """Whether this is the first load of its kind at an effector; reported if not."""
    # Without a number, assume the first effector; once the robots are known, others are reported.
    first = next((found[one] for one in found if (one or 1) == (number or 1)), None)
    if first is None:
        return True
    message, notes = f"a second `{name}` at this effector", [(first.span, "first here")]
    hint = "add the masses up" if name == "payload" else "an effector carries one load: remove one"
    sink.error(Code.REPEATED_CLAUSE, message, span, hint, notes)
    return False
