"""Motions of exported robots as MuJoCo's own accelerations make them, integrated by SciPy.

Nothing of the project is in it: only the text of the robot, and names.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import mujoco
import numpy as np
from scipy.integrate import solve_ivp

from compiler.arrays import Array
from tests.oracles.mujoco_dynamics import MujocoRobot


@dataclass(frozen=True)
class Sampled:
    """At the ends of the steps: times, states (q, v), accelerations, effectors (k, e, 3)."""

    times: Array
    states: Array
    accelerations: Array
    tips: Array


def sampled(
    text: str, claim: Mapping[str, Any], joints: Sequence[str], effectors: Sequence[str]
) -> Sampled:
    """The motion of a claim by DOP853; its inputs are the torques of the joints, in that order.

    Accelerations are those right after a sample; at the end, right before it.
    """
    robot, n = MujocoRobot(text, joints), len(joints)
    robot.model.opt.disableflags |= mujoco.mjtDisableBit.mjDSBL_CONSTRAINT
    dt = float(Fraction(claim["step"]))
    state = np.array([float(x) for x in claim["start"]])
    states, accelerations = [state], []

    def rate(_time: float, x: Array, u: Array) -> Array:
        robot.put(x[:n], x[n:], u)
        return np.concatenate([x[n:], robot.acceleration()])

    torques = [np.array([float(u) for u in row]) for row in claim["inputs"]]
    for u in torques:
        accelerations.append(rate(0, state, u)[n:])
        found = solve_ivp(rate, (0, dt), state, "DOP853", args=(u,), rtol=1e-12, atol=1e-13)
        assert found.success
        state = found.y[:, -1]
        states.append(state)
    accelerations.append(rate(0, state, torques[-1])[n:])
    tips = []
    for state in states:
        robot.put(state[:n], state[n:], 0 * state[:n])
        tips.append([robot.data.site(name).xpos.copy() for name in effectors])
    return Sampled(
        dt * np.arange(len(states)), np.array(states), np.array(accelerations), np.array(tips)
    )
