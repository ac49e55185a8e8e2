"""Which bodies may touch where a task says ``avoid self``, as a note."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import islice

from compiler.checks.starting_robots import PASSED_OVER
from compiler.robots.bodies_apart import bodies_apart, exempt_bodies
from compiler.robots.normal_form import RobotFamily, family_of
from compiler.robots.robot import RobotModel
from compiler.words.derivation import Derivation
from compiler.words.structures import structures_of
from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Code, Sink
from grammar_lang.diagnostics.wording import counted

MOST_ROBOTS = 100
"""So many of the smallest robots are looked at for bodies that have to stay apart."""
LONGEST = 200
"""Longer words are passed over: a check is to be quick."""
MOST_PAIRS = 12
"""So many pairs are named."""


def self_collision_diagnostics(program: ir.Program, sink: Sink) -> None:
    """Say of tasks with ``avoid self`` which pairs of bodies are exempt.

    They are those of the smallest robot with bodies that have to stay apart.
    """
    for task in program.tasks.values():
        if task.avoid_self is not None and program.grammars[task.grammar].semantics:
            _report(task, task.avoid_self, family_of(program, task), sink)


def _report(task: ir.Task, itself: ir.AvoidSelf, family: RobotFamily, sink: Sink) -> None:
    tried = 0
    for derivation, model in _smallest(family, task):
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
                f"must stay apart; what may touch: {listed or 'nothing'}",
                itself.span,
                "name other pairs of modules that may touch behind `except`",
            )
            return
    if tried:
        smallest = "smallest robot" if tried == 1 else f"{tried} smallest robots"
        message = f"no bodies of the {smallest} must stay apart"
        hint = "bodies that one joint connects may touch, and those that `except` names"
        sink.note(Code.EXEMPT_BODIES, message, itself.span, hint)


def _smallest(family: RobotFamily, task: ir.Task) -> Iterator[tuple[Derivation, RobotModel]]:
    """The smallest robots with all joints of their words; none where they are hard to come by."""
    try:
        words = family.language.words(max_length=LONGEST, max_modules=task.modules)
        for derivation in islice(structures_of(family.language, words), MOST_ROBOTS):
            yield derivation, family.built(derivation)
    except PASSED_OVER:
        return


def _named(model: RobotModel, body: int) -> str:
    owner = model.owners[body]
    name = f"body {body + 1}"
    return name if owner is None else f"{name} ({owner.module} at symbol {owner.symbol})"
