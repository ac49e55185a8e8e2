"""Whether some inputs within bounds balance a robot: at its start, as a condition in a search."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from solvers.trajectory.linear_model import LinearRows
from solvers.trajectory.task_limits import InputGroup
from solvers.trajectory.trajectory import Trajectory

KEPT = 1e-3
"""The share of their bounds that these inputs leave free."""
ROUNDS = 3
"""Steps of Newton's method: accelerations are affine in most inputs."""
TINY = 1e-300
STILL = 1e-6
"""The relative size of accelerations that count as none."""


def held_start(
    numeric: NumericRobot,
    trajectory: Trajectory,
    groups: tuple[InputGroup, ...],
    own: Array,
    unit: float,
) -> LinearRows:
    """The bounds on the inputs that balance a robot at its first sample, linearised there.

    If there are more inputs than joints, the balancing inputs are those nearest to the middle of
    their bounds, relative to these.  Slacks relative to the bounds are converted to lengths by
    ``unit`` (m).  ``own`` (r,) are the modules' own states.
    """
    state = trajectory.x[0].copy()
    state[2 * numeric.n :] = own
    found = _balance(numeric, state, trajectory.theta, groups)
    rows = [_rows(group, found.inputs) for group in groups if group.widest_margin > 0]
    sides = np.concatenate([*(each[0] for each in rows), np.zeros((0, numeric.m))])
    slack = np.concatenate([*(each[1] for each in rows), np.zeros(0)])
    first = np.zeros(len(slack), dtype=np.int64)
    return LinearRows(first, unit * sides @ found.by_q, unit * sides @ found.by_theta, unit * slack)


def holds_still(
    numeric: NumericRobot, state: Array, theta: Array, groups: tuple[InputGroup, ...]
) -> bool:
    """Whether inputs within their bounds seem to hold a robot still in the pose of a state (N,)."""
    found = _balance(numeric, state, theta, groups)
    chosen = (group for group in groups if group.widest_margin > 0)
    within = all(np.all(_rows(group, found.inputs)[1] >= -KEPT) for group in chosen)
    return bool(within and np.all(np.abs(found.left) <= STILL * (1 + np.abs(found.free))))


@dataclass(frozen=True, slots=True)
class _Balance:
    """Inputs (m,) that balance a robot, their slopes in q and theta, and accelerations (n,).

    ``free`` are the accelerations without these inputs, ``left`` those that remain with them.
    """

    inputs: Array
    by_q: Array
    by_theta: Array
    free: Array
    left: Array


def _balance(
    numeric: NumericRobot, state: Array, theta: Array, groups: tuple[InputGroup, ...]
) -> _Balance:
    """Newton's method for the inputs that leave a robot in the pose of a state (N,) at rest."""
    n, m, size = numeric.n, numeric.m, numeric.size
    states = state[None].copy()
    states[:, n : 2 * n] = 0.0
    u, by_q, by_theta = np.zeros((1, m)), np.zeros((m, n)), np.zeros((m, numeric.p))
    weights = np.ones(m)
    for group in groups:
        inputs = list(group.inputs)
        weights[inputs] = group.widest_margin
        u[0, inputs] = 0.0 if group.norm2 else (group.lower + group.upper) / 2
    accelerations = list[Array]()
    with np.errstate(all="ignore"):
        for _ in range(ROUNDS + 1):
            found = numeric.acceleration(states, u, theta)
            pull, slopes = (each[0, :n] for each in found)
            accelerations.append(pull)
            if len(accelerations) > ROUNDS or not (
                np.isfinite(pull).all() and np.isfinite(slopes).all()
            ):
                break
            back = -weights[:, None] * np.linalg.pinv(slopes[:, size : size + m] * weights)
            by_q, by_theta = back @ slopes[:, :n], back @ slopes[:, size + m :]
            u = u + back @ pull
    return _Balance(u[0], by_q, by_theta, accelerations[0], accelerations[-1])


def _rows(group: InputGroup, u: Array) -> tuple[Array, Array]:
    """Weights (w, m) of inputs and the slack (w,) of a group, relative to its widest margin."""
    own, widest = list(group.inputs), group.widest_margin
    kept = KEPT * widest
    if group.norm2:
        length = float(np.linalg.norm(u[own]))
        weights = np.zeros((1, len(u)))
        weights[0, own] = u[own] / max(length, TINY)
        left = np.array([group.upper - kept - length])
    else:
        one = np.eye(len(u))[own]
        weights = np.concatenate([one, -one])
        left = np.repeat([group.upper - kept, -group.lower - kept], len(own)) - weights @ u
    return weights / widest, left / widest
