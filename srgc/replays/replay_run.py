"""Replay a result folder as requested, and measure how far the runs are from its tube."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from fractions import Fraction
from math import ceil
from pathlib import Path

import numpy as np
import scipy
from scipy.integrate import solve_ivp

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.state_and_input import dry_friction
from solvers.trajectory.rubbing_motion import rubbing_motion
from solvers.trajectory.trajectory import Trajectory
from solvers.verifier.certified_tube import CertifiedTube
from solvers.verifier.report import Report
from solvers.verifier.verification import verify_directory
from srgc.exports.exported_motion import POSITION_UNITS, planned_inputs
from srgc.exports.exported_robot import design_names, design_tree
from srgc.exports.mjcf import substeps
from srgc.faults import UsageFault
from srgc.replays.mujoco_replay import ReplayedMotion, refuse_unsimulable, replay_in_mujoco
from srgc.results.found_design import FoundDesign, found_design, found_tube

# --- A replay by a Runge-Kutta method of order eight, in doubles ----------------------------------
#
# Source: Dormand & Prince's DOP853 in SciPy (Hairer, Norsett & Wanner, *Solving Ordinary
# Differential Equations I*, II.5).  It integrates the same equations of motion as the verifier,
# including the modules' own dynamics, by another method and in other numbers.


RELATIVE, ABSOLUTE = 1e-13, 1e-15
INSTANTS = 8
"""The number of instants in each step of the task."""


def replay_in_python(design: FoundDesign) -> ReplayedMotion:
    """The motion under the inputs of a design, each held for its step.

    Raises:
        UsageFault: the motion has numbers that are not finite doubles, or the method fails.
    """
    planned = planned_inputs(design)
    numeric = NumericRobot(robot_graph(design.model, design.task.gravity))
    n, step = len(design.model.dofs), design.task.step

    def rate(_time: float, x: Array, u: Array) -> Array:
        rest = numeric.acceleration(x[None, :], u[None, :], planned.theta)[0][0]
        return np.concatenate([x[n : 2 * n], rest])

    within = np.linspace(0.0, float(step), INSTANTS + 1)
    states, feedback, rubs = [planned.x[0]], design.feedback, bool(dry_friction(design.model))
    for number, row in enumerate(planned.u):
        u = row if feedback is None else feedback.commanded(number, row, states[-1])
        if rubs:
            held = Trajectory(states[-1][None, :], u[None, :], planned.theta)
            states += list(rubbing_motion(numeric, held, float(step), INSTANTS)[1:])
            if not np.isfinite(states[-1]).all():
                raise UsageFault(f"the integration fails in step {number}")
            continue
        solution = solve_ivp(
            rate, (0.0, within[-1]), states[-1], "DOP853", within[1:], args=(u,),
            rtol=RELATIVE, atol=ABSOLUTE,
        )  # fmt: skip
        if not solution.success or not np.isfinite(solution.y).all():
            raise UsageFault(f"the integration fails in step {number}: {solution.message}")
        states += list(solution.y.T)
    times = [float(i * step / INSTANTS) for i in range(len(states))]
    found = np.array(states)
    tips = numeric.places(found[:, :n], planned.theta)
    return ReplayedMotion(
        "SciPy", scipy.__version__, "DOP853", None, np.array(times), found[:, : 2 * n], tips,
        INSTANTS,
    )  # fmt: skip


# --- The distance of a replayed motion from the certified tube ------------------------------------


@dataclass(frozen=True, slots=True)
class Farthest:
    """The largest distance, with its quantity, SI unit and time in seconds."""

    value: float
    unit: str
    name: str
    time: float


@dataclass(frozen=True, slots=True)
class Deviation:
    """The largest distances of one kind of quantity: outside the tube, and from its centre."""

    outside: Farthest
    middle: Farthest


@dataclass(frozen=True, slots=True)
class TubeComparison:
    """A replayed motion compared with the tube; a kind of quantity that is absent is None."""

    motion: ReplayedMotion
    coordinates: Deviation | None
    rates: Deviation | None
    effectors: Deviation | None


def tube_comparison(
    tube: CertifiedTube,
    motion: ReplayedMotion,
    joints: Sequence[tuple[str, str]],
    effectors: Sequence[str],
) -> TubeComparison:
    """Compare a motion with the tube; ``joints`` are names and units, ``effectors`` names."""
    n = len(joints)
    times = np.minimum(motion.times, tube.times[-1])
    outside, middle = tube.distances(times, motion.states)
    names = [name for name, _ in joints]
    units = [unit for _, unit in joints]

    def deviation(part: slice, suffix: str) -> Deviation | None:
        shown = [f"{unit}{suffix}" for unit in units]
        return _deviation(outside[:, part], middle[:, part], times, names, shown)

    beyond, apart = _effector_distances(tube, times, motion.effectors)
    metres = ["m"] * len(effectors)
    return TubeComparison(
        motion,
        deviation(slice(None, n), ""),
        deviation(slice(n, None), "/s"),
        _deviation(beyond, apart, times, effectors, metres),
    )


def _effector_distances(tube: CertifiedTube, times: Array, positions: Array) -> tuple[Array, Array]:
    """Distances (k, e) of effectors from their boxes, 0 inside, and from the boxes' centres."""
    count = positions.shape[1]
    boxes = np.array([tube.points_at(float(time))[:count] for time in times])
    boxes = boxes.reshape(*positions.shape, 2)
    lower, upper = boxes[..., 0], boxes[..., 1]
    gaps = np.maximum(np.maximum(lower - positions, positions - upper), 0.0)
    middles = positions - (lower + upper) / 2
    return np.linalg.norm(gaps, axis=2), np.linalg.norm(middles, axis=2)


def _deviation(
    outside: Array, middle: Array, times: Array, names: Sequence[str], units: Sequence[str]
) -> Deviation | None:
    if not names:
        return None
    return Deviation(*(_farthest(table, times, names, units) for table in (outside, middle)))


def _farthest(table: Array, times: Array, names: Sequence[str], units: Sequence[str]) -> Farthest:
    row, column = (int(i) for i in np.unravel_index(int(np.argmax(table)), table.shape))
    return Farthest(float(table[row, column]), units[column], names[column], float(times[row]))


# --------------------------------------------------------------------------------------------------
# Requests, and the runs of a replay.


@dataclass(frozen=True, slots=True)
class ReplayRequest:
    """The simulator of a replay, and its settings.

    ``timestep`` is the longest step in seconds, None for the default; each of the ``halvings``
    divides it by two.
    """

    simulator: str
    timestep: Fraction | None
    integrator: str
    halvings: int


@dataclass(frozen=True, slots=True)
class Replay:
    """The runs, one for each time step, and properties of the tube.

    ``half_width`` is the largest of coordinates and rates at the instants compared in the last run
    (SI), None if there are none.  ``verified`` is the report of the verifier on the certificate.  A
    tube that is ``disturbed`` contains more than the planned motion; if the task ``repeats``, it
    contains all rounds.
    """

    runs: tuple[TubeComparison, ...]
    disturbed: bool
    repeats: bool
    half_width: float | None
    verified: Report


def replay(folder: Path, request: ReplayRequest) -> Replay:
    """Replay the inputs of a result folder and compare with its tube.

    Raises:
        UsageFault: there is no robot, or the simulator cannot simulate it.
        NoAnswer: the motion cannot be enclosed.
    """
    design = found_design(folder)
    if request.simulator == "mujoco":
        refuse_unsimulable(design, _count(design, request) * 2**request.halvings)
    # Before the motions: without a tube they may reach any speed.
    tube = found_tube(folder)
    motions = list(_motions(design, request))
    names = design_names(design, design_tree(design))
    units = [POSITION_UNITS[dof.kind] for dof in design.model.dofs]
    joints = list(zip(names.joints, units, strict=True))
    runs = tuple(tube_comparison(tube, motion, joints, names.effectors) for motion in motions)
    width = _half_width(tube, motions[-1])
    return Replay(runs, tube.disturbed, design.task.repeat, width, verify_directory(folder))


def _motions(design: FoundDesign, request: ReplayRequest) -> Iterator[ReplayedMotion]:
    if request.simulator == "python":
        yield replay_in_python(design)
        return
    count = _count(design, request)
    for halving in range(request.halvings + 1):
        yield replay_in_mujoco(design, count * 2**halving, request.integrator)


def _count(design: FoundDesign, request: ReplayRequest) -> int:
    """The number of steps of the first simulation in a step of the task."""
    if request.timestep is None:
        return substeps(design.task.step)
    return max(1, ceil(design.task.step / request.timestep))


def _half_width(tube: CertifiedTube, motion: ReplayedMotion) -> float | None:
    widths = [
        float((bounds[:, 1] - bounds[:, 0]).max(initial=0.0)) / 2
        for time in motion.times
        if (bounds := tube.at(min(float(time), float(tube.times[-1])))).size
    ]
    return max(widths, default=None)
