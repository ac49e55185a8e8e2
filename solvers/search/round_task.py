"""Motions that go on for ever, searched as motions of one round.

Two shapes of loops are tried: a tour that ends where it begins, at the start of the motion; and a
motion that comes to a cell, in which it stays.  What the formulas of the task ask for ever is asked
of the round in a form that is sufficient (:mod:`compiler.tasks.round_formula`).
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from fractions import Fraction

from compiler.tasks.round_formula import on_one_round
from compiler.tasks.sampled_formula import SampledFormula, sampled
from compiler.tasks.specification import PlanningProblem
from compiler.tasks.word_formula import every
from grammar_lang import ir

ARRIVAL = Fraction(1, 2)
"""The part of the horizon by which a motion that stays has arrived."""


@dataclass(frozen=True, slots=True)
class RoundTask:
    """A task about motions that end, and the sample at which the loop begins; None: there is none.

    ``task`` is what is searched.
    """

    task: ir.Task
    loop: int | None = None

    @property
    def formula(self) -> SampledFormula | None:
        """What its formulas ask of the samples."""
        return task_on_samples(self.task)


def task_on_samples(task: ir.Task) -> SampledFormula | None:
    """What the formulas of a task ask of the samples; None without one."""
    if not task.satisfy:
        return None
    return every(sampled(clause.formula, task.step, task.steps) for clause in task.satisfy)


def round_tasks(task: ir.Task, recorded: int) -> tuple[RoundTask, ...]:
    """What is searched for a task, in turn; ``recorded`` is the effector that reaches, from 0."""
    if not task.repeat:
        return (RoundTask(task),)
    arrival = int(task.steps * ARRIVAL)
    return tuple(_round_task(task, recorded, loop) for loop in ((0, arrival) if arrival else (0,)))


def _round_task(task: ir.Task, recorded: int, loop: int) -> RoundTask:
    formulas = [clause.formula for clause in task.satisfy]
    if task.reach is not None:
        window = ir.Window(Fraction(0), None)
        formulas.append(ir.Eventually(ir.Atom(task.reach.region, recorded + 1), window))
    end, begin = task.steps * task.step, loop * task.step
    asked = tuple(ir.Satisfy(on_one_round(formula, begin, end)) for formula in formulas)
    return RoundTask(replace(task, satisfy=asked, reach=None, repeat=False), loop)


def closing(problem: PlanningProblem, loop: int | None) -> tuple[PlanningProblem, ...]:
    """The planning problems of paths that close; that itself where there is no loop.

    Of a tour there is one per cell that a planned effector may start in, the same for all of them.
    """
    if loop is None:
        return (problem,)
    if loop:
        return (replace(problem, settled=loop, timed=True),)
    first, *others = problem.effectors
    return tuple(
        replace(problem, effectors=(replace(first, start=(cell,), end=(cell,)), *others))
        for cell in first.start
    )
