"""Replay many disturbed motions, and find those that leave the certified tube.

A motion leaves the tube if at a sample a coordinate, a rate or a commanded input is outside by more
than the integration error.  The error is taken as twice the largest change when motions are
simulated again with half the step, beginning with those closest to the faces of the tube.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil
from pathlib import Path

import numpy as np

from compiler.arrays import Array
from compiler.robots.state_and_input import robot_inputs
from solvers.verifier.report import Report
from solvers.verifier.verification import verify_directory
from srgc.exports.design_export import mujoco_text
from srgc.exports.exported_motion import EFFORT_UNITS, POSITION_UNITS
from srgc.exports.exported_robot import design_names, design_tree
from srgc.faults import UsageFault
from srgc.replays.disturbed_motions import Simulator, disturbances, module_masses, untold
from srgc.replays.mujoco_replay import mujoco_module
from srgc.replays.replay_run import Farthest
from srgc.results.found_design import FoundDesign, found_design, found_tube

USUAL_STEP = Fraction(1, 10_000)
"""The default step of the simulation, in seconds."""
AGAIN = 8
"""The least number of motions that are simulated again with half the step."""
SAFETY = 2.0
"""The error is the change at half the step times this."""
NARROW = 1e-9
"""A tube narrower than this (SI) is a point, and has no faces."""
MOST_STEPS = 2_000_000_000
"""The most steps of all simulations together."""


@dataclass(frozen=True, slots=True)
class DisturbedRequest:
    """The numbers of the motions to simulate, and how.

    ``timestep`` is the longest step in seconds, None for the default; ``seed`` is the seed of the
    disturbances.
    """

    numbers: Sequence[int]
    seed: int
    timestep: Fraction | None = None
    integrator: str = "rk4"


@dataclass(frozen=True, slots=True)
class Reached:
    """How close motions come to the faces of the tube, in one kind of quantity.

    Attributes:
        share: the largest distance from the centre relative to that of the faces, after the first
            instant, with its quantity and time; above 1 it is outside.
        motion: the number of that motion.
        outside: the largest distance from the tube, in SI.
        error: the assumed integration error, in SI.
    """

    share: Farthest
    motion: int
    outside: float
    error: float


@dataclass(frozen=True, slots=True)
class DisturbedReplay:
    """The result of a replay; ``left`` are the numbers of the motions that left the tube.

    ``again`` is how many motions were also simulated with half the step, and ``verified`` the
    report of the verifier on the certificate.
    """

    request: DisturbedRequest
    version: str
    timestep: Fraction
    samples: int
    again: int
    left: tuple[int, ...]
    coordinates: Reached | None
    rates: Reached | None
    inputs: Reached | None
    verified: Report


def disturbed_replay(
    folder: Path, request: DisturbedRequest, part: Callable[[int, int], None] = untold
) -> DisturbedReplay:
    """Simulate disturbed motions of a result folder, and compare them with its tube at all samples.

    ``part`` is called with the number of parts simulated and their total.

    Raises:
        UsageFault: there is no robot, its task has no disturbances, MuJoCo cannot simulate it, or a
            simulation diverges.
        NoAnswer: the motions cannot be enclosed.
    """
    design = found_design(folder)
    if design.task.robust is None:
        raise UsageFault(f"{folder}: the task names no disturbances (`robust ...`)")
    mujoco, text = mujoco_module(), mujoco_text(design)
    count = max(1, ceil(design.task.step / (request.timestep or USUAL_STEP)))
    if count * design.task.steps * len(request.numbers) > MOST_STEPS:
        raise UsageFault(
            f"that is more than {MOST_STEPS} steps; choose a longer --timestep, or fewer motions"
        )
    tube = found_tube(folder)
    steps, n = design.task.steps, len(design.model.dofs)
    m, p = len(robot_inputs(design.model)), len(module_masses(design))
    drawn = disturbances(request.seed, request.numbers, steps, n, m, p)
    simulator = Simulator(mujoco, text, design, request.integrator, os.cpu_count() or 1)
    coarse = simulator.motions(drawn, count, part)
    names = _names(design)
    kinds = [
        _Kind(names[0], tube.samples[:, :n], coarse.states[..., :n]),
        _Kind(names[1], tube.samples[:, n:], coarse.states[..., n:]),
        _Kind(names[2], tube.commanded, coarse.commanded),
    ]
    shares = np.max([kind.farthest for kind in kinds], axis=0)
    nearest = np.argsort(-shares, kind="stable")[: max(AGAIN, int((shares > 1).sum()))]
    again = [int(i) for i in nearest]
    fine = simulator.motions(drawn.of(again), 2 * count)
    finer = fine.states[..., :n], fine.states[..., n:], fine.commanded
    errors = [
        SAFETY * float(np.abs(values - kind.values[again]).max(initial=0.0))
        for kind, values in zip(kinds, finer, strict=True)
    ]
    gone = [kind.beyond > error for kind, error in zip(kinds, errors, strict=True)]
    step = float(design.task.step)
    coordinates, rates, inputs = (
        _reached(kind, error, request.numbers, step)
        for kind, error in zip(kinds, errors, strict=True)
    )
    return DisturbedReplay(
        request,
        mujoco.__version__,
        design.task.step / count,
        steps + 1,
        len(again),
        tuple(request.numbers[int(i)] for i in np.flatnonzero(np.any(gone, axis=0))),
        coordinates,
        rates,
        inputs,
        verify_directory(folder),
    )


@dataclass(frozen=True, slots=True, eq=False)
class _Kind:
    """Quantities of one kind: names and units, bounds (k, n, 2) of the tube, values (B, k, n)."""

    names: Sequence[tuple[str, str]]
    bounds: Array
    values: Array

    @property
    def outside(self) -> Array:
        """The distances (B, k, n) from the tube; 0 inside."""
        lower, upper = self.bounds[..., 0], self.bounds[..., 1]
        found: Array = np.maximum(np.maximum(lower - self.values, self.values - upper), 0.0)
        return found

    @property
    def shares(self) -> Array:
        """The distances (B, k - 1, n) from the centre relative to those of the faces.

        The first instant is left out, since corners of the disturbances are at faces there.  Where
        the tube has almost no width, as for a joint held by dry friction, the value is 0.
        """
        lower, upper = self.bounds[1:, :, 0], self.bounds[1:, :, 1]
        width = upper - lower
        off = np.abs(2 * self.values[:, 1:] - (lower + upper))
        found: Array = np.where(width > NARROW, off / np.maximum(width, NARROW), 0.0)
        return found

    @property
    def farthest(self) -> Array:
        """The largest share (B,) of each motion."""
        found: Array = self.shares.reshape(len(self.values), -1).max(axis=1, initial=0.0)
        return found

    @property
    def beyond(self) -> Array:
        """The largest distance (B,) of each motion from the tube."""
        found: Array = self.outside.reshape(len(self.values), -1).max(axis=1, initial=0.0)
        return found


def _reached(kind: _Kind, error: float, numbers: Sequence[int], step: float) -> Reached | None:
    shares = kind.shares
    if not shares.size:
        return None
    row, sample, column = np.unravel_index(int(np.argmax(shares)), shares.shape)
    name, unit = kind.names[int(column)]
    share = Farthest(float(shares[row, sample, column]), unit, name, float(sample + 1) * step)
    return Reached(share, numbers[int(row)], float(kind.beyond.max(initial=0.0)), error)


def _names(design: FoundDesign) -> tuple[list[tuple[str, str]], ...]:
    """The names and units of coordinates, of rates and of inputs."""
    names = design_names(design, design_tree(design)).joints
    kinds = [dof.kind for dof in design.model.dofs]
    places = [(name, POSITION_UNITS[kind]) for name, kind in zip(names, kinds, strict=True)]
    inputs = [
        (names[item.dof], EFFORT_UNITS[kinds[item.dof]])
        for item in robot_inputs(design.model)
        if item.dof is not None
    ]
    return places, [(name, f"{unit}/s") for name, unit in places], inputs
