"""The deviation of disturbed motions from the planned one, which tightens the search's constraints.

The spread of the start and of the inputs is propagated along the linearised motion, D[i + 1] = A[i]
D[i] + B[i] d[i], and summed by absolute values, so that every corner counts.  With feedback,
second-order terms are added as in the proof, at the samples (``second_order.py``).  Sets that
amplify themselves are thus found before a proof is spent on them.  Nothing is proved by this.
"""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import Linearisation, NumericRobot
from compiler.tasks.specification import (
    disturbance_radii,
    input_errors,
    measurement_radii,
    uncertain_masses,
)
from grammar_lang import ir
from solvers.trajectory.task_limits import final_samples
from solvers.trajectory.trajectory import Trajectory

MOST_COLUMNS, KEPT_COLUMNS = 16, 10
"""Multiples of the state size: when columns of a set are replaced by a box, and how many remain."""
ROUNDS = 3
"""Second-order terms depend on accelerations and vice versa, so they are iterated."""


@dataclass(frozen=True, slots=True, eq=False)
class DisturbanceSpread:
    """Half-widths of the disturbed motions.

    Attributes:
        points: (k + 1, m), for the positions of all points at the samples, in metres.
        states: (k + 1, n, 2), for coordinates and rates at the samples, in SI units.
        inputs: (k, m), for the inputs that feedback commands in the steps, in SI units.
        final: the largest for rates at the samples at which final rates are bound, in SI units.
        accelerations: (k, n), for accelerations in the steps; 0 if none is bounded.
    """

    points: Array
    states: Array
    inputs: Array = field(default_factory=lambda: np.zeros((0, 0)))
    final: float = 0.0
    accelerations: Array | float = 0.0

    @property
    def widest(self) -> float:
        """The largest half-width of a position, in metres."""
        return float(np.max(self.points, initial=0.0))

    @property
    def size(self) -> float:
        """The largest deviation of a position in metres or of a coordinate in rad or m."""
        return max(self.widest, float(np.max(self.states[:, :, 0], initial=0.0)))

    @property
    def within_steps(self) -> Array:
        """For each sample the largest ``states`` among it and its two neighbours, (k + 1, n, 2)."""
        wide = np.pad(self.states, ((1, 1), (0, 0), (0, 0)), mode="edge")
        return np.maximum(np.maximum(wide[:-2], wide[1:-1]), wide[2:])

    def scaled(self, factor: float) -> DisturbanceSpread:
        """This spread, multiplied by ``factor``."""
        return DisturbanceSpread(
            factor * self.points, factor * self.states, factor * self.inputs,
            factor * self.final, factor * self.accelerations,
        )  # fmt: skip


@dataclass(frozen=True, slots=True, eq=False)
class SecondOrder:
    """The second derivatives of the equations of motion along a trajectory.

    Attributes:
        hessians: (k, n, N + n, N + n) of the equations, in the state and the accelerations.
        by_state: (k, n, N), derivatives of the accelerations.
        by_input: (k, n, m), derivatives of the accelerations.
        by_force: (k, N, n), derivatives of the state after a step in forces on the joints.
        mass: (k, n, n), M.
    """

    hessians: Array
    by_state: Array
    by_input: Array
    by_force: Array
    mass: Array

    def added(
        self, sample: int, columns: Array, inputs: Array, off: Array, misjudged: Array
    ) -> Array:
        """Generators (N, n) to be added to the columns (N, c) of a set after a step.

        Args:
            sample: the number of the step.
            columns: the set after the step, without these generators.
            inputs: the columns of the inputs held in it, (m, c).
            off: the deviation of inputs from these, (m,).
            misjudged: the deviation of inputs from the planned ones that an uncertain mass turns
                into other accelerations, (m,).
        """
        by_input, force = self.by_input[sample], self.by_force[sample]
        n, (size, count) = len(by_input), columns.shape
        solve = np.linalg.inv(self.mass[sample])
        extra = np.abs(self.mass[sample] @ by_input) @ misjudged
        pull = self.by_state[sample] @ columns + by_input @ inputs
        forms = extra
        for _ in range(ROUNDS):
            whole = np.zeros((size + n, count + len(off) + n))
            whole[:size, :count], whole[size:, :count] = columns, pull
            whole[size:, count:] = np.concatenate([by_input * off, solve * forms], axis=1)
            products = whole.T @ (self.hessians[sample] @ whole)
            diagonals = np.abs(np.diagonal(products, axis1=1, axis2=2)).sum(axis=1)
            forms = extra + np.abs(products).sum(axis=(1, 2)) / 2 - diagonals / 4
        added: Array = force * forms
        return added


def second_order(numeric: NumericRobot, trajectory: Trajectory, dt: float) -> SecondOrder:
    """The second derivatives along a trajectory, at all samples but the last.

    They are zero if the robot's graph provides none because it is too large.
    """
    graph, n, size = numeric.graph, numeric.n, numeric.size
    x, u, theta = trajectory.x[:-1], trajectory.u, trajectory.theta
    rates, jacobian = numeric.acceleration(x, u, theta)
    hessians = np.zeros((len(x), n, size + n, size + n))
    if graph.curvature is not None:
        function, places = graph.curvature
        arguments = [x[:, :n].T, x[:, n:].T, rates[:, :n].T, u.T]
        shared = [np.repeat(v[:, None], len(x), axis=1) for v in (theta, numeric.constants)]
        found = np.array(function.map(len(x))(*arguments, *shared))
        for (i, j, k), row in zip(places, found.reshape(len(places), len(x)), strict=True):
            if i < n:
                hessians[:, i, j, k] = hessians[:, i, k, j] = row
    mass = numeric.mass_matrix(x[:, :n], theta, u)
    inverse = np.linalg.inv(mass)
    by_force = np.zeros((len(x), size, n))
    by_force[:, :n], by_force[:, n : 2 * n] = dt**2 / 2 * inverse, dt * inverse
    by_input = jacobian[:, :n, size : size + numeric.m]
    return SecondOrder(hessians, jacobian[:, :n, :size], by_input, by_force, mass)


def _reduced(columns: Array, first: int) -> Array:
    """Fewer columns, spanning a superset; the ``first`` columns stay as they are."""
    size, count = columns.shape
    if count <= MOST_COLUMNS * size + first:
        return columns
    scales = np.abs(columns).sum(axis=1)
    scales[scales == 0] = 1.0
    lengths = ((columns[:, first:] / scales[:, None]) ** 2).sum(axis=0)
    order = first + np.argsort(lengths, kind="stable")
    short, long = np.split(order, [len(order) - KEPT_COLUMNS * size])
    box = np.diag(np.abs(columns[:, short]).sum(axis=1))
    return np.concatenate([columns[:, :first], columns[:, np.sort(long)], box], axis=1)


def disturbance_spread(
    numeric: NumericRobot,
    task: ir.Task,
    trajectory: Trajectory,
    step: Linearisation,
    gains: Array | None = None,
    second: SecondOrder | None = None,
    loop: tuple[int, Array] | None = None,
) -> DisturbanceSpread:
    """The spread of the motions that a task's ``robust`` clauses allow about a trajectory.

    ``step`` is the linearisation of its steps; with ``second`` and ``gains``, second-order terms
    are added.  Input errors are assumed constant within each step, and accelerations are reduced as
    uncertain masses do.  With ``gains`` (k, m, N) the measured state is fed back.  With a ``loop``,
    its first sample and the generators (N, N) of a set, the motions from that sample on are those
    from all states of the set.
    """
    n, k, theta, model = numeric.n, len(trajectory.u), trajectory.theta, numeric.graph.model
    radii = [float(radius) for radius in disturbance_radii(task, model)]
    noise = np.diag([float(radius) for radius in measurement_radii(task, model)])
    share, added = (np.array(each, dtype=float) for each in input_errors(task, model))
    heavier = heavier_masses(numeric, task, trajectory)
    count = heavier.shape[2]
    mass = max((float(item.part) for item in uncertain_masses(task, model)), default=0.0)
    columns = np.zeros((numeric.size, 2 * n + count))
    columns[: 2 * n, : 2 * n] = np.diag(radii)
    by_q = numeric.points(trajectory.x[:, :n], theta).by_q
    points, states = np.zeros(by_q.shape[:2]), np.zeros((k + 1, 2 * n))
    inputs = np.zeros((k, numeric.m))
    limited = any(dof.accel is not None for dof in model.dofs)
    pulled = np.zeros((k, n)) if limited else None
    slopes = pulled if pulled is None else _slopes(numeric, trajectory)
    for sample in range(k + 1):
        if loop is not None and sample == loop[0]:
            masses = np.zeros((numeric.size, count))
            columns = np.hstack([loop[1][:, : 2 * n], masses, loop[1][:, 2 * n :]])
        states[sample] = np.abs(columns[: 2 * n]).sum(axis=1)
        moved = np.abs(by_q[sample] @ columns[:n]).sum(axis=2)
        points[sample] = np.linalg.norm(moved, axis=1)
        if sample < k:
            by_x, by_u, u = step.state[sample], step.input[sample], trajectory.u[sample]
            misread = np.zeros((numeric.m, 2 * n))
            if gains is not None:
                misread = gains[sample][:, : 2 * n] @ noise
                inputs[sample] = np.abs(gains[sample] @ columns).sum(axis=1)
                inputs[sample] += np.abs(misread).sum(axis=1)
                by_x = by_x - by_u @ gains[sample]
            off = share * (np.abs(u) + inputs[sample]) + added
            if pulled is not None and slopes is not None:
                of_x, of_u = slopes[sample, :, : numeric.size], slopes[sample, :, numeric.size :]
                of_x = of_x if gains is None else of_x - of_u @ gains[sample]
                pulled[sample] = np.abs(of_x @ columns).sum(axis=1) + np.abs(of_u) @ off
                pulled[sample] += np.abs(of_u @ misread).sum(axis=1)
            before = columns
            columns = by_x @ columns
            # The mass error is constant over time, so its effects add up with their signs.
            columns[: 2 * n, 2 * n : 2 * n + count] += heavier[sample]
            columns = np.concatenate([columns, by_u * off, by_u @ misread], axis=1)
            if second is not None and gains is not None:
                held = np.zeros((numeric.m, columns.shape[1]))
                held[:, : before.shape[1]] = -gains[sample] @ before
                held[:, columns.shape[1] - 2 * n :] = misread
                misjudged = mass * (inputs[sample] + off)
                more = second.added(sample, columns, held, off, misjudged)
                columns = _reduced(np.concatenate([columns, more], axis=1), 2 * n + count)
        if not np.isfinite(columns).all():
            points[sample:], states[sample:], inputs[sample:] = np.inf, np.inf, np.inf
            break
    final = float(np.max(states[-final_samples(task) :, n:], initial=0.0))
    within = states.reshape(k + 1, 2, n).transpose(0, 2, 1)
    if pulled is None:
        return DisturbanceSpread(points, within, inputs, final)
    # At the end of a step they spread about as much as at the beginning of the next.
    later = np.maximum(pulled, np.concatenate([pulled[1:], pulled[-1:]]))
    return DisturbanceSpread(points, within, inputs, final, later)


def _slopes(numeric: NumericRobot, trajectory: Trajectory) -> Array:
    """The derivatives (k, n, N + m) of accelerations in states and inputs at the samples."""
    found = numeric.acceleration(trajectory.x[:-1], trajectory.u, trajectory.theta)[1]
    return np.asarray(found[:, : numeric.n, : numeric.size + numeric.m])


def heavier_masses(numeric: NumericRobot, task: ir.Task, trajectory: Trajectory) -> Array:
    """The effect of each uncertain mass on coordinates and rates in a step, (k, 2n, c)."""
    n, dt = numeric.n, float(task.step)
    masses = uncertain_masses(task, numeric.graph.model)
    if not masses:
        return np.zeros((len(trajectory.u), 2 * n, 0))
    x = (trajectory.x[1:] + trajectory.x[:-1]) / 2
    accelerations = np.diff(trajectory.x[:, n : 2 * n], axis=0) / dt
    groups = tuple(item.bodies for item in masses)
    parts = np.array([float(item.part) for item in masses])
    taken = parts * numeric.slowed(groups, x, accelerations, trajectory.u, trajectory.theta)
    return np.concatenate([dt * dt / 2 * taken, dt * taken], axis=1)
