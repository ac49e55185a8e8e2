"""What bounds a motion apart from positions, in floats: inputs, joints, rates, its two ends."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.robots.given_start import given_start
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import input_bounds, robot_states
from compiler.tasks.specification import disturbance_radii, input_errors, measurement_radii
from grammar_lang import ir
from grammar_lang.ir.constants import to_float
from solvers.trajectory.trajectory import Trajectory

# --- What a robot and a task bound, in floats: joints and rates, inputs ---------------------------


NARROW = 0.1
"""Limits are narrowed at most by this part of a range's width."""
RATE_MARGIN = 0.5
"""A final rest is asked for at this fraction of its bound."""


def state_limits(model: RobotModel) -> Array:
    """Ranges and rate limits of the joints, shape (n, 2, 2); infinite where there are none.

    Row i holds the range (rad or m) of joint i and its rate limits (the same per second), each
    as lower and upper end.
    """

    def ends(interval: ir.Interval | None) -> tuple[float, float]:
        if interval is None:
            return -np.inf, np.inf
        return to_float(interval.lower), to_float(interval.upper)

    limits = [(ends(dof.range), ends(dof.rate)) for dof in model.dofs]
    return np.array(limits).reshape(-1, 2, 2)


def motion_limits(model: RobotModel, task: ir.Task, slack: Array | float = 0.0) -> MotionLimits:
    """Joint limits, rate limits, start and final rates of a robot in a task, in floats.

    Ranges are narrowed by ``slack`` at either end, but by no more than a part of their width; an
    array gives the slacks of ranges and rates at their lower and upper ends, shape (n, 2, 2).
    """
    slacks = np.broadcast_to(slack, (len(model.dofs), 2, 2))
    limits = state_limits(model)
    width = np.diff(limits, axis=2)
    most = np.where(np.isfinite(width), NARROW * width, 0.0)
    inset = np.minimum(slacks, most) * np.array([1.0, -1.0])
    ranges, rates = (limits + inset).transpose(1, 0, 2)
    start = task.start
    values = None
    if isinstance(start, ir.StartAt):
        values = np.array([to_float(value) for value in given_start(model, start).values])
    start_rates = float(start.rates) if isinstance(start, ir.StartIn) else 0.0
    rests = task.reach is not None and task.reach.at_rest
    final = RATE_MARGIN * 1e-3 if rests else np.inf
    own = [0.0 if s.initial is None else to_float(s.initial) for s in robot_states(model)]
    return MotionLimits(
        ranges[:, 0], ranges[:, 1], rates[:, 0], rates[:, 1], start_rates, final, values,
        np.array(own),
    )  # fmt: skip


def input_groups(model: RobotModel, task: ir.Task) -> tuple[InputGroup, ...]:
    """The bounded inputs of a robot in a task."""
    return tuple(
        InputGroup(bound.inputs, float(bound.lower), float(bound.upper), bound.norm2, bound.effort)
        for bound in input_bounds(model, task)
    )


def resting_inputs(groups: tuple[InputGroup, ...], steps: int, count: int) -> Array:
    """Inputs (steps, count) as near to zero as their bounds allow."""
    u = np.zeros((steps, count))
    for group in groups:
        if not group.norm2:
            u[:, list(group.inputs)] = min(max(0.0, group.lower), group.upper)
    return u


# --- What bounds a motion apart from positions, in floats: inputs, joints, rates, its two ends ----


@dataclass(frozen=True, slots=True)
class InputGroup:
    """Inputs in [lower, upper] each, or of Euclidean norm at most ``upper`` (``norm2``).

    Bounds are in SI units: N m or N where ``effort`` says that the inputs are free ones of joints,
    else the units of the declared inputs.
    """

    inputs: tuple[int, ...]
    lower: float
    upper: float
    norm2: bool
    effort: bool = True

    def narrowed(self, spread: Array) -> InputGroup:
        """The group where inputs may differ by ``spread`` (m,) from what is planned.

        Bounds do not cross: where the spread is more than all of them, one value is left.
        """
        own = spread[list(self.inputs)]
        less = float(np.linalg.norm(own)) if self.norm2 else float(np.max(own, initial=0.0))
        less = min(less, self.widest_margin)
        lower = self.lower if self.norm2 else self.lower + less
        return replace(self, lower=lower, upper=self.upper - less)

    @property
    def widest_margin(self) -> float:
        """The margin of inputs in the middle of their bounds."""
        return self.upper if self.norm2 else (self.upper - self.lower) / 2

    def margin(self, u: Array) -> float:
        """The least distance of inputs (k, m) from the bounds, in their units."""
        own = u[:, list(self.inputs)]
        if self.norm2:
            own = np.linalg.norm(own, axis=1, keepdims=True)
        gaps = self.upper - own if self.norm2 else np.minimum(self.upper - own, own - self.lower)
        return float(np.min(gaps, initial=self.widest_margin))


def effort_scale(groups: tuple[InputGroup, ...]) -> float:
    """The unit in which defects and fictitious inputs are weighed: the largest margin of an input.

    Where every input has one value only, it is 1.
    """
    return max((group.widest_margin for group in groups), default=1.0) or 1.0


@dataclass(frozen=True, slots=True)
class MotionLimits:
    """What binds the state apart from positions, in SI units.

    Arrays have one entry per degree of freedom: coordinates in rad or m, rates in the same per
    second.  ``start_rates`` bounds the initial rates (0: at rest), ``final_rates`` the final ones
    (inf: free), ``start_values`` fixes the initial coordinates and ``own_start`` (r,) the initial
    states of the modules' own.  The last state is that of the sample ``loop``, if there is one.
    """

    lower: Array
    upper: Array
    rate_lower: Array
    rate_upper: Array
    start_rates: float
    final_rates: float
    start_values: Array | None
    own_start: Array = field(default_factory=lambda: np.zeros(0))
    loop: int | None = None


# --------------------------------------------------------------------------------------------------
# How far disturbed motions get from the planned one, to first order: a search tightens its
# constraints by it.
#
# The spread of the start and of the inputs is carried along the linearised motion, ``D[i + 1] =
# A[i] D[i] + B[i] d[i]``, and summed by absolute values, so that every corner counts. Nothing is
# proved by it: the proof encloses all disturbed motions of the nonlinear robot.


@dataclass(frozen=True, slots=True, eq=False)
class DisturbanceSpread:
    """Half-widths of the disturbed motions.

    Attributes:
        points: (k + 1, m) of the positions of all points at the samples, in metres.
        states: (n, 2) of coordinates and rates, the largest along the motion, in SI units.
        inputs: (m,) of what feedback commands, the largest along the motion, in SI units.
    """

    points: Array
    states: Array
    inputs: Array = field(default_factory=lambda: np.zeros(0))

    @property
    def widest(self) -> float:
        """The largest of the positions, in metres."""
        return float(np.max(self.points, initial=0.0))

    def scaled(self, factor: float) -> DisturbanceSpread:
        """So many times as wide."""
        return DisturbanceSpread(factor * self.points, factor * self.states, factor * self.inputs)


@dataclass(frozen=True, slots=True, eq=False)
class FloatErrors:
    """How far inputs are off: a part of themselves, ``added`` (m,) in SI; a part of all masses."""

    share: float
    added: Array
    mass: float

    @staticmethod
    def of(task: ir.Task, model: RobotModel) -> FloatErrors:
        """Those that a task names."""
        part, most = input_errors(task, model)
        mass = 0.0 if task.robust is None else float(task.robust.mass)
        return FloatErrors(float(part), np.array([float(value) for value in most]), mass)


def disturbance_spread(
    numeric: NumericRobot,
    task: ir.Task,
    trajectory: Trajectory,
    substeps: int,
    gains: Array | None = None,
    loop: tuple[int, Array] | None = None,
) -> DisturbanceSpread:
    """The spread of the motions that a task's ``robust`` clauses allow about a trajectory.

    Inputs are taken to be off by a constant in every step, and an uncertain mass to act as inputs
    that are off by its part all the time.  With ``gains`` (k, m, N) what is measured is fed back.
    With a ``loop``, its first sample and the generators (N, N) of a set, motions are those from all
    states of the set from then on.
    """
    n, k, theta, model = numeric.n, len(trajectory.u), trajectory.theta, numeric.graph.model
    radii = [float(radius) for radius in disturbance_radii(task, model)]
    noise = np.diag([float(radius) for radius in measurement_radii(task, model)])
    errors = FloatErrors.of(task, model)
    step = numeric.step(trajectory.x[:-1], trajectory.u, theta, float(task.step), substeps)
    columns = np.zeros((numeric.size, 2 * n + 1))
    columns[: 2 * n, : 2 * n] = np.diag(radii)
    by_q = numeric.points(trajectory.x[:, :n], theta).by_q
    points, states = np.zeros(by_q.shape[:2]), np.zeros((k + 1, 2 * n))
    inputs = np.zeros((k, numeric.m))
    for sample in range(k + 1):
        if loop is not None and sample == loop[0]:
            columns = np.insert(loop[1], 2 * n, 0.0, axis=1)
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
            pushed = by_u * (errors.share * (np.abs(u) + inputs[sample]) + errors.added)
            columns = by_x @ columns
            # The same constant all the time: its effects add up, sign by sign.
            columns[:, 2 * n] += errors.mass * (by_u @ u)
            columns = np.concatenate([columns, pushed, by_u @ misread], axis=1)
    largest = np.max(inputs, axis=0, initial=0.0)
    return DisturbanceSpread(points, states.max(axis=0).reshape(2, n).T, largest)
