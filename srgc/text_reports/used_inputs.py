"""How much of its inputs a design uses, bound by bound."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from compiler.robots.input_bounds import input_bounds
from compiler.robots.robot import RobotModel
from grammar_lang import ir
from solvers.verifier.claims.certificate import exact


@dataclass(frozen=True, slots=True)
class UsedInputs:
    """Inputs that share a bound, all figures in ``unit``.

    They are from ``low`` to ``high``; ``peak`` is the largest size of one of them, or of their norm
    where that is bounded; ``margin`` what they keep from the bound; ``effort``: whether they are
    efforts of joints.
    """

    name: str
    low: float
    high: float
    peak: float
    margin: float
    unit: str
    effort: bool


def used_inputs(
    model: RobotModel, task: ir.Task, inputs: Sequence[Sequence[str]]
) -> tuple[UsedInputs, ...]:
    """What a motion uses of each bound on its inputs, in the order of the bounds.

    Args:
        model: the robot.
        task: what bounds its inputs.
        inputs: a row (m,) of decimals per step.
    """
    rows = np.array([[float(exact(text)) for text in row] for row in inputs])
    used = []
    for bound in input_bounds(model, task):
        values = rows[:, list(bound.inputs)]
        sizes = np.linalg.norm(values, axis=1) if bound.norm2 else np.abs(values)
        inner = sizes if bound.norm2 else values
        below, above = inner.min() - float(bound.lower), float(bound.upper) - inner.max()
        used.append(
            UsedInputs(
                bound.name,
                float(values.min()),
                float(values.max()),
                float(sizes.max()),
                float(above if bound.norm2 else min(below, above)),
                bound.unit,
                bound.effort,
            )
        )
    return tuple(used)


def amount(value: float, unit: str, digits: int = 4) -> str:
    """A number of so many significant digits with its unit; a plain number has none."""
    return f"{value:.{digits}g}{'' if unit == '1' else ' ' + unit}"
