"""Check that all inputs that a controller may command keep the bounds of a task."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf

from flint import arb

from compiler.expressions.evaluators.balls import ball, below
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import InputBound, input_bounds
from grammar_lang import ir
from solvers.verifier.proofs.checked_condition import CheckedCondition
from solvers.verifier.proofs.tube_checks import Status

PLANNED = "planned "
"""The prefix of bounds on the planned motion when disturbed motions have bounds, too."""


def bound_name(bound: InputBound) -> str:
    """The name of the condition on a bound."""
    return f"{bound.name} ({bound.unit})" if bound.effort else bound.name


def effort_conditions(
    model: RobotModel, task: ir.Task, commanded: Sequence[Sequence[arb]], prefix: str = ""
) -> list[CheckedCondition]:
    """One condition per bound, on all inputs that a tube commands.

    Args:
        model: the robot.
        task: the task, whose step is in seconds.
        commanded: enclosures of the inputs, a row (m,) per step.
        prefix: the beginning of the conditions' names.
    """
    found = []
    for bound in input_bounds(model, task):
        status, margin, most, worst = Status.HOLDS, inf, inf, 0
        for step, row in enumerate(commanded):
            gap = distance(bound, row)
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
    """Proved bounds of the largest effort and of the robustness of the planned motion.

    Each margin is in its own unit; the robustness is the least margin (Definition 7).
    """
    (_, peak), (robustness, _) = planned_ranges(model, task, conditions)
    return peak, robustness


@dataclass(frozen=True, slots=True)
class Margin:
    """The least margin of the inputs to a bound: between ``least`` and ``most``, in its unit."""

    bound: InputBound
    least: float
    most: float

    @property
    def widest(self) -> float:
        """The largest margin that inputs can have."""
        return float(self.bound.widest_margin)


def planned_margins(
    model: RobotModel, task: ir.Task, conditions: Sequence[CheckedCondition]
) -> list[Margin]:
    """The proved margins of the planned motion's inputs to each bound."""
    known, margins = {each.name: each for each in conditions}, []
    for bound in input_bounds(model, task):
        name = bound_name(bound)
        found = known.get(f"{PLANNED}{name}", known.get(name))
        margin, most = (inf, inf) if found is None else (found.margin, found.most)
        margins.append(Margin(bound, margin, most))
    return margins


def least_share(margins: Sequence[Margin]) -> float:
    """The least ratio of a margin to its largest possible value, times the largest such value.

    With one bound it is the margin. Inputs that can have only one value are left out.
    """
    counted = [each for each in margins if each.widest > 0]
    scale = max((each.widest for each in counted), default=0.0)
    return min((each.least / (each.widest / scale) for each in counted), default=0.0)


Range = tuple[float, float]


def planned_ranges(
    model: RobotModel, task: ir.Task, conditions: Sequence[CheckedCondition]
) -> tuple[Range, Range]:
    """Ranges of the largest effort and of the robustness of the planned motion.

    Both are in the inputs' units.
    """
    peak, robustness = (0.0, 0.0), (inf, inf)
    for each in planned_margins(model, task, conditions):
        robustness = min(robustness[0], each.least), min(robustness[1], each.most)
        if each.bound.effort:
            upper = float(each.bound.upper)
            peak = max(peak[0], upper - each.most), max(peak[1], upper - each.least)
    return peak, robustness if robustness[0] < inf else (0.0, 0.0)


def distance(bound: InputBound, row: Sequence[arb]) -> arb:
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
