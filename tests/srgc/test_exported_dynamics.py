"""Exported robots in MuJoCo: M, c + g and accelerations of its own algorithms are ours.

MuJoCo computes by composite rigid bodies and recursive Newton-Euler; we by Lagrange's equations.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from compiler.arrays import Array
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.robot import WORLD, RobotModel
from srgc.exports.mjcf import mjcf_text
from srgc.exports.urdf import urdf_text
from tests.oracles.exported_robots import exported, random_lengths, solid_robot
from tests.oracles.mujoco_dynamics import MujocoRobot
from tests.oracles.robots import Builder, evaluate, rod_chain
from tests.oracles.some_cases import some

RELATIVE = 1e-9
PULL = {2: (Fraction(5, 3), Fraction(-981, 100)), 3: (Fraction(1, 3), Fraction(-2), Fraction(-9))}
CASES = [
    (joints, dimension, tree) for joints in range(1, 8) for dimension in (2, 3) for tree in (0, 1)
]


def close(found: Array, expected: Array) -> None:
    """Equal within ``RELATIVE`` of the largest entry."""
    scale = np.abs(expected).max()
    assert scale > 0
    np.testing.assert_allclose(found, expected, rtol=0, atol=RELATIVE * scale)


def agree(
    model: RobotModel, theta: tuple[Fraction, ...], other: MujocoRobot, seed: int, states: int = 3
) -> None:
    """M, c + g and accelerations at random states."""
    graph = robot_graph(model, PULL[model.dimension])
    rng, n = np.random.default_rng(seed), len(model.dofs)
    values = np.array([float(value) for value in theta])
    for _ in range(states):
        q, v, u = rng.uniform(-2.5, 2.5, n), rng.uniform(-2, 2, n), rng.uniform(-9, 9, n)
        other.put(q, v, u)
        close(other.mass_matrix(), evaluate(graph, "mass_matrix", q, values))
        close(other.bias(), evaluate(graph, "bias", q, v, values))
        close(other.acceleration(), evaluate(graph, "acceleration", q, v, u, values))


def simulated(model: RobotModel, theta: tuple[Fraction, ...]) -> MujocoRobot:
    robot = exported(model, theta, PULL[model.dimension])
    return MujocoRobot(mjcf_text(robot), robot.names.joints)


@pytest.mark.parametrize(("joints", "dimension", "tree"), some(CASES, 16))
def test_random_robots(joints: int, dimension: int, tree: int) -> None:
    for seed in range(3 if joints < 4 else 1):
        model = solid_robot(seed, dimension, joints, tree=bool(tree))
        theta = random_lengths(seed, model)
        agree(model, theta, simulated(model, theta), seed)


@pytest.mark.parametrize("links", [1, 3])
def test_thin_rods_in_the_plane(links: int) -> None:
    """What a thin rod is given as moment of inertia about itself does not matter."""
    model = rod_chain(links, [Fraction(i + 2, 3) for i in range(links)])
    theta = tuple(Fraction(3 + i, 2) for i in range(links))
    agree(model, theta, simulated(model, theta), links)


def test_point_masses_in_the_plane() -> None:
    builder, frame = Builder(), WORLD
    for length in (Fraction(3, 2), Fraction(1, 2)):
        frame = builder.move(builder.joint(frame), "x", builder.number(length))
        builder.point(frame, builder.number(length))
    model = builder.build()
    agree(model, (), simulated(model, ()), 3)


def wrist() -> RobotModel:
    """Massless links between three joints, the first of them at distances and turned."""
    builder = Builder(3)
    third = Fraction(1, 3)
    frame = builder.turn(builder.move(WORLD, "y", builder.number(2)), "x", builder.number(third))
    first = builder.joint(frame, "z")
    second = builder.joint(builder.move(first, "x", builder.number(third)), "-y", "prismatic")
    turned = builder.turn(second, "-z", builder.number(Fraction(5, 7)))
    third_joint = builder.joint(builder.move(turned, "z", builder.number(1)), "-x")
    builder.solid(third_joint, 2, (Fraction(1, 4), third, 1), (1, 2, 2, third, 0, Fraction(1, 4)))
    builder.effector(builder.move(third_joint, "x", builder.number(1)))
    return builder.build()


def test_links_without_mass() -> None:
    agree(wrist(), (), simulated(wrist(), ()), 4)


def test_a_massless_link_that_branches_or_holds_an_effector() -> None:
    """It has to be a body of its own, and is given as little as MuJoCo takes."""
    builder = Builder(3)
    trunk = builder.joint(WORLD, "y")
    builder.effector(builder.move(trunk, "z", builder.number(1)))
    for axis, sign in (("x", 1), ("z", -1)):
        arm = builder.joint(builder.move(trunk, axis, builder.number(sign)), axis)
        builder.solid(arm, 3, (sign, Fraction(1, 2), 0), (1, 1, 1, 0, Fraction(1, 9), 0))
    model = builder.build()
    agree(model, (), simulated(model, ()), 5)


@pytest.mark.parametrize(("joints", "dimension", "tree"), CASES[:16:3])
def test_the_urdf_has_the_same_mass_matrix(joints: int, dimension: int, tree: int) -> None:
    for seed in range(2):
        model = solid_robot(seed, dimension, joints, tree=bool(tree))
        theta = random_lengths(seed, model)
        robot = exported(model, theta)
        other = MujocoRobot(urdf_text(robot), robot.names.joints)
        graph, rng = robot_graph(model), np.random.default_rng(seed)
        values = np.array([float(value) for value in theta])
        for q in rng.uniform(-2.5, 2.5, (3, joints)):
            other.put(q, 0 * q, 0 * q)
            close(other.mass_matrix(), evaluate(graph, "mass_matrix", q, values))


def thin_rods() -> RobotModel:
    """A gripper's finger of 1 cm and 0.5 g on another, in space, with an effector at the tip."""
    builder, frame = Builder(3), WORLD
    for axis in ("z", "y"):
        frame = builder.joint(frame, axis)
        frame = builder.link(frame, builder.number(Fraction(1, 100)), "x", Fraction(1, 20))
    builder.effector(frame)
    return builder.build()


def test_small_thin_rods_in_space() -> None:
    """But for the moments about themselves, 1e-9 in URDF, they and their sums are exact."""
    model, q = thin_rods(), np.array([0.5, 0.4])
    expected = evaluate(robot_graph(model), "mass_matrix", q, np.array([]))
    assert expected[1, 1] == pytest.approx(5e-4 * 1e-4 / 3)
    for text, least in ((mjcf_text(exported(model)), 1e-12), (urdf_text(exported(model)), 1e-9)):
        other = MujocoRobot(text, exported(model).names.joints)
        other.put(q, 0 * q, 0 * q)
        found = other.mass_matrix()
        assert found[1, 1] == pytest.approx(expected[1, 1], rel=1e-9)
        # The first rod is across its axis; the second turns about z with part of its own moment
        # and, in URDF, with what the frame of the effector has on its axis (2e-9).
        along = np.sin(0.4) ** 2 * (least if least < 1e-9 else 3e-9)
        assert found[0, 0] - along == pytest.approx(expected[0, 0], rel=1e-9)


def test_laminas_in_space_are_taken() -> None:
    """Their moments of inertia are at the edge of the triangle inequality, and stay there."""
    for seed in range(20):
        builder, rng = Builder(3), np.random.default_rng(seed)
        frame = builder.turn(builder.joint(WORLD, "x"), "y", builder.number(seed))
        frame = builder.turn(frame, "z", builder.number(2 * seed))
        scale = Fraction(10) ** int(rng.integers(-6, 6))
        builder.solid(frame, scale, (0, 0, 0), (scale, 2 * scale, 3 * scale, 0, 0, 0))
        for text in (mjcf_text(exported(builder.build())), urdf_text(exported(builder.build()))):
            body = MujocoRobot(text, ["j1"]).model.body("l1")
            moments = sorted(body.inertia / float(scale))
            np.testing.assert_allclose(moments, [1, 2, 3], rtol=1e-11)


def test_sites_are_the_effectors() -> None:
    for seed, dimension in ((1, 2), (2, 3)):
        model = solid_robot(seed, dimension, 4, tree=True)
        theta = random_lengths(seed, model)
        other, graph = simulated(model, theta), robot_graph(model)
        q = np.random.default_rng(seed).uniform(-2.5, 2.5, 4)
        other.put(q, 0 * q, 0 * q)
        tips = evaluate(graph, "effectors", q, np.array([float(x) for x in theta]))
        found = np.array([other.data.site(f"e{i + 1}").xpos[:dimension] for i in range(2)])
        np.testing.assert_allclose(found.ravel(), tips, rtol=0, atol=1e-12)
