"""The dynamics of a model as MuJoCo computes them, in the order of our degrees of freedom."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

import mujoco
import numpy as np

from compiler.arrays import Array


class MujocoRobot:
    """A model from its text; ``joints`` are the names of the joints in our order."""

    def __init__(self, text: str, joints: Sequence[str]) -> None:
        self.model = mujoco.MjModel.from_xml_string(text)
        self.data = mujoco.MjData(self.model)
        assert self.model.nv == self.model.nq == len(joints)
        places = [self.model.joint(name) for name in joints]
        self.positions = np.array([int(place.qposadr[0]) for place in places], dtype=int)
        self.rates = np.array([int(place.dofadr[0]) for place in places], dtype=int)

    def put(self, q: Array, v: Array, u: Array) -> None:
        """A state with forces at the joints."""
        self.data.qpos[self.positions] = q
        self.data.qvel[self.rates] = v
        self.data.qfrc_applied[self.rates] = u
        mujoco.mj_forward(self.model, self.data)

    def mass_matrix(self) -> Array:
        full = np.zeros((self.model.nv, self.model.nv))
        mujoco.mj_fullM(self.model, self.data, full)
        return full[np.ix_(self.rates, self.rates)]

    def bias(self) -> Array:
        return np.array(self.data.qfrc_bias[self.rates])

    def acceleration(self) -> Array:
        return np.array(self.data.qacc[self.rates])


def of_file(file: Path) -> MujocoRobot:
    """An exported robot, its joints in their order in the file."""
    model = mujoco.MjModel.from_xml_path(str(file))
    names = [model.joint(number).name for number in range(model.njnt)]
    return MujocoRobot(file.read_text(encoding="utf-8"), names)
