"""Found robots driven in MuJoCo, by its own Runge-Kutta method, from what `srgc export` writes."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import mujoco
import numpy as np

from compiler.arrays import Array


@dataclass(frozen=True)
class Replay:
    """States (q, v) in the order of the word, at ``substeps`` times per step and at the end.

    ``tips`` are the sites of the effectors, (samples, effectors, 3).
    """

    substeps: int
    times: Array
    states: Array
    tips: Array


def replay(text: str, certificate: Mapping[str, Any]) -> Replay:
    """Hold every input of a certificate for its step, from its start, at the model's time step."""
    model = mujoco.MjModel.from_xml_string(text)
    data = mujoco.MjData(model)
    assert model.opt.integrator == mujoco.mjtIntegrator.mjINT_RK4
    names = sorted((model.joint(i).name for i in range(model.njnt)), key=_symbol)
    q = np.array([model.joint(name).qposadr[0] for name in names], dtype=int)
    v = np.array([model.joint(name).dofadr[0] for name in names], dtype=int)
    motors = [model.actuator(name).id for name in names]
    sites = sorted(range(model.nsite), key=lambda i: _symbol(model.site(i).name))
    start = np.array([float(x) for x in certificate["start"]])
    data.qpos[q], data.qvel[v] = start[: len(q)], start[len(q) :]
    dt = Fraction(certificate["step"])
    substeps = round(float(dt) / model.opt.timestep)
    assert abs(substeps * model.opt.timestep - float(dt)) < 1e-12
    states, tips = [], []

    def record() -> None:
        states.append(np.concatenate([data.qpos[q], data.qvel[v]]))
        mujoco.mj_kinematics(model, data)
        tips.append(data.site_xpos[sites].copy())

    record()
    for row in certificate["inputs"]:
        data.ctrl[motors] = [float(u) for u in row]
        for _ in range(substeps):
            mujoco.mj_step(model, data)
            record()
    times = np.arange(len(states)) * model.opt.timestep
    return Replay(substeps, times, np.array(states), np.array(tips))


def _symbol(name: str) -> int:
    """The place in the word of a part named ``JO_2``."""
    return int(name.rpartition("_")[2])
