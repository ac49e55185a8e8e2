"""Exported robots in Pinocchio, a library of rigid-body dynamics that reads URDF."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from compiler.arrays import Array
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.robot import RobotModel
from srgc.exports.urdf import urdf_text
from tests.oracles.exported_robots import exported, random_lengths, solid_robot
from tests.oracles.robots import evaluate, rod_chain

PULL = {2: (Fraction(5, 3), Fraction(-981, 100)), 3: (Fraction(1, 3), Fraction(-2), Fraction(-9))}
RELATIVE = 1e-9


def close(found: Array, expected: Array) -> None:
    scale = np.abs(expected).max()
    assert scale > 0
    np.testing.assert_allclose(found, expected, rtol=0, atol=RELATIVE * scale)


class PinocchioRobot:
    """A robot of joints j1, j2, ..., read from URDF."""

    def __init__(self, text: str, gravity: tuple[Fraction, ...]) -> None:
        import pinocchio

        self.pinocchio = pinocchio
        self.model = pinocchio.buildModelFromXML(text)
        self.data = self.model.createData()
        joints = [self.model.getJointId(f"j{i + 1}") for i in range(self.model.nv)]
        self.joints = [self.model.joints[i] for i in joints]
        self.rates = np.array([joint.idx_v for joint in self.joints])
        pull = [*(float(value) for value in gravity), 0.0][:3]
        self.model.gravity.linear = np.array(pull)

    def configuration(self, q: Array) -> Array:
        """A joint without a range has the cosine and the sine of its angle."""
        full = np.zeros(self.model.nq)
        for joint, value in zip(self.joints, q, strict=True):
            entries = [value] if joint.nq == 1 else [np.cos(value), np.sin(value)]
            full[joint.idx_q : joint.idx_q + joint.nq] = entries
        return full

    def tangent(self, values: Array) -> Array:
        full = np.zeros(self.model.nv)
        full[self.rates] = values
        return full


def agree(model: RobotModel, theta: tuple[Fraction, ...], seed: int) -> None:
    """M by composite rigid bodies, c + g by Newton-Euler, accelerations by articulated bodies."""
    pull, n = PULL[model.dimension], len(model.dofs)
    other = PinocchioRobot(urdf_text(exported(model, theta, pull)), pull)
    graph, rng = robot_graph(model, pull), np.random.default_rng(seed)
    values = np.array([float(value) for value in theta])
    for _ in range(3):
        q, v, u = rng.uniform(-2.5, 2.5, n), rng.uniform(-2, 2, n), rng.uniform(-9, 9, n)
        at, rate, force = other.configuration(q), other.tangent(v), other.tangent(u)
        mass = np.array(other.pinocchio.crba(other.model, other.data, at))
        mass = np.triu(mass) + np.triu(mass, 1).T
        close(mass[np.ix_(other.rates, other.rates)], evaluate(graph, "mass_matrix", q, values))
        bias = np.array(other.pinocchio.nonLinearEffects(other.model, other.data, at, rate))
        close(bias[other.rates], evaluate(graph, "bias", q, v, values))
        found = np.array(other.pinocchio.aba(other.model, other.data, at, rate, force))
        close(found[other.rates], evaluate(graph, "acceleration", q, v, u, values))


@pytest.mark.slow
@pytest.mark.parametrize("tree", [False, True])
@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("joints", range(1, 8))
def test_random_robots(joints: int, dimension: int, tree: bool) -> None:
    for seed in range(2):
        model = solid_robot(seed, dimension, joints, tree=tree)
        agree(model, random_lengths(seed, model), seed)


@pytest.mark.slow
def test_rods_in_the_plane() -> None:
    agree(rod_chain(3), (Fraction(3, 2), Fraction(2), Fraction(1, 2)), 1)
