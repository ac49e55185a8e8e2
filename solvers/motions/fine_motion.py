"""The motion that inputs cause, integrated far more finely than the search needs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.time_limits.time_limit import is_late
from solvers.motions.trajectory import Trajectory

AGREEMENT = 1e-10
"""Twice as many steps change no entry of a state by more, in SI."""
SUBSTEPS = 4
MOST_PARTS = 128


def fine_motion(numeric: NumericRobot, trajectory: Trajectory, dt: float) -> Trajectory:
    """The trajectory with its states integrated anew, by the same method in shorter steps.

    For tables and pictures, and whoever compares with another simulator; no proof rests on it, so
    that a limit of time leaves the states as fine as they are by then.
    """
    states, parts = trajectory.x, 1
    while parts <= MOST_PARTS and not is_late():
        finer = _sampled(numeric, trajectory, dt, parts)
        change = float(np.max(np.abs(finer - states), initial=0.0))
        states = finer
        if change <= AGREEMENT and parts > 1:
            break
        parts *= 2
    return replace(trajectory, x=states)


def _sampled(numeric: NumericRobot, trajectory: Trajectory, dt: float, parts: int) -> Array:
    """The states at the samples, each step divided into so many parts."""
    u = np.repeat(trajectory.u, parts, axis=0)
    x = numeric.simulate(trajectory.x[0], u, trajectory.theta, dt / parts, SUBSTEPS)
    return x[::parts]
