"""Simulate many motions in MuJoCo under the disturbances of a task.

Each motion has its own start, factor of all masses, measurement errors and input errors, within the
bounds of the task; a controller reads the state at each sample.  The disturbances are random, or at
corners of their bounds: those of motion i depend only on the seed and on i, not on the number of
motions.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from copy import copy
from dataclasses import dataclass
from types import ModuleType
from typing import Any

import numpy as np

from compiler.arrays import Array
from compiler.tasks.specification import (
    UncertainMass,
    disturbance_radii,
    input_errors,
    measurement_radii,
    uncertain_masses,
)
from grammar_lang import ir
from srgc.exports.design_export import mujoco_text
from srgc.exports.exported_motion import free_inputs, planned_inputs
from srgc.exports.exported_robot import body_factors, load_rows, load_states
from srgc.faults import UsageFault
from srgc.replays.mujoco_replay import joint_places, loaded_model, silent
from srgc.results.found_design import FoundDesign

MOST_NUMBERS = 4_000_000
"""The most numbers of states and inputs that are in memory at a time."""

# --- Disturbances ---------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class Disturbances:
    """The disturbances of B motions, as fractions from -1 to 1 of the bounds of a task.

    Attributes:
        start: (B, 2 n) of the initial coordinates and rates.
        mass: (B,) of all masses.
        measured: (B, k, 2 n) of the measurement at each sample.
        inputs: (B, k, m) of what is added to the inputs in each step.
        masses: (B, p) of the masses of single modules.
    """

    start: Array
    mass: Array
    measured: Array
    inputs: Array
    masses: Array

    def of(self, chosen: Sequence[int]) -> Disturbances:
        """The disturbances of some of the motions."""
        rows = list(chosen)
        return Disturbances(
            self.start[rows],
            self.mass[rows],
            self.measured[rows],
            self.inputs[rows],
            self.masses[rows],
        )


def disturbances(
    seed: int, numbers: Sequence[int], steps: int, n: int, m: int, p: int = 0
) -> Disturbances:
    """The disturbances of motions with these numbers, for p modules with uncertain masses.

    Motions with an even number are random.  The others are at corners of the bounds: number 4 i + 1
    with errors of constant sign, which carry it farthest; number 4 i + 3 with new signs in each
    step.
    """
    drawn = [_drawn(np.random.default_rng([seed, each]), each, steps, n, m, p) for each in numbers]
    parts = [np.array(part) for part in zip(*drawn, strict=True)]
    return Disturbances(*parts)


def _drawn(
    rng: np.random.Generator, number: int, steps: int, n: int, m: int, p: int
) -> tuple[Array, float, Array, Array, Array]:
    corner = number % 2 == 1

    def parts(*shape: int) -> Array:
        found: Array = rng.choice((-1.0, 1.0), shape) if corner else rng.uniform(-1, 1, shape)
        return found

    start, mass = parts(2 * n), float(parts(1)[0])
    if number % 4 == 1:
        measured, inputs = np.tile(parts(2 * n), (steps, 1)), np.tile(parts(m), (steps, 1))
    else:
        measured, inputs = parts(steps, 2 * n), parts(steps, m)
    # This comes last, so that the others do not depend on p.
    return start, mass, measured, inputs, parts(p)


# --- The motions ----------------------------------------------------------------------------------


@dataclass(frozen=True, slots=True, eq=False)
class SimulatedMotions:
    """B motions at the ends of k steps: ``states`` (B, k + 1, 2 n), ``commanded`` (B, k, m)."""

    states: Array
    commanded: Array


def untold(_done: int, _count: int) -> None:
    """Ignore the progress of a simulation."""


@dataclass(frozen=True, slots=True, eq=False)
class Simulator:
    """MuJoCo with the robot of a design: its MJCF ``text``, and ``threads`` to run in parallel."""

    mujoco: ModuleType
    text: str
    design: FoundDesign
    integrator: str
    threads: int

    def motions(
        self, disturbed: Disturbances, count: int, part: Callable[[int, int], None] = untold
    ) -> SimulatedMotions:
        """Simulate motions with ``count`` simulation steps in each step of the task.

        ``part`` is called with the number of parts done and their total.

        Raises:
            UsageFault: a simulation diverges.
        """
        model = loaded_model(self.mujoco, self.text, self.design.task.step / count, self.integrator)
        # Inputs with errors may exceed the commanded range; stops at joint ranges must not help.
        flags = self.mujoco.mjtDisableBit
        model.opt.disableflags |= flags.mjDSBL_CLAMPCTRL | flags.mjDSBL_LIMIT
        width = count * (1 + model.nq + model.nv + model.nu)
        size = max(1, MOST_NUMBERS // width)
        every, steps = range(len(disturbed.mass)), self.design.task.steps
        firsts, chunks = every[::size], list[SimulatedMotions]()
        for place, first in enumerate(firsts):

            def step(done: int, before: int = place * steps) -> None:
                part(before + done, len(firsts) * steps)

            chosen = disturbed.of(every[first : first + size])
            chunks.append(self._together(model, chosen, count, step))
        found = SimulatedMotions(
            np.concatenate([each.states for each in chunks]),
            np.concatenate([each.commanded for each in chunks]),
        )
        if not np.isfinite(found.states).all():
            raise UsageFault(
                f"MuJoCo's simulation diverges with steps of {model.opt.timestep:g} s "
                f"({self.integrator})"
            )
        return found

    def _together(
        self, model: Any, disturbed: Disturbances, count: int, told: Callable[[int], None]
    ) -> SimulatedMotions:
        """Simulate motions together; ``told`` is called with the number of task steps done."""
        # The import loads another library.
        from mujoco import rollout

        design, places = self.design, joint_places(model, self.design)
        bounds, planned = disturbance_bounds(design), planned_inputs(design)
        n, columns, feedback = len(design.model.dofs), free_inputs(design.model), design.feedback
        models = {
            loads: [
                self._weighed(self._model(model, bounds, own, loads), 1 + bounds.mass * part)
                for part, own in zip(disturbed.mass, disturbed.masses, strict=True)
            ]
            for loads in load_states(design)
        }
        rows, every = load_rows(design), len(disturbed.mass)
        full = np.zeros((every, 1 + model.nq + model.nv))
        control = np.zeros((every, 1, model.nu))
        at_q, at_v = 1 + places.q, 1 + model.nq + places.v
        states = np.zeros((every, len(planned.u) + 1, 2 * n))
        states[:, 0] = planned.x[0, : 2 * n] + bounds.start * disturbed.start
        full[:, at_q], full[:, at_v] = states[:, 0, :n], states[:, 0, n:]
        commanded = np.zeros((every, *planned.u.shape))
        data = [self.mujoco.MjData(model) for _ in range(self.threads)]
        with (
            np.errstate(all="ignore"),
            silent(self.mujoco),
            rollout.Rollout(nthread=self.threads) as pool,
        ):
            for k, u in enumerate(planned.u):
                commanded[:, k] = u
                if feedback is not None:
                    read = states[:, k] + bounds.measured * disturbed.measured[:, k]
                    commanded[:, k] -= (read - feedback.reference[k]) @ feedback.gains[k].T
                errors = bounds.part * np.abs(commanded[:, k]) + bounds.most
                applied = commanded[:, k] + errors * disturbed.inputs[:, k]
                control[:, 0, places.motors] = applied[:, columns]
                full = pool.rollout(models[rows[k]], data, full, control, nstep=count)[0][:, -1]
                states[:, k + 1, :n], states[:, k + 1, n:] = full[:, at_q], full[:, at_v]
                told(k + 1)
        return SimulatedMotions(states, commanded)

    def _model(
        self, model: Any, bounds: DisturbanceBounds, parts: Array, loads: Sequence[float]
    ) -> Any:
        """The model with loads, and masses changed by ``parts`` (p,) of their bounds."""
        if not bounds.masses and not any(loads):
            return model
        factors = np.array(body_factors(self.design, loads))
        for item, part in zip(bounds.masses, parts, strict=True):
            factors[list(item.bodies)] *= 1 + float(item.part) * part
        text = mujoco_text(self.design, factors.tolist())
        found = loaded_model(self.mujoco, text, self.design.task.step, self.integrator)
        found.opt.timestep, found.opt.disableflags = model.opt.timestep, model.opt.disableflags
        return found

    def _weighed(self, model: Any, factor: float) -> Any:
        """The model with all masses and inertias multiplied by a factor."""
        if factor == 1:
            return model
        found = copy(model)
        found.body_mass[:] *= factor
        found.body_inertia[:] *= factor
        self.mujoco.mj_setConst(found, self.mujoco.MjData(found))
        return found


@dataclass(frozen=True, slots=True, eq=False)
class DisturbanceBounds:
    """The bounds of a task in doubles and SI units.

    Attributes:
        start, measured: (2 n,) of coordinates and rates.
        part, most: (m,) each; an input may be off by this share of itself plus this amount.
        mass: of all masses, as a share.
        masses: in addition, of single modules, with the bodies of each.
    """

    start: Array
    measured: Array
    part: Array | float
    most: Array
    mass: float
    masses: tuple[UncertainMass, ...] = ()


def disturbance_bounds(design: FoundDesign) -> DisturbanceBounds:
    """The bounds of a design's task; zeros without ``robust``."""
    task, model = design.task, design.model
    parts, most = input_errors(task, model)
    return DisturbanceBounds(
        np.array(disturbance_radii(task, model), dtype=np.float64),
        np.array(measurement_radii(task, model), dtype=np.float64),
        np.array(parts, dtype=np.float64),
        np.array(most, dtype=np.float64),
        float((task.robust or ir.Robust()).mass),
        module_masses(design),
    )


def module_masses(design: FoundDesign) -> tuple[UncertainMass, ...]:
    """The uncertain masses of single modules, for each occurrence of a module the task names."""
    task, model = design.task, design.model
    found = uncertain_masses(task, model)
    return found[1:] if task.robust is not None and task.robust.mass and model.bodies else found
