"""A simulation of the motion of a certificate's decimals, and the conditions it clearly violates.

A search runs it before it spends a proof.  States between the samples are balls about simulated
ones, as wide as the estimated integration error.  The verifier's own conditions are evaluated on
these balls, and one counts as violated only if it is violated for the whole ball.  Nothing is
proved here: a condition that is not violated may still fail to be proved.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from math import ceil

import numpy as np
from flint import arb

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.expressions.evaluators.balls import BALLS, constant_ball, working_precision
from compiler.expressions.tape import Tape, tape
from compiler.robots.state_and_input import robot_states
from grammar_lang.ir.constants import to_float
from solvers.trajectory.trajectory import Trajectory
from solvers.verifier.proofs.apart import Apart
from solvers.verifier.proofs.checked_condition import CheckedCondition, least
from solvers.verifier.proofs.effort_bounds import PLANNED, effort_conditions
from solvers.verifier.proofs.end_conditions import at_instant, end_positions, final_rates, held_at
from solvers.verifier.proofs.instant_conditions import position_conditions, state_limits
from solvers.verifier.proofs.point_map import Slice
from solvers.verifier.proofs.scene import Motion, Scene
from solvers.verifier.proofs.start_check import start_conditions
from solvers.verifier.proofs.trajectory_proof import cell_path
from solvers.verifier.proofs.tube_checks import Constraint, Inside, Status

INSTANTS = 4
"""The number of instants per step at which a motion is checked; twice as many for formulas."""
AGREEMENT = 1e-8
"""Integration is fine enough if doubling the parts changes no state entry by more, in SI."""
MOST_PARTS = 64
FLOOR = 1e-9
"""The least assumed integration error, in SI."""
DOUBT = 1e-6
"""Conditions that hold by more than this in floats, in metres, are not evaluated on balls."""
PRECISION = 64
"""The precision of the balls in bits, so that they are hardly wider than the errors."""


# --- The motion -----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class SimulatedMotion:
    """A motion between its samples, with ``fine`` instants per step.

    Attributes:
        states: (k fine + 1, N), in SI units.
        errors: their estimated errors, of the same shape.
        inputs: the commanded inputs, (k, m).
        off: the estimated errors of these, (k, m).
        theta: the parameters, (p,).
        fine: the number of instants per step.
    """

    states: Array
    errors: Array
    inputs: Array
    off: Array
    theta: Array
    fine: int


def simulated_motion(
    numeric: NumericRobot, motion: Motion, dt: float, substeps: int, fine: int = 2 * INSTANTS
) -> SimulatedMotion | None:
    """The motion of exact decimals, with their control law if they have one; None if it diverges.

    Args:
        numeric: the robot.
        motion: the decimals.
        dt: the time between samples, in seconds.
        substeps: the least number of parts of a step.
        fine: the number of states kept per step.
    """
    theta = np.array([float(value) for value in motion.theta])
    own = [
        0.0 if s.initial is None else to_float(s.initial) for s in robot_states(numeric.graph.model)
    ]
    first = np.array([*map(float, motion.state), *own])
    inputs = np.array(motion.inputs, float).reshape(len(motion.inputs), numeric.m)
    reference, gains = np.zeros((len(inputs) + 1, numeric.size)), None
    if motion.law is not None:
        reference[:-1, : 2 * numeric.n] = np.array(motion.law.reference, float)
        gains = np.zeros((len(inputs), numeric.m, numeric.size))
        gains[:, :, : 2 * numeric.n] = np.array(motion.law.gains, float)
    about = Trajectory(reference, inputs, theta)
    parts = max(1, -(-substeps // fine))
    with np.errstate(all="ignore"):
        found = _fine_states(numeric, first, about, gains, dt, fine, parts)
        while True:
            parts *= 2
            coarse, found = found, _fine_states(numeric, first, about, gains, dt, fine, parts)
            change = np.abs(found[0] - coarse[0])
            if not float(np.max(change, initial=0.0)) > AGREEMENT or parts >= MOST_PARTS:
                break
    if not (np.isfinite(change).all() and np.isfinite(found[0]).all()):
        return None
    errors = FLOOR + np.maximum.accumulate(change, axis=0)
    return SimulatedMotion(
        found[0], errors, found[1], FLOOR + np.abs(found[1] - coarse[1]), theta, fine
    )


def _fine_states(
    numeric: NumericRobot,
    first: Array,
    about: Trajectory,
    gains: Array | None,
    dt: float,
    fine: int,
    parts: int,
) -> tuple[Array, Array]:
    """States at ``fine`` instants per step, with ``parts`` parts between them, and the inputs."""
    if gains is None:
        often = np.repeat(about.u, fine, axis=0)
        return numeric.simulate(first, often, about.theta, dt / fine, parts), about.u
    states, inputs = [first[None, :]], []
    for k, planned in enumerate(about.u):
        x = states[-1][-1]
        inputs.append(planned - gains[k] @ (x - about.x[k]))
        held = np.repeat(inputs[-1][None, :], fine, axis=0)
        states.append(numeric.simulate(x, held, about.theta, dt / fine, parts)[1:])
    return np.concatenate(states), np.array(inputs).reshape(about.u.shape)


# --- Its violations -------------------------------------------------------------------------------


def clear_violations(
    scene: Scene, motion: Motion, numeric: NumericRobot, seen: SimulatedMotion
) -> tuple[CheckedCondition, ...]:
    """The conditions on the planned motion that it certainly violates, if errors are no larger.

    ``margin`` is the worst violation, if the condition has a margin.  Formulas and conditions on
    all motions of a loop are not checked.
    """
    with working_precision(PRECISION):
        review, worst = _Review(scene, motion, numeric, seen), dict[str, CheckedCondition]()
        for each in (*review.at_start(), *review.always(), *review.at_end(), *review.at_samples()):
            known = worst.get(each.name)
            if each.status is Status.FAILS and (known is None or each.margin < known.margin):
                worst[each.name] = each
    return tuple(worst.values())


@dataclass(frozen=True)
class _Review:
    """A simulated motion in balls, compared with the conditions of a task."""

    scene: Scene
    motion: Motion
    numeric: NumericRobot
    seen: SimulatedMotion

    @property
    def step(self) -> float:
        """The time between samples, in seconds."""
        return float(self.scene.task.step)

    @cached_property
    def tail(self) -> tuple[arb, ...]:
        """The balls of theta and k."""
        constants = (constant_ball(item) for item in self.scene.graph.constants)
        return (*(value.ball for value in self.motion.theta), *constants)

    @cached_property
    def states(self) -> list[list[arb]]:
        """Coordinates and rates of the graph at the instants, (2n,) each."""
        rows, seen = self.scene.graph.coordinates.rows, self.seen
        n = len(self.scene.model.dofs)
        turn = np.linalg.inv(np.array(rows, float).reshape(n, n))
        stride = seen.fine // INSTANTS
        found = []
        for state, error in zip(seen.states[::stride], seen.errors[::stride], strict=True):
            parts = (state[:n], error[:n]), (state[n : 2 * n], error[n : 2 * n])
            found.append(
                [
                    arb(middle, radius)
                    for x, off in parts
                    for middle, radius in zip(turn @ x, np.abs(turn) @ off, strict=True)
                ]
            )
        return found

    @cached_property
    def points(self) -> Tape:
        """The map from coordinates, theta and k to the positions of all points."""
        return tape(self.scene.graph.points)

    def places(self, number: int) -> list[list[arb]]:
        """Positions of all points at an instant, (points, d)."""
        n, d = len(self.scene.model.dofs), self.scene.model.dimension
        flat = self.points.evaluate([*self.states[number][:n], *self.tail], BALLS)
        return [flat[i : i + d] for i in range(0, len(flat), d)]

    def instant(self, number: int) -> Slice:
        """An instant in the form that the conditions of a tube take."""
        return at_instant(self.places(number), number * self.step / INSTANTS)

    @cached_property
    def about(self) -> Array:
        """The points of the graph at the instants in floats, (instants, points, d)."""
        states = self.seen.states[:: self.seen.fine // INSTANTS, : self.numeric.n]
        return self.numeric.graph_points(states, self.seen.theta)

    def doubtful(self, condition: Constraint) -> list[int]:
        """The instants at which the facets of a condition's set do not show that it holds."""
        if not isinstance(condition, (Inside, Apart)):
            return list(range(len(self.states)))
        normals = np.array([[float(x) for x in row.normal] for row in condition.rows])
        offsets, lengths = (
            np.array([float(x) for x in column])
            for column in zip(*((row.offset, row.length) for row in condition.rows), strict=True)
        )
        heights = self.about[:, list(condition.points)] @ normals.T
        # A shape extends beyond its points by at most the sum of its farthest extensions.
        about = sum(
            np.linalg.norm([float(x) for x in each.farthest]) for each in condition.extensions
        )
        beyond = (heights - offsets) / lengths
        room = float(condition.distance) + float(about) + DOUBT
        if isinstance(condition, Inside):
            unsure = np.max(beyond, axis=(1, 2), initial=-np.inf) > -room
        else:
            unsure = np.max(np.min(beyond, axis=1), axis=1, initial=-np.inf) < room
        return np.flatnonzero(unsure).tolist()

    def at_start(self) -> list[CheckedCondition]:
        """The conditions on the beginning of the motion."""
        return start_conditions(self.scene, self.motion, self.states[0], self.tail, self.places(0))

    def always(self) -> Iterator[CheckedCondition]:
        """The violated bounds, clearances, ranges and rates."""
        constraints = position_conditions(self.scene, self.tail)
        limits = state_limits(self.scene, 2 * len(self.scene.model.dofs))
        for item in constraints:
            for number in self.doubtful(item):
                at, time = self.instant(number), number * self.step / INSTANTS
                if item.violated(at):
                    margin = min(0.0, float(item.bound(at)[1].mid()))
                    place = item.where(at)
                    yield CheckedCondition(item.name, Status.FAILS, margin, "m", time, place)
        for number, state in enumerate(self.states):
            time = number * self.step / INSTANTS
            for limit in limits:
                gap = limit.gap(state)
                if bool(gap < 0):
                    margin = float(gap.mid())
                    yield CheckedCondition(limit.name, Status.FAILS, margin, limit.unit, time)

    def at_end(self) -> Iterator[CheckedCondition]:
        """The target and the final rates: at the last instant, or for as long as they bind."""
        task, last = self.scene.task, len(self.states) - 1
        if task.reach is None or task.repeat:
            return
        positions, rates = end_positions(self.scene, self.motion.effector), task.reach.rates
        slow = None if rates is None else final_rates(self.scene.graph, rates)
        first = max(0, ceil(last - INSTANTS * task.stay / task.step))
        for number in range(first, last + 1):
            at, time = self.instant(number), number * self.step / INSTANTS
            yield from (held_at(each, at) for each in positions)
            if slow is not None:
                yield least(slow.name, slow.gaps(self.states[number]), slow.unit, time)

    def at_samples(self) -> list[CheckedCondition]:
        """The path of cells, and the inputs that a law commands."""
        scene, task, motion = self.scene, self.scene.task, self.motion
        sampled = [self.places(number) for number in range(0, len(self.states), INSTANTS)]
        found = [cell_path(scene.abstraction, self.step, motion.path, sampled)]
        if motion.law is not None:
            several = task.robust is not None or task.repeat
            commanded = [
                [arb(u, off) for u, off in zip(*row, strict=True)]
                for row in zip(self.seen.inputs, self.seen.off, strict=True)
            ]
            prefix = PLANNED if several else ""
            found += effort_conditions(scene.model, task, commanded, prefix)
        return found
