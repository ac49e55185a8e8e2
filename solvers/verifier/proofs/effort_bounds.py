"""Whether all inputs that a controller may command keep the bounds of a task."""

from __future__ import annotations

from collections.abc import Sequence
from math import inf

from flint import arb

from compiler.expressions.evaluators.balls import ball, below
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import InputBound, input_bounds
from grammar_lang import ir
from solvers.verifier.proofs.checked_condition import CheckedCondition
from solvers.verifier.proofs.tube_checks import Status

PLANNED = "planned "
"""So begins the name of a bound on the planned motion where disturbed ones have bounds, too."""


def bound_name(bound: InputBound) -> str:
    """What a condition on a bound is called."""
    return f"{bound.name} ({bound.unit})" if bound.effort else bound.name


def effort_conditions(
    model: RobotModel, task: ir.Task, commanded: Sequence[Sequence[arb]], prefix: str = ""
) -> list[CheckedCondition]:
    """One condition per bound: it holds for all inputs that a tube commands.

    Args:
        model: the robot.
        task: the task, whose step is in seconds.
        commanded: enclosures of the inputs, a row (m,) per step.
        prefix: begins the names.
    """
    found = []
    for bound in input_bounds(model, task):
        status, margin, most, worst = Status.HOLDS, inf, inf, 0
        for step, row in enumerate(commanded):
            gap = _gap(bound, row)
            lower = below(gap)
            if bool(gap < 0):
                status = Status.FAILS
            elif not lower >= 0 and status is Status.HOLDS:
                status = Status.UNDECIDED
            if not lower >= margin:
                margin, worst = lower, step
            most = min(most, float(gap.upper()))
        name, time = f"{prefix}{bound_name(bound)}", float(worst * task.step)
        found.append(CheckedCondition(name, status, margin, bound.unit, time, most=most))
    return found


def planned_efforts(
    model: RobotModel, task: ir.Task, conditions: Sequence[CheckedCondition]
) -> tuple[float, float]:
    """Bounds of the largest effort and of the robustness of the planned motion, as was proved.

    Both in the inputs' units; the robustness is the least margin of all bounds (Definition 7).
    """
    (_, peak), (robustness, _) = planned_ranges(model, task, conditions)
    return peak, robustness


Range = tuple[float, float]


def planned_ranges(
    model: RobotModel, task: ir.Task, conditions: Sequence[CheckedCondition]
) -> tuple[Range, Range]:
    """Between which numbers the largest effort and the robustness of the planned motion are.

    In the inputs' units.
    """
    known = {each.name: each for each in conditions}
    peak, robustness = (0.0, 0.0), (inf, inf)
    for bound in input_bounds(model, task):
        name = bound_name(bound)
        found = known.get(f"{PLANNED}{name}", known.get(name))
        margin, most = (inf, inf) if found is None else (found.margin, found.most)
        robustness = min(robustness[0], margin), min(robustness[1], most)
        if bound.effort:
            upper = float(bound.upper)
            peak = max(peak[0], upper - most), max(peak[1], upper - margin)
    return peak, robustness if robustness[0] < inf else (0.0, 0.0)


def _gap(bound: InputBound, row: Sequence[arb]) -> arb:
    """The distance of inputs from a bound; negative beyond it."""
    own = [row[i] for i in bound.inputs]
    upper = ball(bound.upper)
    if bound.norm2:
        # The ball of a square may hold negative numbers, which have no root.
        ends = ([abs(item).lower() for item in own], [abs(item).upper() for item in own])
        least, most = (sum((x.max(arb(0)) ** 2 for x in end), arb(0)).sqrt() for end in ends)
        return upper - least.union(most)
    gap = arb("inf")
    for item in own:
        gap = gap.min(item - ball(bound.lower)).min(upper - item)
    return gap
