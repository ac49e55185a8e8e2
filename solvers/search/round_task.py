"""Unending motions, searched as motions of one round.

Three shapes are tried: a tour that ends where it begins, at the start of the motion; a motion that
arrives in a cell and stays there; and a motion that enters a tour later.  Formulas of the task
about all future time are replaced by sufficient conditions on one round
(:mod:`compiler.tasks.round_formula`).
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
"""The fraction of the horizon by which a motion that stays has arrived."""
ENTRIES = Fraction(1, 4), Fraction(1, 2)
"""The fractions of the horizon by which a motion enters a tour on which it does not begin."""
TAKEN = 1, Fraction(1, 2), Fraction(3, 4), Fraction(1, 4)
"""The fractions of the horizon that a motion takes, in turn, if the horizon is a bound."""
OTHERS = 40
"""The most further numbers of steps that are tried."""


@dataclass(frozen=True, slots=True)
class RoundTask:
    """A task about finite motions, and the sample at which the loop begins; None without a loop.

    ``task`` is the task that is searched.  If it ``stays``, the motion is in the last cell from
    that sample on.
    """

    task: ir.Task
    loop: int | None = None
    stays: bool = False

    @property
    def formula(self) -> SampledFormula | None:
        """The task's formulas on the samples."""
        return task_on_samples(self.task)


def tasks_by_length(task: ir.Task) -> tuple[ir.Task, ...]:
    """The tasks of motions of a fixed number of steps, in the order in which they are tried."""
    if not task.at_most:
        return (task,)
    numbers = (max(task.fewest_steps, int(part * task.steps)) for part in TAKEN)
    return tuple(task.lasting(steps) for steps in dict.fromkeys(numbers))


def tasks_of_other_lengths(task: ir.Task) -> tuple[ir.Task, ...]:
    """Further tasks of other lengths if formulas refer to times, evenly spread at first.

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
    """The formulas of a task on the samples; None without formulas."""
    if not task.satisfy:
        return None
    return every(sampled(clause.formula, task.step, task.steps) for clause in task.satisfy)


def round_tasks(task: ir.Task, recorded: int) -> tuple[RoundTask, ...]:
    """The tasks searched for a task, in turn; effector ``recorded`` (from 0) reaches."""
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
    """The planning problems of paths that close; the problem itself if there is no loop.

    For a tour from the start there is one problem per cell in which the first planned effector may
    start.
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
    """The problem in which some effectors end in the cell where they are at sample ``loop``.

    Each cell becomes a region of its own, with a blank in its name so that it clashes with no
    other.
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
