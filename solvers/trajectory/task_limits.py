"""What bounds a motion apart from positions, in floats: inputs, joints, rates, its two ends."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from math import ceil

import numpy as np

from compiler.arrays import Array
from compiler.robots.given_start import given_start
from compiler.robots.robot import RobotModel
from compiler.robots.state_and_input import input_bounds, robot_states
from grammar_lang import ir
from grammar_lang.ir.constants import to_float

# --- What a robot and a task bound, in floats: joints and rates, inputs ---------------------------


NARROW = 0.1
"""Limits are narrowed at most by this part of a range's width."""
RATE_MARGIN = 0.5
"""Final rates are bound by at most this fraction of what the task says."""
LEAST_RATE = 0.05
"""They are so by at least this fraction, however far disturbed motions spread."""


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


def final_samples(task: ir.Task) -> int:
    """At how many of the last samples final rates are bound."""
    return 1 + min(ceil(task.stay / task.step), task.steps)


def motion_limits(
    model: RobotModel, task: ir.Task, slack: Array | float = 0.0, spread: float = 0.0
) -> MotionLimits:
    """Joint limits, rate limits, start and final rates of a robot in a task, in floats.

    Ranges are narrowed by ``slack`` at either end, but by no more than a part of their width; an
    array gives the slacks of ranges and rates at their lower and upper ends, shape (n, 2, 2).
    Disturbed motions are to be off by ``spread`` from the final rates, in SI units.
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
    final = np.inf
    if task.final_rates is not None:
        bound = float(task.final_rates.bound)
        final = min(RATE_MARGIN * bound, max(bound - spread, LEAST_RATE * bound))
    own = [0.0 if s.initial is None else to_float(s.initial) for s in robot_states(model)]
    return MotionLimits(
        ranges[:, 0], ranges[:, 1], rates[:, 0], rates[:, 1], start_rates, final, values,
        np.array(own), final_samples(task),
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
    (inf: free) at the last ``final_samples`` samples, ``start_values`` fixes the initial
    coordinates and ``own_start`` (r,) the initial states of the modules' own.  The last state is
    that of the sample ``loop``, if there is one.
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
