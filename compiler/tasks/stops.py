"""Where the effectors of a robot have to be at some instant, whatever the robot."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from fractions import Fraction

from compiler.robots.effector_counts import several_effectors
from compiler.tasks.necessary import task_visits
from grammar_lang import ir


@dataclass(frozen=True, slots=True)
class Stop:
    """A region in which an effector has to be at some instant.

    ``effector`` is its number, from 1, or None for the recorded one where the task names none.
    """

    region: str
    effector: int | None
    role: str


def stops(program: ir.Program, task: ir.Task) -> tuple[Stop, ...]:
    """Where effectors have to be whatever the robot: start, target, visits of the formulas."""
    found = [*_ends(task)]
    found += [Stop(p.region, p.effector, "region") for p in task_visits(task)]
    if any(stop.effector is None for stop in found) and _single(program, task):
        found = [Stop(stop.region, stop.effector or 1, stop.role) for stop in found]
    return tuple(found)


def _single(program: ir.Program, task: ir.Task) -> bool:
    """Whether every robot of the family is known to have one effector at most."""
    return several_effectors(program, program.grammars[task.grammar]) is False


def _ends(task: ir.Task) -> Iterator[Stop]:
    """Start and target; where the start has no effector of its own, the one that reaches starts."""
    reaching = None if task.reach is None else task.reach.effector
    if isinstance(task.start, ir.StartIn):
        yield Stop(task.start.region, task.start.effector or reaching, "start")
    if task.reach is not None:
        yield Stop(task.reach.region, reaching, "target")


# --- What it means for a robot to be at rest ------------------------------------------------------


REST_RATE = Fraction(1, 1000)
"""``reach ... at rest``: all rates of the joints below this, in SI units."""
