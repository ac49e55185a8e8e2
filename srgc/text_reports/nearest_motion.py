"""For a task that stayed unknown: the motion that came nearest to a design, and where it is stuck.

Nothing about it is proved.
"""

from __future__ import annotations

from dataclasses import dataclass
from math import isfinite
from typing import Any

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from grammar_lang import ir
from solvers.search.search_state import Cause, NearestMotion

FIRST = {
    Cause.NOT_FINITE: "another start",
    Cause.UNSOLVED: "another `--seed`",
    Cause.NOT_FOLLOWED: "more steps or more effort, or larger budgets: `--paths`, `--evaluations`",
    Cause.NO_CLEARANCE: "shorter steps, or smaller bounds in `robust`",
    Cause.NOISE: "smaller errors in `robust measure`",
    Cause.UNSTABLE: "`control feedback`, or shorter steps",
    Cause.DIVERGES: "shorter steps",
    Cause.NO_SET: "shorter steps, or smaller bounds in `robust`",
    Cause.NO_DECIMALS: "a range for parameters that have one value now",
    Cause.BROKEN: "shorter steps",
    Cause.BETWEEN_SAMPLES: "shorter steps",
    Cause.ENDED: "`control feedback`, or shorter steps",
    Cause.UNPROVED: "shorter steps",
    Cause.UNDER_WAY: "a longer `--time-limit`",
}
"""Maps each cause to what to try first against it."""


@dataclass(frozen=True, slots=True)
class Stuck:
    """The point at which a motion is stuck: time in s, position of the leading effector in m."""

    time: float
    position: tuple[float, ...]


def stuck_at(nearest: NearestMotion, task: ir.Task) -> Stuck | None:
    """Where a motion is stuck; None if it reaches all samples, or if that is not known."""
    sample = nearest.stuck
    if sample is None:
        return None
    trajectory, n = nearest.trajectory, len(nearest.model.dofs)
    numeric = NumericRobot(robot_graph(nearest.model, task.gravity))
    points = numeric.places(trajectory.x[sample : sample + 1, :n], trajectory.theta)
    place = points[0, nearest.leader].tolist()
    return Stuck(float(sample * task.step), tuple(place))


def first_to_try(nearest: NearestMotion) -> str | None:
    """What to try first against the cause that blocked a motion, in words; no run has tested it."""
    return nearest.remedy or FIRST.get(nearest.cause)


def nearest_entry(nearest: NearestMotion | None, task: ir.Task) -> dict[str, Any] | None:
    """The entry about the nearest motion in ``design.json``."""
    if nearest is None:
        return None
    stuck = stuck_at(nearest, task)
    return {
        "word": list(nearest.derivation.word),
        "derivation": list(nearest.derivation.labels),
        "parameters": [
            {
                "symbol": parameter.symbol,
                "module": parameter.module,
                "name": parameter.name,
                "value": float(value),
                "unit": parameter.unit,
            }
            for parameter, value in zip(
                nearest.model.parameters, nearest.trajectory.theta, strict=True
            )
        ],
        "effector": nearest.effector,
        "leader": nearest.leader,
        "cells": [nearest.abstraction.cells[cell].name for cell in nearest.cells],
        "robustness": nearest.robustness if isfinite(nearest.robustness) else None,
        "at_samples": nearest.feasible,
        "stuck": None if stuck is None else {"time": stuck.time, "position": list(stuck.position)},
        "cause": nearest.cause.value,
        "reason": nearest.text.removeprefix("; "),
        "try_first": first_to_try(nearest),
    }
