"""Hold the planned inputs in MuJoCo, and record the resulting motion."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from fractions import Fraction
from importlib import import_module
from itertools import pairwise
from types import ModuleType
from typing import Any

import numpy as np
from numpy.typing import NDArray

from compiler.arrays import Array
from solvers.trajectory.trajectory import Trajectory
from srgc.exports.design_export import mujoco_text
from srgc.exports.exported_motion import free_inputs, planned_inputs
from srgc.exports.exported_robot import (
    body_factors,
    design_names,
    design_tree,
    load_rows,
    load_states,
)
from srgc.faults import UsageFault
from srgc.results.found_design import FoundDesign

# --- A motion from another simulator --------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class ReplayedMotion:
    """States and effectors at k instants of a motion, in SI units.

    Attributes:
        simulator: its name.
        version: its version.
        method: its integration method.
        timestep: its time step in seconds; None if it chooses its own.
        times: (k,) in seconds.
        states: (k, 2 n) coordinates, then rates, in the order of the degrees of freedom.
        effectors: (k, e, d) positions.
        parts: the number of instants in each step of the task, including its end.
    """

    simulator: str
    version: str
    method: str
    timestep: Fraction | None
    times: Array
    states: Array
    effectors: Array
    parts: int

    def at_steps(self) -> Array:
        """The states (steps + 1, 2 n) at the ends of the steps of the task."""
        return self.states[:: self.parts]


# --- The replay in MuJoCo (Todorov, Erez & Tassa, IROS 2012) --------------------------------------


INTEGRATORS = {
    "rk4": "mjINT_RK4",
    "euler": "mjINT_EULER",
    "implicit": "mjINT_IMPLICIT",
    "implicitfast": "mjINT_IMPLICITFAST",
}
MOST_STEPS = 100_000_000
MOST_INSTANTS = 20_000
"""The most instants that are compared; they always include the ends of the task's steps."""


@dataclass(frozen=True, slots=True, eq=False)
class JointPlaces:
    """The indices of coordinates, rates, inputs and effectors in MuJoCo, in our order."""

    q: NDArray[np.int_]
    v: NDArray[np.int_]
    motors: NDArray[np.int_]
    sites: NDArray[np.int_]


def replay_in_mujoco(design: FoundDesign, count: int, integrator: str) -> ReplayedMotion:
    """The motion under the inputs of a design, each held for its step.

    Args:
        design: the design.
        count: the number of simulation steps in a step of the task.
        integrator: one of the ``INTEGRATORS``.

    Raises:
        UsageFault: see ``refuse_unsimulable``; or the simulation diverges.
    """
    mujoco, text = refuse_unsimulable(design, count)
    step, planned = design.task.step, planned_inputs(design)
    model = loaded_model(mujoco, text, step / count, integrator)
    models = {
        loads: loaded_model(
            mujoco, mujoco_text(design, body_factors(design, loads)), step / count, integrator
        )
        for loads in load_states(design)[1:]
    }
    with silent(mujoco):
        parts = _parts(count, max(1, MOST_INSTANTS // len(planned.u)))
        times, states, tips = _simulated(mujoco, model, models, design, planned, parts)
    if not (np.isfinite(states).all() and np.isfinite(tips).all()):
        raise UsageFault(
            f"MuJoCo's simulation diverges with steps of {model.opt.timestep:g} s ({integrator})"
        )
    return ReplayedMotion(
        "MuJoCo", mujoco.__version__, integrator, step / count, times, states, tips, len(parts)
    )


def refuse_unsimulable(design: FoundDesign, count: int) -> tuple[ModuleType, str]:
    """MuJoCo and its model of a robot, for ``count`` simulation steps in a step of the task.

    Raises:
        UsageFault: MuJoCo cannot be loaded, MJCF cannot represent the robot, or there are too many
            steps.
    """
    mujoco, text = mujoco_module(), mujoco_text(design)
    if count * design.task.steps > MOST_STEPS:
        raise UsageFault(f"that is more than {MOST_STEPS} steps; choose a longer --timestep")
    return mujoco, text


def loaded_model(mujoco: ModuleType, text: str, timestep: Fraction, integrator: str) -> Any:
    """The model of an MJCF with a time step in seconds and one of the ``INTEGRATORS``.

    Raises:
        UsageFault: MuJoCo does not accept the robot, such as one with hardly any mass.
    """
    try:
        model = mujoco.MjModel.from_xml_string(text)
    except ValueError as error:
        raise UsageFault(
            f"MuJoCo does not accept the robot: {' '.join(str(error).split())}"
        ) from None
    model.opt.timestep = float(timestep)
    model.opt.integrator = getattr(mujoco.mjtIntegrator, INTEGRATORS[integrator])
    # A diverging simulation must not restart unnoticed.
    model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET
    return model


def mujoco_module() -> ModuleType:
    """The MuJoCo library.

    Raises:
        UsageFault: it is not installed, or cannot be loaded.
    """
    try:
        return import_module("mujoco")
    except ModuleNotFoundError:
        raise UsageFault(
            'MuJoCo is not installed; it comes with: pip install "srgc[mujoco]"'
        ) from None
    except Exception as error:
        # Any error may occur while it looks for a way to render.
        raise UsageFault(f"MuJoCo cannot be loaded: {error}") from None


def _simulated(
    mujoco: ModuleType,
    model: Any,
    loaded: Mapping[tuple[float, ...], Any],
    design: FoundDesign,
    planned: Trajectory,
    parts: Sequence[int],
) -> tuple[Array, Array, Array]:
    """Times, states and effectors, recorded after ``parts`` of the simulation steps of a task step.

    ``loaded`` are models of the same robot with loads.
    """
    data, places = mujoco.MjData(model), joint_places(model, design)
    n, step = len(design.model.dofs), design.task.step
    data.qpos[places.q], data.qvel[places.v] = planned.x[0, :n], planned.x[0, n:]
    instants, states, tips = list[float](), list[Array](), list[Array]()

    def record(time: Fraction) -> None:
        mujoco.mj_kinematics(model, data)
        instants.append(float(time))
        states.append(np.concatenate([data.qpos[places.q], data.qvel[places.v]]))
        tips.append(data.site_xpos[places.sites][:, : design.model.dimension])

    record(Fraction(0))
    feedback, columns = design.feedback, free_inputs(design.model)
    for number, (row, loads) in enumerate(zip(planned.u, load_rows(design), strict=True)):
        held = row if feedback is None else feedback.commanded(number, row, states[-1])
        data.ctrl[places.motors] = held[columns]
        done = 0
        for part in parts:
            mujoco.mj_step(loaded.get(loads, model), data, nstep=part)
            done += part
            record((number + Fraction(done, sum(parts))) * step)
    return np.array(instants), np.array(states), np.array(tips)


def _parts(count: int, most: int) -> list[int]:
    """Split a number into at most ``most`` positive parts that differ by at most one."""
    pieces = min(count, most)
    ends = [count * i // pieces for i in range(pieces + 1)]
    return [after - before for before, after in pairwise(ends)]


def joint_places(model: Any, design: FoundDesign) -> JointPlaces:
    """The indices of the joints of a design in its model."""
    names = design_names(design, design_tree(design))
    joints = [model.joint(name) for name in names.joints]
    return JointPlaces(
        np.array([joint.qposadr[0] for joint in joints], dtype=int),
        np.array([joint.dofadr[0] for joint in joints], dtype=int),
        np.array([model.actuator(name).id for name in names.joints], dtype=int),
        np.array([model.site(name).id for name in names.effectors], dtype=int),
    )


@contextmanager
def silent(mujoco: ModuleType) -> Iterator[None]:
    """Suppress MuJoCo's own warnings, which it would also write to a file."""
    before = mujoco.get_mju_user_warning()
    mujoco.set_mju_user_warning(lambda _message: None)
    try:
        yield
    finally:
        mujoco.set_mju_user_warning(before)
