"""A note about which bodies may touch if a task says ``avoid self``."""

from __future__ import annotations

from compiler.checks.smallest_robots import smallest_robots
from compiler.robots.bodies_apart import bodies_apart, exempt_bodies
from compiler.robots.robot import RobotModel
from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.diagnostics.wording import counted

MOST_PAIRS = 12
"""The most pairs that are named."""


def self_collision_diagnostics(program: ir.Program, sink: Sink) -> None:
    """Report which pairs of bodies are exempt, for tasks with ``avoid self``.

    They are those of the smallest robot with bodies that must not touch.
    """
    for task in program.tasks.values():
        if task.avoid_self is not None and program.grammars[task.grammar].semantics:
            _report(program, task, task.avoid_self, sink)


def _report(program: ir.Program, task: ir.Task, itself: ir.AvoidSelf, sink: Sink) -> None:
    tried = 0
    for derivation, model in smallest_robots(program, task):
        tried += 1
        apart = bodies_apart(model, itself)
        if apart:
            exempt = [
                f"{_named(model, one)} and {_named(model, two)}"
                for one, two in exempt_bodies(model, itself)
            ]
            more = len(exempt) - MOST_PAIRS
            listed = ", ".join(exempt[:MOST_PAIRS]) + (f" and {more} more" if more > 0 else "")
            sink.note(
                Code.EXEMPT_BODIES,
                f"in `{' '.join(derivation.word)}` {counted(len(apart), 'pair')} of bodies "
                f"must stay apart; pairs that may touch: {listed or 'none'}",
                itself.span,
                "name other pairs of modules that may touch after `except`",
            )
            return
    if tried:
        smallest = "smallest robot" if tried == 1 else f"{tried} smallest robots"
        message = f"no bodies of the {smallest} must stay apart"
        hint = "bodies that one joint connects may touch, and those that `except` names"
        sink.note(Code.EXEMPT_BODIES, message, itself.span, hint)


def _named(model: RobotModel, body: int) -> str:
    owner, name = model.collider_owners[body], model.collider_names[body]
    return name if owner is None else f"{name} ({owner.module} at symbol {owner.symbol})"
