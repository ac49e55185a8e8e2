"""A note about which bodies may touch if a task says ``avoid self``."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from compiler.checks.smallest_robots import smallest_robots
from compiler.robots.bodies_apart import bodies_apart, exempt_bodies
from compiler.robots.collider_names import collider_names
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
            grammar = program.grammars[task.grammar]
            names = collider_names(program, grammar, derivation, model)
            exempt = [f"{names[one]} and {names[two]}" for one, two in exempt_bodies(model, itself)]
            more = len(exempt) - MOST_PAIRS
            listed = ", ".join(exempt[:MOST_PAIRS]) + (f" and {more} more" if more > 0 else "")
            sink.note(
                Code.EXEMPT_BODIES,
                f"in `{' '.join(derivation.word)}` {counted(len(apart), 'pair')} of bodies "
                f"must stay apart; pairs that may touch: {listed or 'none'}",
                itself.span,
                _hint(grammar, model, apart),
            )
            return
    if tried:
        smallest = "smallest robot" if tried == 1 else f"{tried} smallest robots"
        message = f"no bodies of the {smallest} must stay apart"
        hint = "bodies that one joint connects may touch, and those that `except` names"
        sink.note(Code.EXEMPT_BODIES, message, itself.span, hint)


def _hint(grammar: ir.Grammar, model: RobotModel, apart: Sequence[tuple[int, int]]) -> str:
    """How to let more bodies touch; ``except`` takes no module that only may own a body."""
    unclear = set(_unclear_owners(grammar))
    owners = [None if each is None else each.module for each in model.collider_owners]
    known = {None, *unclear}
    if all(owners[one] in known or owners[two] in known for one, two in apart):
        return (
            "`except` can add no pair here, for several modules may own the bodies: name one "
            "module in the quantities of a body, or emit it in a production of one module"
        )
    *names, last = (f"`{name}`" for name in sorted(unclear)) if unclear else ("",)
    but = (
        f", but not {', '.join(names)} and {last}: it is not clear which bodies are theirs"
        if unclear
        else ""
    )
    return f"name other pairs of modules that may touch after `except`{but}"


def _unclear_owners(grammar: ir.Grammar) -> Iterator[str]:
    """The modules that may own a body that others may own, too."""
    for production in grammar.productions:
        block = (grammar.semantics or {}).get(production.label)
        for emission in () if block is None else block.emissions:
            found = ir.owners(production, emission)
            if len(found) > 1 and not isinstance(emission, ir.Effector):
                yield from (production.right[i].name for i in found)
