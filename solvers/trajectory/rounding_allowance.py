"""How far a computer's rounding may take inputs from the law of a controller: what is asked for."""

from __future__ import annotations

import numpy as np

from compiler.arrays import Array
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import input_bounds, robot_inputs
from grammar_lang import ir
from solvers.trajectory.trajectory import Trajectory

SINGLE, DOUBLE = 2.0**-24, 2.0**-53
"""The part of a number by which single and double precision round it at most."""
DEVIATION = 1.0
"""A deviation from the reference for which rounding is estimated, in SI units."""
ROUNDED_TWICE = 2.0
TAKING_OFF = 6.0
"""So many times the turns that are taken off an angle are rounded at most."""
MOST_ROUNDING = 1e-4
"""Of half the range of an input; more would cost motions."""


def rounding_allowance(
    motion: Trajectory,
    gains: Array,
    model: RobotModel,
    task: ir.Task,
    turning: Array | None = None,
) -> Array:
    """Per input (m,) how far rounding may take it: enough for single precision, mostly.

    Without disturbances it is enough for doubles alone: the tube is narrow there, and a wide one
    takes several times as long.  ``gains`` are (k, m, 2n).  A rounded measurement and a rounded
    reference count with the gain; the rest counts with the deviation.  The angles of ``turning``
    joints (n,), None: of none, may be read within any one turn; whole turns are then taken off.
    What is carried is no number to be rounded.
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
