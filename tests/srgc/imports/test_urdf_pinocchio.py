"""Robots imported from URDF move as in Pinocchio, which reads the same file; so do they again
when they were exported and imported once more."""

from __future__ import annotations

import re
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

import srgc
from compiler.robots.robot import RobotModel
from srgc.exports.urdf import urdf_text
from srgc.imports.urdf.urdf_import import urdf_import
from tests.conftest import ROOT
from tests.oracles.exported_robots import exported

GRAVITY = (0.7, -1.3, -9.6)
TASK = """
workspace W {
  space xyz;
  bounds box [-9, 9] x [-9, 9] x [-9, 9] m;
  target T box [0, 1] x [0, 1] x [0, 1] m;
}
task Task { robot %s; workspace W; start in T; reach T; effort <= 1 N*m; effort <= 1 N;
  gravity (0.7, -1.3, -9.6) m/s^2; horizon 2 steps of 0.1 s; }
"""
CLOSE = 1e-9


def package() -> Path:
    """Where example-robot-data has its files."""
    import pinocchio

    roots = Path(pinocchio.__file__).parents
    return next(
        found for root in roots if (found := root / "share" / "example-robot-data").is_dir()
    )


ROBOTS = {
    "ur5": ("ur_description/urdf/ur5_robot.urdf", {}, "ee_link"),
    "panda": (
        "panda_description/urdf/panda.urdf",
        {"panda_finger_joint1": 0.03, "panda_finger_joint2": 0.03},
        "panda_hand",
    ),
    "kinova": (
        "kinova_description/robots/kinova.urdf",
        {},
        "j2s6s200_end_effector",
    ),
    "scara": ("", {}, "tip"),
}


def file_of(name: str) -> Path:
    path = ROBOTS[name][0]
    return package() / "robots" / path if path else ROOT / "specs" / "robots" / "scara.urdf"


class Peer:
    """The robot of a URDF in Pinocchio, joints that are held taken away."""

    def __init__(self, path: Path, held: dict[str, float], tip: str) -> None:
        import pinocchio

        self.pinocchio = pinocchio
        whole = pinocchio.buildModelFromUrdf(str(path))
        at = pinocchio.neutral(whole)
        for joint, value in held.items():
            at[whole.joints[whole.getJointId(joint)].idx_q] = value
        ids = [whole.getJointId(joint) for joint in held]
        self.model = pinocchio.buildReducedModel(whole, ids, at) if ids else whole
        self.model.gravity.linear = np.array(GRAVITY)
        self.data = self.model.createData()
        self.tip = self.model.getFrameId(tip)
        assert self.tip < self.model.nframes

    def at(self, q: np.ndarray) -> np.ndarray:
        """A configuration: of a joint without a range the cosine and sine."""
        full = np.zeros(self.model.nq)
        for joint in self.model.joints[1:]:
            value = q[joint.idx_v]
            full[joint.idx_q : joint.idx_q + joint.nq] = (
                [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]
            )
        return full


def agree(text: str, folder: Path, peer: Peer) -> RobotModel:
    """Tip, M, c and g at random states are those of the peer."""
    name = re.findall(r"^grammar (\w+) ", text, re.MULTILINE)[0]
    (folder / "robot.srg").write_text(text + TASK % name)
    program = srgc.load(folder / "robot.srg")
    (word,) = srgc.words(program, limit=2)
    robot = srgc.robot(program, word, task="Task")
    rng = np.random.default_rng(20261127)
    n = peer.model.nv
    assert len(robot.dofs) == n
    for _ in range(5):
        q, v = rng.uniform(-2.5, 2.5, n), rng.uniform(-2, 2, n)
        at = peer.at(q)
        peer.pinocchio.framesForwardKinematics(peer.model, peer.data, at)
        tip = peer.data.oMf[peer.tip].translation
        np.testing.assert_allclose(robot.effectors(q)[0], tip, rtol=0, atol=CLOSE)
        mass = np.array(peer.pinocchio.crba(peer.model, peer.data, at))
        mass = np.triu(mass) + np.triu(mass, 1).T - np.diag(peer.model.armature)
        near(robot.mass_matrix(q), mass)
        effort = peer.pinocchio.nonLinearEffects(peer.model, peer.data, at, v)
        near(robot.coriolis(q, v) + robot.gravity(q), np.array(effort))
    return robot.chosen.model


def near(found: np.ndarray, expected: np.ndarray) -> None:
    scale = max(1.0, np.abs(expected).max())
    np.testing.assert_allclose(found, expected, rtol=0, atol=CLOSE * scale)


@pytest.mark.slow
@pytest.mark.parametrize("name", ROBOTS)
def test_moves_as_in_pinocchio(name: str, tmp_path: Path) -> None:
    _, held, tip = ROBOTS[name]
    path = file_of(name)
    options = {"effectors": [tip], "fixed": [f"{joint}={value}" for joint, value in held.items()]}
    packages = [f"example-robot-data={package()}"]
    imported = urdf_import(path, exact=True, packages=packages, **options)
    for file, data in imported.files.items():
        (tmp_path / file).parent.mkdir(exist_ok=True)
        (tmp_path / file).write_bytes(data)
    peer = Peer(path, held, tip)
    model = agree(imported.text, tmp_path, peer)
    again = tmp_path / "again.urdf"
    again.write_text(urdf_text(exported(model, (), tuple(map(Fraction, GRAVITY)))))
    twice = urdf_import(again, exact=True, effectors=["e1"])
    agree(twice.text, tmp_path, peer)
