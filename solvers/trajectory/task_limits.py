"""The constraints on a motion other than positions, in floats: inputs, joints, rates, both ends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from math import ceil

import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array
from compiler.robots.given_start import given_start
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import input_bounds, robot_states
from grammar_lang import ir
from grammar_lang.ir.constants import to_float
from solvers.trajectory.friction_inputs import input_friction

# --- Bounds from a robot and a task, in floats: joints and rates, inputs --------------------------


NARROW = 0.1
"""Limits are narrowed by at most this share of a range's width, unless a proof lacked more."""
RATE_MARGIN = 0.5
"""Final rates are limited to at most this fraction of the task's bound."""
ROUNDING = 1e-7
"""Inputs that exceed their bounds by no more, relatively, do so because of rounding."""
ACCELERATION_PART = 10.0
"""Limits of accelerations are narrowed by this share per unit of the distance kept from limits,
which gives 1 % at first."""
MOST_NARROWED = 0.3
LEAST_RATE = 0.05
"""But they are limited to no less than this fraction, however far disturbed motions spread."""


def state_limits(model: RobotModel) -> Array:
    """Ranges and rate limits of the joints, shape (n, 2, 2); infinite if there are none.

    Row i contains the range (rad or m) of joint i and its rate limits (the same per second), each
    as lower and upper end.
    """

    def ends(interval: ir.Interval | None) -> tuple[float, float]:
        if interval is None:
            return -np.inf, np.inf
        return to_float(interval.lower), to_float(interval.upper)

    limits = [(ends(dof.range), ends(dof.rate)) for dof in model.dofs]
    return np.array(limits).reshape(-1, 2, 2)


def acceleration_limits(model: RobotModel) -> Array:
    """Bounds (n,) on the joints' accelerations, in rad/s^2 or m/s^2; infinite if there is none.

    Empty, (0,), if no joint has a bound.
    """
    if all(dof.accel is None for dof in model.dofs):
        return np.zeros(0)
    return np.array([np.inf if d.accel is None else to_float(d.accel) for d in model.dofs])


def final_samples(task: ir.Task) -> int:
    """The number of samples at the end at which final rates are bound."""
    return 1 + min(ceil(task.stay / task.step), task.steps)


def motion_limits(
    model: RobotModel,
    task: ir.Task,
    slack: Array | float = 0.0,
    spread: float = 0.0,
    share: float = NARROW,
) -> MotionLimits:
    """Joint limits, rate limits, start and final rates of a robot in a task, in floats.

    Accelerations are limited as in the model, without a margin.  Ranges are narrowed by ``slack``
    at either end, but by at most a ``share`` of their width.  An array gives the slacks of ranges
    and rates at their lower and upper ends, shape (n, 2, 2), or (k + 1, n, 2, 2) if samples differ.
    Disturbed motions may deviate by ``spread`` from the final rates, in SI units.
    """
    limits = state_limits(model)
    width = np.diff(limits, axis=2)
    most = np.where(np.isfinite(width), share * width, 0.0)
    inset = np.minimum(slack, most) * np.array([1.0, -1.0])
    narrow = limits + inset
    ranges, rates = narrow[..., 0, :], narrow[..., 1, :]
    start = task.start
    values = None
    if isinstance(start, ir.StartAt):
        values = np.array([to_float(value) for value in given_start(model, start).values])
    start_rates = float(start.rates) if isinstance(start, ir.StartIn) else 0.0
    final = np.inf
    if task.final_rates is not None:
        bound = float(task.final_rates.bound)
        final = min(RATE_MARGIN * bound, max(bound - spread, LEAST_RATE * bound))
    own = [0.0 if s.initial is None else to_float(s.initial) for s in robot_states(model)]
    return MotionLimits(
        ranges[..., 0], ranges[..., 1], rates[..., 0], rates[..., 1], start_rates, final, values,
        np.array(own), final_samples(task), accelerations=acceleration_limits(model),
    )  # fmt: skip


def resting_at(
    limits: MotionLimits, task: ir.Task, samples: Sequence[tuple[int, int]], spread: Array | float
) -> MotionLimits:
    """The limits with rates bound at the samples at which loads are picked up and put down.

    Disturbed motions may deviate by ``spread`` from the rates, (k + 1, n) or one for all, in SI.
    """
    if not task.carries:
        return limits
    shape = task.steps + 1, limits.joints
    lower, upper = (np.array(np.broadcast_to(end, shape)) for end in limits.rates)
    off = np.broadcast_to(spread, shape)
    for carry, pair in zip(task.carries, samples, strict=True):
        bound = float(carry.rates.bound)
        for sample in pair:
            most = np.clip(bound - off[sample], LEAST_RATE * bound, RATE_MARGIN * bound)
            lower[sample] = np.minimum(np.maximum(lower[sample], -most), most)
            upper[sample] = np.maximum(np.minimum(upper[sample], most), -most)
    return replace(limits, rate_lower=lower, rate_upper=upper)


def input_groups(model: RobotModel, task: ir.Task) -> tuple[InputGroup, ...]:
    """The bounded inputs of a robot in a task, as if it had no dry friction.

    Bounds leave room for friction compensation, as far as possible.
    """
    friction = input_friction(model)
    found = []
    for bound in input_bounds(model, task):
        own = friction[list(bound.inputs)]
        added = float(np.linalg.norm(own) if bound.norm2 else np.max(own, initial=0.0))
        added = min(added, float(bound.widest_margin))
        lower, upper = float(bound.lower) + added, float(bound.upper) - added
        found.append(InputGroup(bound.inputs, lower, upper, bound.norm2, bound.effort))
    return tuple(found)


def resting_inputs(groups: tuple[InputGroup, ...], steps: int, count: int) -> Array:
    """Inputs (steps, count) as near to zero as their bounds allow."""
    u = np.zeros((steps, count))
    for group in groups:
        if not group.norm2:
            u[:, list(group.inputs)] = min(max(0.0, group.lower), group.upper)
    return u


# --- Constraints other than positions, in floats: inputs, joints, rates, both ends ----------------


@dataclass(frozen=True, slots=True)
class InputGroup:
    """Inputs in [lower, upper] each, or of Euclidean norm at most ``upper`` (``norm2``).

    Bounds are in SI units: N m or N if ``effort`` says that the inputs act on joints directly, else
    the units of the declared inputs.  In step i the inputs keep at least the distance ``kept[i]``
    from the bounds; an empty array means 0 everywhere.
    """

    inputs: tuple[int, ...]
    lower: float
    upper: float
    norm2: bool
    effort: bool = True
    kept: Array = field(default_factory=lambda: np.zeros(0))

    def narrowed(self, spread: Array) -> InputGroup:
        """The group if inputs may deviate by ``spread`` (k, m) from the plan.

        Bounds never cross: if the spread is too large, a single value is left.
        """
        own = spread[:, list(self.inputs)]
        kept = np.linalg.norm(own, axis=1) if self.norm2 else np.max(own, axis=1, initial=0.0)
        return replace(self, kept=np.minimum(kept, self.widest_margin))

    def clipped(self, u: Array, step: int) -> Array:
        """Inputs (m,) of a step, clipped to its narrowed bounds."""
        kept = float(self.kept[step]) if self.kept.size else 0.0
        if not self.norm2:
            return np.clip(u, self.lower + kept, self.upper - kept)
        size = float(np.linalg.norm(u))
        return u * min(1.0, (self.upper - kept) / size) if size > 0 else u

    def weight(self, scale: float) -> float:
        """The margin with the same share of its maximum as a margin of 1 of ``scale``.

        It is 0 if the inputs have only one admissible value.
        """
        return self.widest_margin / scale

    @property
    def widest_margin(self) -> float:
        """The margin of inputs in the middle of their bounds."""
        return self.upper if self.norm2 else (self.upper - self.lower) / 2

    def bounds(self) -> tuple[Array, Array]:
        """The narrowed bounds for each step, (k, 1) each, or (1, 1) for all."""
        kept = self.kept[:, None] if self.kept.size else np.zeros((1, 1))
        return self.lower + kept, self.upper - kept

    def margin(self, u: Array) -> float:
        """The least distance of inputs (k, m) from the bounds, in their units.

        If they do not keep the required distance, the (negative) difference to it.
        """
        own = u[:, list(self.inputs)]
        if self.norm2:
            own = np.linalg.norm(own, axis=1, keepdims=True)
        gaps = self.upper - own if self.norm2 else np.minimum(self.upper - own, own - self.lower)
        found = float(np.min(gaps, initial=self.widest_margin))
        if not self.kept.size:
            return found
        spare = float(np.min(gaps - self.kept[:, None], initial=self.widest_margin))
        return found if spare >= -ROUNDING * (1 + abs(self.upper)) else spare


def effort_scale(groups: tuple[InputGroup, ...]) -> float:
    """The unit of effort for defects and fictitious inputs: the largest margin of an input.

    It is 1 if every input has only one admissible value.
    """
    return max((group.widest_margin for group in groups), default=1.0) or 1.0


@dataclass(frozen=True, slots=True)
class MotionLimits:
    """The constraints on the state other than positions, in SI units.

    Bounds have one entry per degree of freedom, (n,), or such a row for each sample, (k + 1, n):
    coordinates in rad or m, rates in the same per second.  ``start_rates`` bounds the initial rates
    (0: at rest), ``final_rates`` the final ones (inf: free) at the last ``final_samples`` samples.
    ``start_values`` fixes the initial coordinates and ``own_start`` (r,) the initial values of the
    modules' own states.  ``accelerations`` bounds the joints' accelerations, (n,) or (k, n) step by
    step, (0,) if none is bound.  If there is a ``loop``, the last state is that of this sample plus
    ``turned`` (N,).
    """

    lower: Array
    upper: Array
    rate_lower: Array
    rate_upper: Array
    start_rates: float
    final_rates: float
    start_values: Array | None
    own_start: Array = field(default_factory=lambda: np.zeros(0))
    final_samples: int = 1
    loop: int | None = None
    turned: Array | float = 0.0
    accelerations: Array = field(default_factory=lambda: np.zeros(0))

    @property
    def joints(self) -> int:
        """The number of degrees of freedom."""
        return int(self.lower.shape[-1])

    @property
    def rates(self) -> tuple[Array, Array]:
        """The bounds on the rates, (n,) or (k + 1, n) each."""
        return self.rate_lower, self.rate_upper

    @property
    def accelerated(self) -> NDArray[np.int64]:
        """The indices (a,) of the joints with bounded accelerations."""
        bounds = np.atleast_2d(self.accelerations)
        return np.flatnonzero(np.isfinite(bounds).any(axis=0))

    def narrowed(self, margin: float, more: Array | float) -> MotionLimits:
        """The limits with tighter bounds on accelerations, by a share that grows with ``margin``.

        ``more`` (n,) or (k, n), in rad/s^2 or m/s^2, is also subtracted, but at least half of each
        bound remains.
        """
        if not self.accelerations.size:
            return self
        part = min(MOST_NARROWED, ACCELERATION_PART * margin)
        bounds = (1 - part) * self.accelerations
        return replace(self, accelerations=np.maximum(bounds - more, bounds / 2))

    @property
    def box(self) -> tuple[Array, Array]:
        """Bounds on coordinates (n,) that hold at every sample."""
        lower, upper = np.atleast_2d(self.lower), np.atleast_2d(self.upper)
        return lower.max(axis=0), upper.min(axis=0)
