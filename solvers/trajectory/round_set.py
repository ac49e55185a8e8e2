r"""A set of states that every round of a motion with feedback returns into, to first order.

The deviations at the beginning of one round and of the next are related by
:math:`\delta' = \Phi \delta + W r + d`, with the monodromy matrix :math:`\Phi` of the linearised
closed loop, the columns W of the disturbances of one round, and the drift d of the motion.  For
coordinates :math:`\delta = V z` the box :math:`|z| \le s` is invariant if

.. math:: |V^{-1} \Phi V|\, s + |V^{-1} (W, d)|\, 1 \le s .

Source: Kolmanovsky & Gilbert, *Theory and computation of disturbance invariant sets for
discrete-time linear systems* (1998); for parallelotopes, Dang & Maler (1998).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.robots.robot import RobotModel
from compiler.tasks.specification import disturbance_radii, input_errors, measurement_radii
from grammar_lang import ir
from solvers.trajectory.control_problem import ControlProblem
from solvers.trajectory.disturbance_spread import heavier_masses
from solvers.trajectory.rounding_allowance import rounding_allowance
from solvers.trajectory.trajectory import Trajectory

FLOOR = 1e-5
"""In SI; no set is smaller, so that rounding errors and remainders in a proof fit in."""
LEAST_SLACK = 0.1
"""The least share by which a set exceeds its estimate; at the end of the prefix, exactly this."""
MOST_ROUNDS = 500
"""A set that still grows after this many rounds is rejected."""
SETTLED = 1e-9


@dataclass(frozen=True, slots=True, eq=False)
class RoundSet:
    """The states ``centre`` (N,) + ``generators`` (N, N) r with |r| <= 1, in SI units."""

    centre: Array
    generators: Array


@dataclass(frozen=True, slots=True, eq=False)
class _RoundMap:
    """One round to first order: ``by_state`` (N, N), and the columns (N, c) that are added."""

    by_state: Array
    columns: Array
    entering: Array


def round_sets(
    numeric: NumericRobot,
    task: ir.Task,
    motion: Trajectory,
    gains: Array,
    loop: int,
    substeps: int,
    slack: float,
) -> tuple[RoundSet, ...]:
    """Invariant sets with ``slack``, a share of their size; empty if none is found.

    Args:
        numeric: the robot.
        task: the task, which names the disturbances.
        motion: the motion, which at its end returns to its state at sample ``loop``, up to whole
            turns.
        gains: (k, m, N) of the feedback.
        loop: the first sample of the loop.
        substeps: the parts of a step.
        slack: the share by which a set is larger than the estimate.
    """
    if not numeric.size:
        return (RoundSet(motion.x[loop], np.zeros((0, 0))),)
    with np.errstate(all="ignore"):
        once = _round_map(numeric, task, motion, gains, loop, substeps)
        if not all(np.isfinite(part).all() for part in (once.by_state, once.columns)):
            return ()
        try:
            return tuple(RoundSet(motion.x[loop], box) for box in _boxes(once, slack))
        except np.linalg.LinAlgError:
            return ()


def whole_turns(model: RobotModel, motion: Trajectory, loop: int) -> Array:
    """The whole turns (n,) by which joints have advanced from the sample ``loop`` to the end.

    It is 0 for joints that are not periodic.
    """
    n = len(model.dofs)
    farther = motion.x[-1, :n] - motion.x[loop, :n]
    return np.where(np.array(model.periodic, bool), np.round(farther / (2 * np.pi)), 0.0)


def turning(problem: ControlProblem, seed: Trajectory) -> ControlProblem:
    """The problem in which joints turn as often from the loop's sample to the end as in a seed."""
    numeric, loop = problem.numeric, problem.limits.loop
    if loop is None:
        return problem
    turned = np.zeros(numeric.size)
    turned[: numeric.n] = 2 * np.pi * whole_turns(numeric.graph.model, seed, loop)
    return replace(problem, limits=replace(problem.limits, turned=turned))


def _round_map(
    numeric: NumericRobot,
    task: ir.Task,
    motion: Trajectory,
    gains: Array,
    loop: int,
    substeps: int,
) -> _RoundMap:
    model, size, width = numeric.graph.model, numeric.size, 2 * numeric.n
    share, added = (np.array(each, dtype=float) for each in input_errors(task, model))
    heavier = heavier_masses(numeric, task, motion)
    count = heavier.shape[2]
    noise = np.diag([float(radius) for radius in measurement_radii(task, model)])
    step = numeric.step(motion.x[:-1], motion.u, motion.theta, float(task.step), substeps)
    turning = whole_turns(model, motion, loop) != 0
    rounding = np.diag(rounding_allowance(motion, gains[:, :, :width], model, task, turning))
    columns = np.zeros((size, width + count))
    columns[:width, :width] = np.diag([float(r) for r in disturbance_radii(task, model)])
    entering, by_state = columns, np.eye(size)
    for k, u in enumerate(motion.u):
        if k == loop:
            entering, columns = columns, np.zeros((size, width + count))
        by_x, by_u = step.state[k] - step.input[k] @ gains[k], step.input[k]
        columns = by_x @ columns
        # The mass error is constant over time, so its effects add up with their signs.
        columns[:width, width : width + count] += heavier[k]
        pushed = by_u * (share * np.abs(u) + added)
        misread = by_u @ gains[k][:, :width] @ noise
        columns = np.concatenate([columns, pushed, misread, by_u @ rounding], axis=1)
        if k >= loop:
            by_state = by_x @ by_state
    drift = (motion.x[-1] - motion.x[loop])[:, None]
    drift[: numeric.n, 0] -= 2 * np.pi * whole_turns(model, motion, loop)
    return _RoundMap(by_state, np.concatenate([columns, drift], axis=1), entering)


def _boxes(once: _RoundMap, slack: float) -> Iterator[Array]:
    """The generators of invariant parallelotopes along several choices of axes."""
    for basis in _bases(once):
        if not np.isfinite(basis).all() or abs(np.linalg.det(basis)) == 0:
            continue
        into = np.linalg.inv(basis)
        turn = (1 + slack) * np.abs(into @ once.by_state @ basis)
        added = (1 + slack) * np.abs(into @ once.columns).sum(axis=1)
        added += (1 + slack) * FLOOR * np.abs(into).sum(axis=1)
        least = (1 + LEAST_SLACK) * np.abs(into @ once.entering).sum(axis=1)
        sizes = np.maximum(least, added)
        for _ in range(MOST_ROUNDS):
            grown = np.maximum(sizes, turn @ sizes + added)
            if not np.isfinite(grown).all():
                break
            if np.all(grown <= (1 + SETTLED) * sizes):
                yield basis * grown
                break
            sizes = grown


def _bases(once: _RoundMap) -> Iterator[Array]:
    """The axes of the state space, of the spread over all rounds, and of the round map."""
    size = len(once.by_state)
    yield np.eye(size)
    spread, share = np.zeros((size, size)), once.columns @ once.columns.T
    share += FLOOR**2 * np.eye(size) + once.entering @ once.entering.T
    for _ in range(MOST_ROUNDS):
        spread = spread + share
        share = once.by_state @ share @ once.by_state.T
        if not np.trace(share) > SETTLED * np.trace(spread):
            break
    if np.isfinite(spread).all():
        scale = np.sqrt(np.diag(spread))
        axes = np.linalg.eigh(spread / scale / scale[:, None])[1]
        yield scale[:, None] * axes
    values, vectors = np.linalg.eig(once.by_state)
    columns = [
        vector.real if value.imag >= 0 else vector.imag
        for value, vector in zip(values, vectors.T, strict=True)
    ]
    yield np.array(columns).T
