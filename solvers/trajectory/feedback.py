r"""Time-varying feedback along a motion: gains, and the robot's motion with them.

The law of a step is u_k = u*_k - K_k (x_k - x*_k), with the gains of the linear quadratic regulator
of the linearised steps, :math:`\delta_{k+1} = A_k \delta_k + B_k \nu_k`,

.. math::
    K_k = (R + B_k^T P_{k+1} B_k)^{-1} B_k^T P_{k+1} A_k, \qquad
    P_k = Q + A_k^T P_{k+1} (A_k - B_k K_k), \qquad P_T = Q .

Source: Bryson & Ho, *Applied Optimal Control* (1975), section 2.2; Anderson & Moore, *Optimal
Control: Linear Quadratic Methods* (1990).
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import Linearisation, NumericRobot
from grammar_lang import ir
from solvers.trajectory.disturbance_spread import (
    DisturbanceSpread,
    disturbance_spread,
    second_order,
)
from solvers.trajectory.gain_refinement import refined_gains
from solvers.trajectory.round_set import LEAST_SLACK, round_sets
from solvers.trajectory.task_limits import InputGroup, acceleration_limits
from solvers.trajectory.trajectory import Trajectory


@dataclass(frozen=True, slots=True)
class Sizes:
    """Deviations of coordinates and rates, in rad or m (/s), as costly as an input at its bound.

    At first coordinates may deviate ``relaxed`` times as far, and rates by the root of that: an
    error at the start need not be corrected at once.  This fades exponentially along the horizon.
    """

    coordinate: float
    rate: float
    relaxed: float = 1.0

    def weights(self, shares: Array, joints: int, size: int) -> Array:
        """The weights (k, N) of a state's entries at fractions ``shares`` (k,) of the horizon."""
        more = 1 + (self.relaxed - 1) * np.exp(-shares / FADING)
        weights = np.zeros((len(shares), size))
        weights[:, :joints] = (self.coordinate * more[:, None]) ** -2
        weights[:, joints : 2 * joints] = (self.rate * np.sqrt(more[:, None])) ** -2
        return weights


LEAST_PULL = 1e-12
"""The least accelerations per unit of an input that count, in SI."""
FADING = 0.1
BEYOND_BOUNDS = 1e3
MOST_GROWTH = 10.0
SIZES = (
    Sizes(0.1, 0.5),
    Sizes(0.05, 1.0),
    Sizes(0.02, 1.0),
    Sizes(0.3, 1.5),
    Sizes(1.0, 5.0),
    Sizes(0.05, 1.0, 4.0),
    Sizes(0.03, 1.0, 12.0),
    Sizes(0.1, 1.0, 4.0),
)
"""Which are best depends on the robot and its disturbances; unmeasured states require small
gains."""

GENTLE = (Sizes(3.0, 15.0),)
"""Loops need gains that certainly bring states back, and have plenty of time for it."""


def input_scales(groups: tuple[InputGroup, ...], count: int) -> Array:
    """The widest margin of each input (count,), against which its deviations are weighted."""
    scales = np.ones(count)
    for group in groups:
        scales[list(group.inputs)] = group.widest_margin or 1.0
    return scales


ROUNDS = 4
"""The cost-to-go at the end of a loop is that of this many further rounds."""


def regulator(
    steps: Linearisation,
    measured: int,
    scales: Array,
    sizes: Sizes = SIZES[0],
    loop: int | None = None,
) -> Array:
    """Gains (k, m, N) along linearised steps; only the first ``measured`` entries are fed back.

    ``scales`` (m,) are the sizes of inputs, in their units.  With a ``loop`` the steps from there
    on repeat for ever.  Gains are zero if the equations have no finite solution.
    """
    count, size = steps.state.shape[:2]
    weights = sizes.weights(np.arange(count) / max(1, count), measured // 2, size)
    price = np.diag(scales**-2.0)
    gains = np.zeros((count, len(scales), size))
    ahead = np.diag(weights[-1]) if count else np.zeros((size, size))
    # The last step is repeated, so that the end is weighted like everything before it.
    order = list(reversed([*range(count), *[count - 1] * count]))
    if loop is not None:
        rounds = list(reversed(range(loop, count)))
        order = rounds * ROUNDS + order[count:]
    for k in order:
        a, b = steps.state[k], steps.input[k]
        try:
            gain = np.linalg.solve(price + b.T @ ahead @ b, b.T @ ahead @ a)
        except np.linalg.LinAlgError:
            return np.zeros_like(gains)
        ahead = np.diag(weights[k]) + a.T @ ahead @ (a - b @ gain)
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
    """The motion from ``first`` (N,) with feedback about another; inputs are clipped to bounds."""
    states, inputs = [first], []
    for k, planned in enumerate(about.u):
        u = planned - gains[k] @ (states[-1] - about.x[k])
        for group in groups:
            columns = list(group.inputs)
            u[columns] = group.clipped(u[columns], k)
        inputs.append(u)
        states.append(numeric.simulate(states[-1], u[None, :], about.theta, dt, substeps)[1])
    return Trajectory(np.array(states), np.array(inputs), about.theta)


# --- The gains and the reference that a certificate states ----------------------------------------

DIGITS = 6
"""Significant digits of a gain: more do not improve a controller."""
AGREEMENT = 1e-10
"""Integration is fine enough if doubling the parts changes no state entry by more, in SI."""
MOST_PARTS = 256


def closed_spread(
    numeric: NumericRobot,
    task: ir.Task,
    trajectory: Trajectory,
    groups: tuple[InputGroup, ...],
    substeps: int,
    loop: int | None = None,
    slack: float = LEAST_SLACK,
    *,
    refine: bool = False,
) -> tuple[Array, DisturbanceSpread | None]:
    """The gains (k, m, N) along a trajectory, and how far disturbed motions deviate with them.

    Among several sizes of deviations, those are chosen for which disturbed motions spread least on
    average and command little: to second order, unless that grows too much.  The spread is None for
    a task without disturbances and loop, and if no set is found into which rounds return.

    Args:
        numeric: the robot.
        task: the task.
        trajectory: the planned motion.
        groups: the bounded inputs.
        substeps: the parts of a step.
        loop: the first sample of a loop, from a set of states that is larger than estimated by
            ``slack``; None if the motion ends.
        slack: a share of the size of that set.
        refine: whether to refine the best gains, if they may be far from optimal: modules have
            unmeasured states, and the motion ends.
    """
    dt = float(task.step)
    with np.errstate(all="ignore"):
        steps = numeric.step(trajectory.x[:-1], trajectory.u, trajectory.theta, dt, substeps)
        scales, largest = input_scales(groups, numeric.m), acceleration_limits(numeric.graph.model)
        if largest.size:
            scales = np.minimum(scales, _forces(numeric, steps, largest, dt))
        if task.robust is None and loop is None:
            return _rounded(regulator(steps, 2 * numeric.n, scales)), None
        second = second_order(numeric, trajectory, dt)
        found = []
        for sizes in SIZES if loop is None else SIZES + GENTLE:
            gains = _rounded(regulator(steps, 2 * numeric.n, scales, sizes, loop))
            starts: list[tuple[int, Array] | None] = [None]
            if loop is not None:
                sets = round_sets(numeric, task, trajectory, gains, loop, substeps, slack)
                starts = [(loop, each.generators) for each in sets]
            for start in starts:
                linear = disturbance_spread(numeric, task, trajectory, steps, gains, None, start)
                closer = disturbance_spread(numeric, task, trajectory, steps, gains, second, start)
                bounded = closer.widest < MOST_GROWTH * linear.widest
                spread = closer if bounded else linear
                found.append((not bounded, spread_cost(spread, scales, largest), gains, spread))
        if not found:
            return _rounded(regulator(steps, 2 * numeric.n, scales, loop=loop)), None
        best = min(found, key=lambda item: item[:2])
        if not refine or loop is not None or numeric.size == 2 * numeric.n:
            return best[2], best[3]

        def spread_with(gains: Array) -> DisturbanceSpread:
            return disturbance_spread(numeric, task, trajectory, steps, gains, second)

        def cost(gains: Array) -> float:
            return spread_cost(spread_with(gains), scales, largest)

        gains = _rounded(refined_gains(best[2], 2 * numeric.n, cost)[0])
        return (gains, spread_with(gains)) if cost(gains) < best[1] else best[2:]


def _forces(numeric: NumericRobot, steps: Linearisation, largest: Array, dt: float) -> Array:
    """For each input (m,) the least value that brings some joint to its largest acceleration."""
    pulls = np.max(np.abs(steps.input[:, numeric.n : 2 * numeric.n]), axis=0, initial=0.0) / dt
    found: Array = np.min(largest[:, None] / np.maximum(pulls, LEAST_PULL), axis=0)
    return found


def spread_cost(spread: DisturbanceSpread, scales: Array, largest: Array) -> float:
    """The average spread of disturbed motions, more if much is commanded against it.

    ``scales`` (m,) are the sizes of inputs, in their units; ``largest`` (n,) are bounds on the
    accelerations, or (0,).
    """
    share = float(np.max(spread.inputs / scales, initial=0.0))
    if largest.size:
        share = max(share, float(np.max(spread.accelerations / largest, initial=0.0)))
    mean = float(np.max(spread.points, axis=1, initial=0.0).mean())
    return mean * (1 + share) / (1 - share) if share < 1 else mean * share * BEYOND_BOUNDS


def _rounded(gains: Array) -> Array:
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

    A controller that has this motion as its reference produces it.
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
