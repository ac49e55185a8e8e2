"""What bounds the inputs of a robot in a task, exactly (C.3 of the paper, Theta and U)."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction

from compiler.expressions.rational_enclosure import rational_bounds
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import robot_inputs
from grammar_lang import ir

EFFORT_UNITS: dict[ir.DofKind, str] = {"revolute": "N*m", "prismatic": "N"}


@dataclass(frozen=True, slots=True)
class InputBound:
    """Inputs, by their places in u, that share one bound in SI.

    Each of them lies in [lower, upper]; with ``norm2`` their Euclidean norm is at most ``upper``.
    ``effort`` says that they are free inputs, bounded by the task.
    """

    inputs: tuple[int, ...]
    lower: Fraction
    upper: Fraction
    unit: str
    name: str
    norm2: bool = False
    effort: bool = False

    def margin(self, row: tuple[Fraction, ...]) -> Fraction:
        """The distance of one step's inputs (m,) from the bound; not for a norm."""
        return min(min(row[i] - self.lower, self.upper - row[i]) for i in self.inputs)


def input_bounds(model: RobotModel, task: ir.Task) -> tuple[InputBound, ...]:
    """The bounds of all inputs: the task's efforts in its order, then those of declared inputs.

    An irrational bound is replaced by a rational one just inside it.
    """
    inputs = robot_inputs(model)
    found = []
    for effort in task.effort:
        places = tuple(
            place
            for place, item in enumerate(inputs)
            if item.dof is not None and model.dofs[item.dof].kind == effort.kind
        )
        if places:
            unit = EFFORT_UNITS[effort.kind]
            found.append(
                InputBound(
                    places, -effort.bound, effort.bound, unit, "effort", effort.norm2, effort=True
                )
            )
    for place, item in enumerate(inputs):
        if item.domain is not None:
            lower = rational_bounds(item.domain.lower)[1]
            upper = rational_bounds(item.domain.upper)[0]
            name = f"input {item.module}.{item.name} (symbol {item.symbol})"
            found.append(InputBound((place,), lower, upper, item.unit, name))
    return tuple(found)


def unbounded_kinds(model: RobotModel, task: ir.Task) -> list[ir.DofKind]:
    """The kinds of joint with a free input that no effort of the task bounds."""
    free = {model.dofs[item.dof].kind for item in robot_inputs(model) if item.dof is not None}
    return sorted(free - {effort.kind for effort in task.effort})
