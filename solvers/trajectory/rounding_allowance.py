"""Allowances for rounding errors of a computer that evaluates the law of a controller."""

from __future__ import annotations

import numpy as np

from compiler.arrays import Array
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import input_bounds, robot_inputs
from grammar_lang import ir
from solvers.trajectory.trajectory import Trajectory

SINGLE, DOUBLE = 2.0**-24, 2.0**-53
"""The largest relative rounding errors of single and double precision."""
DEVIATION = 1.0
"""The deviation from the reference for which rounding is estimated, in SI units."""
ROUNDED_TWICE = 2.0
TAKING_OFF = 6.0
"""The rounding of subtracting turns from an angle is at most that of this multiple of them."""
MOST_ROUNDING = 1e-4
"""The largest share of half the range of an input; more would exclude motions."""


def rounding_allowance(
    motion: Trajectory,
    gains: Array,
    model: RobotModel,
    task: ir.Task,
    turning: Array | None = None,
) -> Array:
    """For each input (m,) the allowed rounding error: usually enough for single precision.

    Without disturbances it is enough only for doubles: the tube is narrow then, and a wide one
    takes several times as long.  ``gains`` are (k, m, 2n).  Rounding errors of measurements and
    references grow with their sizes, those of the other operations with the deviation; the gain
    multiplies both.  The angles of ``turning`` joints (n,), None for none, may be measured in any
    one turn, and whole turns are then subtracted.  Load inputs are not rounded.
    """
    size, unit = gains.shape[2], DOUBLE if task.robust is None else SINGLE
    sizes = 2 * np.abs(motion.x[:-1, :size]) + DEVIATION
    if turning is not None and turning.any():
        angles = np.abs(motion.x[:-1, : len(turning)][:, turning])
        turns = np.ceil(angles.max(axis=0) / (2 * np.pi)) + 1
        sizes[:, : len(turning)][:, turning] += TAKING_OFF * 2 * np.pi * (turns + 1)
    terms = np.abs(gains) @ sizes[:, :, None]
    needed = ROUNDED_TWICE * unit * np.max(np.abs(motion.u) + terms[:, :, 0], axis=0, initial=0.0)
    most = np.full(len(needed), np.inf)
    for bound in input_bounds(model, task):
        own = list(bound.inputs)
        half = float(bound.upper if bound.norm2 else (bound.upper - bound.lower) / 2)
        most[own] = np.minimum(most[own], half)
    most[[item.is_load for item in robot_inputs(model)]] = 0.0
    allowed: Array = np.minimum(needed, MOST_ROUNDING * most)
    return allowed
