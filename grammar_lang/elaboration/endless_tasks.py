"""Clauses about the end of a motion, in a task whose motion never ends."""

from __future__ import annotations

from collections.abc import Iterator

from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.syntax import formulas as f
from grammar_lang.syntax import missions as m
from grammar_lang.syntax import tasks as t


def check_endless(task: t.Task, repeat: t.Repeat | None, sink: Sink) -> None:
    """Report clauses about the end of a motion if the motion has no end.

    Args:
        task: the task.
        repeat: its clause ``repeat``; if None, its motions end and nothing is reported.
        sink: collects the errors.
    """
    if repeat is None:
        return
    notes = [(repeat.span, "the motion goes on for ever")]
    for item in task.items:
        if isinstance(item, t.Reach) and item.rates is not None:
            message = "a motion that goes on for ever has no end at which to rest"
            rest = "at rest" if item.rates.bound is None else "rates <= v"
            hint = f"remove `{rest}`, or remove `repeat;`"
            sink.error(Code.REST_WITHOUT_END, message, item.span, hint, notes)
        elif isinstance(item, t.Satisfy):
            for last in _lasts(item.formula):
                message = "a motion that goes on for ever has no last part"
                hint = "write `eventually always` for what holds from some time on"
                sink.error(Code.LAST_WITHOUT_END, message, last.span, hint, notes)
        elif isinstance(item, m.Minimize):
            for objective in item.objectives:
                name = objective.name.text
                if name not in ("time", "energy") or objective.attribute is not None:
                    continue
                message = f"a motion that goes on for ever has no least {name}"
                hint = f"remove `{name}`, or remove `repeat;`"
                sink.error(Code.TIME_WITHOUT_END, message, objective.span, hint, notes)


def _lasts(formula: f.Formula) -> Iterator[f.Last]:
    """The parts ``last[…]`` of a formula, from left to right."""
    match formula:
        case f.Last(operand=part):
            yield formula
            yield from _lasts(part)
        case f.Unary(operand=part):
            yield from _lasts(part)
        case f.Joined(operands=parts):
            for part in parts:
                yield from _lasts(part)
        case f.Binary(left=left, right=right):
            yield from _lasts(left)
            yield from _lasts(right)
        case f.Atom():
            return
