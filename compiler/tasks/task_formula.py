"""The one formula of a task: its ``satisfy`` clauses, with ``reach`` and ``avoid`` as sugar."""

from __future__ import annotations

from fractions import Fraction

from compiler.tasks.formula_parts import atoms
from grammar_lang import ir

_THROUGHOUT = ir.Window(Fraction(0), None)


def task_formula(task: ir.Task, effectors: int, recorded: int) -> ir.Formula | None:
    """What the effectors of a robot have to satisfy at time 0; None for no demand at all.

    A margin of an ``avoid`` is not expressed: the formula asks for less than the task then.

    Args:
        task: the task.
        effectors: how many effectors the robot has.
        recorded: the effector that starts and reaches, from 0.
    """
    parts = [clause.formula for clause in task.satisfy]
    if task.reach is not None:
        parts.append(ir.Last(Fraction(0), ir.Atom(task.reach.region, recorded + 1)))
    parts += [
        ir.Always(ir.Not(ir.Atom(region, effector)), _THROUGHOUT)
        for avoid in task.avoid
        if avoid.subject == "effector"
        for region in avoid.regions
        for effector in range(1, effectors + 1)
    ]
    if len(parts) < 2:
        return parts[0] if parts else None
    return ir.And(tuple(parts))


def recorded_effector(task: ir.Task) -> int | None:
    """The effector that a task binds to be the recorded one, from 0; None: any, the claim says.

    It is the one that reaches; where nothing is to be reached, the one that starts.
    """
    if task.reach is not None:
        named = task.reach.effector
    elif isinstance(task.start, ir.StartAt):
        named = 1
    else:
        named = task.start.effector
    return None if named is None else named - 1


def missing_effector(task: ir.Task, effectors: int) -> int | None:
    """An effector, from 1, that a task names and a robot with so many lacks; None for none.

    Such a robot is no candidate, whatever is asked of the effector.
    """
    named = [atom.effector for atom in atoms(*(clause.formula for clause in task.satisfy))]
    if task.reach is not None and task.reach.effector is not None:
        named.append(task.reach.effector)
    if isinstance(task.start, ir.StartIn) and task.start.effector is not None:
        named.append(task.start.effector)
    return max((number for number in named if number > effectors), default=None)
