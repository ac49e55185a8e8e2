r"""Time-varying feedback along a motion: gains, and the motion that a robot makes with them.

The law of a step is u_k = u*_k - K_k (x_k - x*_k), with the gains of the linear quadratic regulator
of the linearised steps, :math:`\delta_{k+1} = A_k \delta_k + B_k \nu_k`,

.. math::
    K_k = (R + B_k^T P_{k+1} B_k)^{-1} B_k^T P_{k+1} A_k, \qquad
    P_k = Q + A_k^T P_{k+1} (A_k - B_k K_k), \qquad P_T = Q .

Source: Bryson & Ho, *Applied Optimal Control* (1975), section 2.2; Anderson & Moore, *Optimal
Control: Linear Quadratic Methods* (1990).
"""

from __future__ import annotations

from typing import TypeAlias

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import Linearisation, NumericRobot
from solvers.trajectory.task_limits import InputGroup
from solvers.trajectory.trajectory import Trajectory

Sizes: TypeAlias = tuple[float, float]
SIZES: tuple[Sizes, ...] = ((0.1, 0.5), (0.05, 1.0), (0.02, 1.0), (0.3, 1.5))
"""Deviations of coordinates and rates, in rad or m (/s), that count as much as an input at its
bound.  Which are best depends on the robot and its disturbances; states that are not measured ask
for small gains."""

GENTLE: tuple[Sizes, ...] = ((1.0, 5.0), (3.0, 15.0))
"""Loops need gains that bring states back for certain, and they have all time."""


def input_scales(groups: tuple[InputGroup, ...], count: int) -> Array:
    """Per input (count,) its widest margin: what deviations of inputs are weighed against."""
    scales = np.ones(count)
    for group in groups:
        scales[list(group.inputs)] = group.widest_margin or 1.0
    return scales


ROUNDS = 4
"""The cost of what lies ahead of a loop is that of so many further rounds."""


def regulator(
    steps: Linearisation,
    measured: int,
    scales: Array,
    sizes: Sizes = SIZES[0],
    loop: int | None = None,
) -> Array:
    """Gains (k, m, N) along linearised steps; only the first ``measured`` entries are fed back.

    ``scales`` (m,) are the sizes of inputs, in their units.  With a ``loop`` the steps from that on
    come again and again.  Gains are zero where the equations have no finite solution.
    """
    count, size = steps.state.shape[:2]
    weight = np.zeros(size)
    weight[: measured // 2], weight[measured // 2 : measured] = sizes[0] ** -2, sizes[1] ** -2
    cost, price = np.diag(weight), np.diag(scales**-2.0)
    gains = np.zeros((count, len(scales), size))
    ahead, order = cost, list(reversed(range(count)))
    if loop is not None:
        order = order[: count - loop] * ROUNDS + order
    for k in order:
        a, b = steps.state[k], steps.input[k]
        try:
            gain = np.linalg.solve(price + b.T @ ahead @ b, b.T @ ahead @ a)
        except np.linalg.LinAlgError:
            return np.zeros_like(gains)
        ahead = cost + a.T @ ahead @ (a - b @ gain)
        ahead = (ahead + ahead.T) / 2
        gains[k] = gain
    gains[:, :, measured:] = 0.0
    return gains if np.isfinite(gains).all() else np.zeros_like(gains)


def closed_motion(
    numeric: NumericRobot,
    first: Array,
    about: Trajectory,
    gains: Array,
    groups: tuple[InputGroup, ...],
    dt: float,
    substeps: int,
) -> Trajectory:
    """The motion from ``first`` (N,) with feedback about another, inputs kept in their bounds."""
    states, inputs = [first], []
    for k, planned in enumerate(about.u):
        u = planned - gains[k] @ (states[-1] - about.x[k])
        for group in groups:
            columns = list(group.inputs)
            if group.norm2:
                size = float(np.linalg.norm(u[columns]))
                u[columns] *= min(1.0, group.upper / size) if size > 0 else 1.0
            else:
                u[columns] = np.clip(u[columns], group.lower, group.upper)
        inputs.append(u)
        states.append(numeric.simulate(states[-1], u[None, :], about.theta, dt, substeps)[1])
    return Trajectory(np.array(states), np.array(inputs), about.theta)


# --- The gains and the reference that a certificate states ----------------------------------------

DIGITS = 6
"""Significant digits of a gain: more do not make a controller better."""
AGREEMENT = 1e-10
"""Twice as many parts of a step change no entry of a state by more, in SI."""
MOST_PARTS = 256


def gains_along(
    numeric: NumericRobot,
    trajectory: Trajectory,
    groups: tuple[InputGroup, ...],
    dt: float,
    substeps: int,
    sizes: Sizes = SIZES[0],
    loop: int | None = None,
) -> Array:
    """The regulator's gains (k, m, N) along a trajectory, of few digits."""
    with np.errstate(all="ignore"):
        steps = numeric.step(trajectory.x[:-1], trajectory.u, trajectory.theta, dt, substeps)
    gains = regulator(steps, 2 * numeric.n, input_scales(groups, numeric.m), sizes, loop)
    few = [float(f"{value:.{DIGITS}g}") for value in gains.ravel().tolist()]
    return np.array(few).reshape(gains.shape)


def reference_motion(
    numeric: NumericRobot,
    about: Trajectory,
    gains: Array,
    groups: tuple[InputGroup, ...],
    dt: float,
    substeps: int,
) -> Trajectory:
    """The motion with feedback by gains (k, m, N) about another, from its start, integrated finely.

    It is what a controller does that has it for its own reference.
    """
    found, parts = about, substeps
    while parts <= MOST_PARTS:
        finer = closed_motion(numeric, about.x[0], about, gains, groups, dt, parts)
        change = float(np.max(np.abs(finer.x - found.x), initial=0.0))
        found = finer
        if not change > AGREEMENT:
            break
        parts *= 2
    return found
