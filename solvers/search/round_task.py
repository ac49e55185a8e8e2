"""Motions that go on for ever, searched as motions of one round.

Three shapes are tried: a tour that ends where it begins, at the start of the motion; a motion that
comes to a cell, in which it stays; and one that comes to a tour.  What the formulas of the task ask
for ever is asked of the round in a form that is sufficient (:mod:`compiler.tasks.round_formula`).
"""

from __future__ import annotations

from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, replace
from fractions import Fraction

from compiler.tasks.round_formula import on_one_round
from compiler.tasks.sampled_formula import SampledFormula, sampled
from compiler.tasks.specification import PlannedEffector, PlanningProblem
from compiler.tasks.word_formula import Literal, eventually, every, some
from grammar_lang import ir

ARRIVAL = Fraction(1, 2)
"""The part of the horizon by which a motion that stays has arrived."""
ENTRIES = Fraction(1, 4), Fraction(1, 2)
"""The parts of the horizon by which a motion comes to a tour that it does not begin on."""
TAKEN = 1, Fraction(1, 2), Fraction(3, 4), Fraction(1, 4)
"""The parts of the horizon that a motion takes, in turn, where it may take any."""
OTHERS = 40
"""At most so many other numbers of steps are looked at."""


@dataclass(frozen=True, slots=True)
class RoundTask:
    """A task about motions that end, and the sample at which the loop begins; None: there is none.

    ``task`` is what is searched.  What ``stays`` is in the last cell from that sample on.
    """

    task: ir.Task
    loop: int | None = None
    stays: bool = False

    @property
    def formula(self) -> SampledFormula | None:
        """What its formulas ask of the samples."""
        return task_on_samples(self.task)


def tasks_by_length(task: ir.Task) -> tuple[ir.Task, ...]:
    """The tasks of motions of one number of steps that are looked for, in turn."""
    if not task.at_most:
        return (task,)
    numbers = (max(task.fewest_steps, int(part * task.steps)) for part in TAKEN)
    return tuple(task.lasting(steps) for steps in dict.fromkeys(numbers))


def tasks_of_other_lengths(task: ir.Task) -> tuple[ir.Task, ...]:
    """Those that are looked for after them where formulas tell times, evenly spread at first.

    Without formulas there are none: a longer motion has the paths of a shorter one.
    """
    if not (task.at_most and task.demanded):
        return ()
    known = {each.steps for each in tasks_by_length(task)}
    left = [n for n in range(task.steps, task.fewest_steps - 1, -1) if n not in known]
    parts, found = deque([(0, len(left))]), list[int]()
    while parts and len(found) < OTHERS:
        first, last = parts.popleft()
        if first < last:
            middle = (first + last) // 2
            found.append(left[middle])
            parts += (first, middle), (middle + 1, last)
    return tuple(map(task.lasting, found))


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
    found = [_round_task(task, recorded, 0)]
    if arrival:
        found.append(_round_task(task, recorded, arrival, stays=True))
    found += [
        _round_task(task, recorded, loop)
        for loop in (int(task.steps * part) for part in ENTRIES)
        if loop
    ]
    return tuple(found)


def _round_task(task: ir.Task, recorded: int, loop: int, *, stays: bool = False) -> RoundTask:
    formulas = [clause.formula for clause in task.satisfy]
    if task.reach is not None:
        window = ir.Window(Fraction(0), None)
        there = ir.Atom(task.reach.region, recorded + 1, poses=task.reach.poses)
        formulas.append(ir.Eventually(there, window))
    end, begin = task.steps * task.step, loop * task.step
    asked = tuple(ir.Satisfy(on_one_round(formula, begin, end)) for formula in formulas)
    return RoundTask(replace(task, satisfy=asked, reach=None, repeat=False), loop, stays)


def closing(problem: PlanningProblem, shape: RoundTask) -> tuple[PlanningProblem, ...]:
    """The planning problems of paths that close; that itself where there is no loop.

    Of a tour from the start there is one per cell that a planned effector may start in, the same
    for all of them.
    """
    if shape.loop is None:
        return (problem,)
    if shape.stays:
        return (replace(problem, settled=shape.loop, timed=True),)
    if shape.loop:
        return (_returning(problem, shape.loop, problem.effectors),)
    first, *others = problem.effectors
    closed = _returning(problem, 0, others) if others else problem
    return tuple(
        replace(closed, effectors=(replace(first, start=(cell,), end=(cell,)), *others))
        for cell in first.start
    )


def _returning(
    problem: PlanningProblem, loop: int, effectors: Sequence[PlannedEffector]
) -> PlanningProblem:
    """The problem of paths of which some end in the cells in which they are at the sample ``loop``.

    Each cell is a region of its own, whose name has a blank, as no other has.
    """
    names = [f"cell {number}" for number in range(len(problem.propositions))]
    asked = [] if problem.formula is None else [problem.formula]
    for planned in effectors:
        there = (Literal(name, planned.effector + 1, positive=True) for name in names)
        asked.append(
            some(
                every([eventually(cell, sample, sample) for sample in (loop, problem.steps)])
                for cell in there
            )
        )
    regions = zip(problem.propositions, names, strict=True)
    return replace(
        problem,
        propositions=tuple(known | {name} for known, name in regions),
        formula=every(asked),
        timed=True,
    )
