"""Equations of motion against formulas written by hand and a Lagrangian of point masses.

Two links in closed form: ``tests/errata/test_row_4_05.py`` and ``test_row_4_06.py``.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from numpy.typing import NDArray

from compiler.arrays import Array
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.expressions.scalars import Constant
from compiler.robots.robot import WORLD, FrameNode, RobotModel, Turn
from tests.oracles.lagrangian import PointCloud, rod_points
from tests.oracles.mass_points import mass_points
from tests.oracles.mixed_robots import mixed_robot
from tests.oracles.planar_chain import chain_dynamics
from tests.oracles.robots import Builder, evaluate, rod_chain

PULL = (Fraction(1, 3), Fraction(-981, 100))


def as_floats(values: tuple[Fraction, ...]) -> list[float]:
    return [float(value) for value in values]


@pytest.mark.parametrize("links", [1, 2, 3, 4, 5, 6])
def test_chains_of_rods_agree_with_the_absolute_angle_formula(links: int) -> None:
    rng = np.random.default_rng(links)
    densities = [Fraction(i + 2, 3) for i in range(links)]
    graph = robot_graph(rod_chain(links, densities), PULL)
    for _ in range(4):
        q, v, u = rng.uniform(-3, 3, links), rng.uniform(-2, 2, links), rng.uniform(-9, 9, links)
        theta = rng.uniform(0.5, 3, links)
        mass, coriolis, gravity = chain_dynamics(
            theta, np.array([float(d) for d in densities]), q, v, as_floats(PULL)
        )
        np.testing.assert_allclose(
            evaluate(graph, "mass_matrix", q, theta), mass, rtol=1e-10, atol=1e-10
        )
        bias = evaluate(graph, "bias", q, v, theta)
        np.testing.assert_allclose(bias, coriolis + gravity, rtol=1e-9, atol=1e-8)
        found = evaluate(graph, "acceleration", q, v, u, theta)
        residual = mass @ found + coriolis + gravity - u
        np.testing.assert_allclose(residual, 0, atol=1e-8 * (1 + np.abs(found).max() * mass.max()))


@pytest.mark.parametrize("links", [1, 2, 3])
def test_variation_is_the_jacobian_of_the_balance(links: int) -> None:
    """Central differences of r - M a at fixed a; at the acceleration itself r - M a is zero."""
    graph, rng = robot_graph(rod_chain(links), PULL), np.random.default_rng(links)
    q, v, u, a = (rng.uniform(-1, 1, links) for _ in range(4))
    theta = rng.uniform(1, 2, links)

    def residual(state: Array, pull: Array) -> Array:
        flat = evaluate(graph, "balance", state[:links], state[links:], u, theta)
        return flat[links**2 :] - flat[: links**2].reshape(links, links).T @ pull

    state, h = np.concatenate([q, v]), 1e-5
    own = evaluate(graph, "acceleration", q, v, u, theta)
    np.testing.assert_allclose(residual(state, own), 0, atol=1e-9)
    jacobian = evaluate(graph, "variation", q, v, a, u, theta).reshape(2 * links, links).T
    for j, unit in enumerate(np.eye(2 * links)):
        difference = residual(state + h * unit, a) - residual(state - h * unit, a)
        np.testing.assert_allclose(jacobian[:, j], difference / (2 * h), rtol=1e-5, atol=1e-5)


def compare(builder: Builder, cloud: PointCloud, pull: tuple[Fraction, ...], seed: int) -> None:
    """Model and cloud agree on M, c + g, and on the accelerations."""
    model = builder.build()
    graph, rng, n = robot_graph(model, pull), np.random.default_rng(seed), len(model.dofs)
    theta = np.zeros(0)
    for _ in range(5):
        q, v, u = rng.uniform(-2, 2, n), rng.uniform(-2, 2, n), rng.uniform(-5, 5, n)
        mass = cloud.mass_matrix(q)
        bias = cloud.coriolis(q, v) + cloud.gravity(q, as_floats(pull))
        np.testing.assert_allclose(
            evaluate(graph, "mass_matrix", q, theta), mass, rtol=1e-10, atol=1e-11
        )
        np.testing.assert_allclose(evaluate(graph, "bias", q, v, theta), bias, rtol=1e-6, atol=1e-7)
        found = evaluate(graph, "acceleration", q, v, u, theta)
        np.testing.assert_allclose(mass @ found + bias, u, atol=1e-5)


def direction(angle: complex) -> NDArray[np.complex128]:
    return np.array([np.cos(angle), np.sin(angle)])


@pytest.mark.parametrize("masses", [(3, 2), (Fraction(7, 5), Fraction(1, 3))])
def test_cart_with_a_pendulum(masses: tuple[Fraction, Fraction]) -> None:
    cart, bob = masses
    builder = Builder()
    rail = builder.joint(WORLD, "x", "prismatic")
    builder.point(rail, builder.number(cart))
    pivot = builder.joint(rail, "-z")
    tip = builder.move(pivot, "-y", builder.number(2))
    builder.point(tip, builder.number(bob))

    def positions(q: NDArray[np.complex128]) -> NDArray[np.complex128]:
        base = np.array([q[0], 0])
        # -y turned by q1 clockwise.
        return np.array([base, base + 2 * np.array([-np.sin(q[1]), -np.cos(q[1])])])

    compare(builder, PointCloud(np.array([float(cart), float(bob)]), positions), PULL, 3)


def test_collinear_prismatic_joints_with_integer_masses() -> None:
    builder = Builder()
    first = builder.joint(WORLD, "x", "prismatic")
    builder.point(first, builder.number(4))
    second = builder.joint(first, "x", "prismatic")
    builder.point(second, builder.number(3))
    cloud = PointCloud(
        np.array([4.0, 3.0]), lambda q: np.array([[q[0], 0 * q[0]], [q[0] + q[1], 0 * q[0]]])
    )
    compare(builder, cloud, PULL, 4)


def test_telescope_on_a_turret() -> None:
    builder = Builder()
    turret = builder.joint(WORLD)
    builder.rod(turret, "x", builder.number(Fraction(3, 2)), density=2)
    slide = builder.joint(builder.move(turret, "x", builder.number(1)), "x", "prismatic")
    builder.rod(slide, "x", builder.number(1))
    builder.rod(slide, "-y", builder.number(Fraction(1, 2)))

    def positions(q: NDArray[np.complex128]) -> NDArray[np.complex128]:
        along, across = direction(q[0]), direction(q[0] - np.pi / 2)
        root = (1 + q[1]) * along
        points = rod_points(0 * along, 1.5 * along)
        points += rod_points(root, root + along)
        return np.array(points + rod_points(root, root + across / 2))

    compare(builder, PointCloud(np.array([1.5, 1.5, 0.5, 0.5, 0.25, 0.25]), positions), PULL, 5)


def test_two_arms_on_one_base_joint() -> None:
    builder = Builder()
    trunk = builder.link(builder.joint(WORLD), builder.number(1))
    left = builder.joint(builder.turn(trunk, "z", builder.table.pi()))
    builder.rod(left, "x", builder.number(2))
    right = builder.joint(trunk)
    builder.rod(right, "y", builder.number(Fraction(1, 2)), density=3)

    def positions(q: NDArray[np.complex128]) -> NDArray[np.complex128]:
        top = direction(q[0])
        points = rod_points(0 * top, top)
        points += rod_points(top, top + 2 * direction(q[0] + np.pi + q[1]))
        return np.array(points + rod_points(top, top + direction(q[0] + q[2] + np.pi / 2) / 2))

    cloud = PointCloud(np.array([0.5, 0.5, 1.0, 1.0, 0.75, 0.75]), positions)
    compare(builder, cloud, PULL, 6)
    mass = evaluate(
        robot_graph(builder.build()), "mass_matrix", np.array([0.1, 0.7, -1.3]), np.zeros(0)
    )
    assert mass[1, 2] == 0


def test_solid_with_inertia_in_the_plane() -> None:
    builder = Builder()
    first = builder.joint(WORLD)
    # Four points of 1/4 kg at (+-a, 0), (0, +-b) about the com: inertia (a^2 + b^2) / 2.
    a, b = Fraction(3, 10), Fraction(1, 5)
    builder.solid(first, 1, (1, Fraction(1, 2), 0), [(a**2 + b**2) / 2])
    second = builder.joint(builder.move(first, "x", builder.number(1)))
    builder.solid(second, 1, (Fraction(1, 2), 0, 0), [(a**2 + b**2) / 2])

    def positions(q: NDArray[np.complex128]) -> NDArray[np.complex128]:
        x, y = direction(q[0]), direction(q[0] + np.pi / 2)
        z, w = direction(q[0] + q[1]), direction(q[0] + q[1] + np.pi / 2)
        points = []
        for com, e, f in ((x + y / 2, x, y), (x + z / 2, z, w)):
            points += [com + 0.3 * e, com - 0.3 * e, com + 0.2 * f, com - 0.2 * f]
        return np.array(points)

    compare(builder, PointCloud(np.full(8, 0.25), positions), PULL, 7)


def rotation_z(angle: complex) -> NDArray[np.complex128]:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, -s, 0], [s, c, 0], [0, 0, 1]])


def rotation_y(angle: complex) -> NDArray[np.complex128]:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])


def rotation_x(angle: complex) -> NDArray[np.complex128]:
    c, s = np.cos(angle), np.sin(angle)
    return np.array([[1, 0, 0], [0, c, -s], [0, s, c]])


TILT = [[2, -1, 2], [2, 2, -1], [-1, 2, 2]]  # times 1/3: a rotation with rational entries
HALF_AXES = (Fraction(1, 2), Fraction(1, 3), Fraction(1, 5))


def tilted_cloud() -> tuple[list[list[Fraction]], list[Fraction]]:
    """Six points of 1/3 kg about a com, and their inertia xx yy zz xy xz yz, exactly."""
    points = []
    for column, half in enumerate(HALF_AXES):
        for sign in (1, -1):
            points += [[Fraction(TILT[row][column], 3) * half * sign for row in range(3)]]
    inertia = []
    for i, j in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2)):
        trace = sum(sum(x * x for x in p) for p in points) if i == j else Fraction(0)
        inertia.append((trace - sum(p[i] * p[j] for p in points)) / 3)
    return points, inertia


def test_space_robot_about_z_then_y_with_a_tilted_solid_and_a_slide() -> None:
    points, inertia = tilted_cloud()
    builder = Builder(dimension=3)
    waist = builder.joint(WORLD, "z")
    shoulder = builder.joint(builder.link(waist, builder.number(1), "z"), "-y")
    elbow = builder.link(shoulder, builder.number(Fraction(3, 2)), "x", Fraction(4, 3))
    builder.solid(elbow, 2, (Fraction(1, 4), Fraction(1, 5), 0), inertia)
    slide = builder.joint(builder.turn(elbow, "x", builder.number(1)), "z", "prismatic")
    builder.point(slide, builder.number(Fraction(1, 2)))
    wrist = builder.joint(slide, "x")
    builder.rod(wrist, "y", builder.number(1), 2)
    builder.effector(wrist)

    def positions(q: NDArray[np.complex128]) -> NDArray[np.complex128]:
        zero = np.zeros(3, dtype=np.complex128)
        top = np.array([0, 0, 1 + 0j])
        turn = rotation_z(q[0]) @ rotation_y(-q[1])
        end = top + turn @ [1.5, 0, 0]
        result = [*rod_points(zero, top), *rod_points(top, end)]
        for point in points:
            local = np.array([float(x) for x in point]) + np.array([0.25, 0.2, 0])
            result.append(end + turn @ local)
        turn = turn @ rotation_x(1.0)
        hand = end + turn @ np.array([0, 0, q[2]])
        result.append(hand)
        turn = turn @ rotation_x(q[3])
        return np.array([*result, *rod_points(hand, hand + turn @ [0, 1, 0])])

    masses = np.array([0.5, 0.5, 1.0, 1.0, *[1 / 3] * 6, 0.5, 1.0, 1.0])
    compare(builder, PointCloud(masses, positions), (Fraction(1), Fraction(1, 7), Fraction(-10)), 8)


def test_a_coordinate_that_acts_twice_in_one_chain() -> None:
    """A geared pair: the frame of one joint enters a product twice."""
    builder = Builder()
    first = builder.joint(WORLD)
    tip = builder.link(first, builder.number(1))
    builder.frames.append(type(builder.frames[first])(tip, builder.frames[first].step))
    builder.rod(len(builder.frames) - 1, "x", builder.number(2))

    def positions(q: NDArray[np.complex128]) -> NDArray[np.complex128]:
        elbow = direction(q[0])
        points = rod_points(0 * elbow, elbow)
        return np.array(points + rod_points(elbow, elbow + 2 * direction(2 * q[0])))

    compare(builder, PointCloud(np.array([0.5, 0.5, 1.0, 1.0]), positions), PULL, 9)


def test_points_follow_the_frames() -> None:
    builder = Builder()
    joint = builder.joint(builder.turn(WORLD, "z", builder.number(Fraction(1, 2))))
    tip = builder.link(joint, builder.parameter())
    builder.rod(tip, "-y", builder.number(2))
    builder.effector(tip)
    graph = robot_graph(builder.build())
    q, theta = np.array([0.3]), np.array([1.25])
    along, across = direction(0.8).real, direction(0.8 - np.pi / 2).real
    end = 1.25 * along
    np.testing.assert_allclose(evaluate(graph, "effectors", q, theta), end)
    expected = np.concatenate([[0, 0], end, end, end + 2 * across])
    np.testing.assert_allclose(evaluate(graph, "body_points", q, theta), expected, atol=1e-15)
    assert [extent.bases for extent in graph.numbering.extents] == [(0, 1), (2, 3)]


def test_a_robot_without_degrees_of_freedom_has_a_graph() -> None:
    builder = Builder()
    builder.effector(builder.link(WORLD, builder.parameter()))
    graph = robot_graph(builder.build(), PULL)
    np.testing.assert_allclose(
        evaluate(graph, "effectors", np.zeros(0), np.array([2.0])), [2.0, 0.0]
    )
    assert graph.acceleration.size_out(0)[0] == 0


def turned_base(model: RobotModel, turns: Sequence[tuple[int, Fraction]]) -> RobotModel:
    """The whole robot after rotations (axis, angle) of its base."""
    known, extra = len(model.scalars), len(turns)
    base = [FrameNode(i, Turn(axis, known + i)) for i, (axis, _) in enumerate(turns)]
    moved = [FrameNode(node.parent + extra, node.step) for node in model.frames[1:]]
    return replace(
        model,
        scalars=(*model.scalars, *(Constant(angle) for _, angle in turns)),
        frames=(model.frames[WORLD], *base, *moved),
        bodies=tuple(replace(body, frame=body.frame + extra) for body in model.bodies),
        effectors=tuple(frame + extra for frame in model.effectors),
    )


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_rotating_the_base_changes_nothing_if_gravity_turns_along(
    dimension: int, seed: int
) -> None:
    model = mixed_robot(seed, dimension, 3, tree=seed % 2 == 0)
    turns = [(2, Fraction(7, 10))]
    if dimension == 3:
        turns += [(0, Fraction(-6, 5)), (1, Fraction(3, 7)), (2, Fraction(2))]
    turn = np.eye(3)
    matrices = (rotation_x, rotation_y, rotation_z)
    for axis, angle in turns:
        turn = turn @ matrices[axis](float(angle)).real
    pull = (Fraction(1, 3), Fraction(-981, 100), Fraction(2))[:dimension]
    along = turn[:dimension, :dimension] @ as_floats(pull)
    robot = turned_base(model, turns)
    plain = robot_graph(model, pull)
    carried = robot_graph(robot, tuple(map(Fraction, along)))
    left_behind, weightless = robot_graph(robot, pull), robot_graph(robot)
    rng, n = np.random.default_rng(seed), len(model.dofs)
    q, v, theta = (
        rng.uniform(-2, 2, n),
        rng.uniform(-2, 2, n),
        rng.uniform(1, 2, len(model.parameters)),
    )
    mass = evaluate(plain, "mass_matrix", q, theta)
    np.testing.assert_allclose(
        evaluate(carried, "mass_matrix", q, theta), mass, rtol=1e-10, atol=1e-10
    )
    bias = evaluate(plain, "bias", q, v, theta)
    np.testing.assert_allclose(evaluate(carried, "bias", q, v, theta), bias, rtol=1e-9, atol=1e-9)
    assert np.abs(evaluate(left_behind, "bias", q, v, theta) - bias).max() > 0.1
    np.testing.assert_allclose(
        evaluate(weightless, "bias", q, v, theta),
        evaluate(robot_graph(model), "bias", q, v, theta),
        rtol=1e-9,
        atol=1e-9,
    )
    tips = evaluate(plain, "effectors", q, theta).reshape(-1, dimension)
    found = evaluate(carried, "effectors", q, theta).reshape(-1, dimension)
    np.testing.assert_allclose(found, tips @ turn[:dimension, :dimension].T, atol=1e-12)


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("seed", [4, 5])
def test_random_robots_agree_with_point_masses(dimension: int, seed: int) -> None:
    model = mixed_robot(seed, dimension, 3, tree=seed % 2 == 0)
    pull = (Fraction(1, 3), Fraction(-981, 100), Fraction(2))[:dimension]
    graph, rng, n = robot_graph(model, pull), np.random.default_rng(seed), len(model.dofs)
    theta = rng.uniform(1, 2, len(model.parameters))
    cloud = mass_points(model, theta)
    q, v = rng.uniform(-2, 2, n), rng.uniform(-2, 2, n)
    mass = evaluate(graph, "mass_matrix", q, theta)
    np.testing.assert_allclose(mass, cloud.mass_matrix(q), rtol=1e-10, atol=1e-11)
    bias = cloud.coriolis(q, v) + cloud.gravity(q, [*as_floats(pull), 0.0][:3])
    np.testing.assert_allclose(evaluate(graph, "bias", q, v, theta), bias, rtol=1e-6, atol=1e-6)
