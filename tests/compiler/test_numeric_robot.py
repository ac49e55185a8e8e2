"""The Runge-Kutta step and its Jacobians against an accurate integrator and differences."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.robot import WORLD
from tests.oracles.planar_chain import chain_dynamics, chain_energy
from tests.oracles.robots import Builder, rod_chain

PULL = (Fraction(0), Fraction("-9.81"))
DT = 0.125


def numeric(links: int, pull: tuple[Fraction, ...] = PULL) -> NumericRobot:
    return NumericRobot(robot_graph(rod_chain(links), pull))


def flow(x: Array, u: Array, theta: Array, time: float, pull: tuple[float, float]) -> Array:
    """The state after ``time`` by DOP853 on the hand-written n-link formula."""
    n = len(u)

    def slope(_: float, state: Array) -> Array:
        mass, coriolis, gravity = chain_dynamics(theta, np.ones(n), state[:n], state[n:], pull)
        return np.concatenate([state[n:], np.linalg.solve(mass, u - coriolis - gravity)])

    found = solve_ivp(slope, (0, time), x, method="DOP853", rtol=1e-12, atol=1e-12)
    return np.asarray(found.y[:, -1])


def samples(links: int, count: int) -> tuple[Array, Array, Array]:
    rng = np.random.default_rng(links)
    x = rng.uniform(-1, 1, (count, 2 * links))
    return x, rng.uniform(-3, 3, (count, links)), rng.uniform(1, 2, links)


@pytest.mark.parametrize("links", [1, 2, 3])
def test_the_step_converges_to_the_solution_with_order_four(links: int) -> None:
    robot, (x, u, theta) = numeric(links), samples(links, 3)
    exact = np.array([flow(a, b, theta, DT, (0, -9.81)) for a, b in zip(x, u, strict=True)])
    errors = [
        float(np.abs(robot.step(x, u, theta, DT, count).value - exact).max())
        for count in (4, 8, 64)
    ]
    assert 8 < errors[0] / errors[1] < 32
    assert errors[2] < 1e-7


@pytest.mark.parametrize("links", [1, 2, 3])
def test_jacobians_are_those_of_the_discrete_step(links: int) -> None:
    """Central differences of the same map, so that only the sensitivities are judged."""
    robot, (x, u, theta) = numeric(links), samples(links, 4)
    found, h = robot.step(x, u, theta, DT, 2), 1e-5

    def difference(dx: Array, du: Array, dtheta: Array) -> Array:
        ahead = robot.step(x + h * dx, u + h * du, theta + h * dtheta, DT, 2).value
        behind = robot.step(x - h * dx, u - h * du, theta - h * dtheta, DT, 2).value
        return np.asarray((ahead - behind) / (2 * h))

    none_x, none_u, none_p = np.zeros(2 * links), np.zeros(links), np.zeros(links)
    for j, unit in enumerate(np.eye(2 * links)):
        expected = difference(unit, none_u, none_p)
        np.testing.assert_allclose(found.state[:, :, j], expected, rtol=1e-6, atol=1e-7)
    for j, unit in enumerate(np.eye(links)):
        expected = difference(none_x, unit, none_p)
        np.testing.assert_allclose(found.input[:, :, j], expected, rtol=1e-6, atol=1e-7)
        expected = difference(none_x, none_u, unit)
        np.testing.assert_allclose(found.parameter[:, :, j], expected, rtol=1e-6, atol=1e-7)


def test_jacobians_converge_to_those_of_the_flow() -> None:
    links, h = 2, 1e-4
    robot, (x, u, theta) = numeric(links), samples(links, 1)
    found = robot.step(x, u, theta, DT, 32)

    def moved(j: int, size: float) -> Array:
        shift = np.zeros(4 * links)
        shift[j] = size
        dx, du, dtheta = np.split(shift, [2 * links, 3 * links])
        return flow(x[0] + dx, u[0] + du, theta + dtheta, DT, (0, -9.81))

    columns = [(moved(j, h) - moved(j, -h)) / (2 * h) for j in range(4 * links)]
    jacobian = np.concatenate([found.state[0], found.input[0], found.parameter[0]], axis=1)
    np.testing.assert_allclose(jacobian, np.stack(columns, axis=1), atol=2e-6)


@pytest.mark.parametrize("links", [1, 2, 3, 4])
def test_energy_is_conserved_without_input(links: int) -> None:
    robot, (x, _, theta) = numeric(links), samples(links, 1)
    u = np.zeros((1, links))
    pull, ones = (0.0, -9.81), np.ones(links)
    before = chain_energy(theta, ones, x[0, :links], x[0, links:], pull)
    for _ in range(8):
        x = robot.step(x, u, theta, DT, 64).value
        after = chain_energy(theta, ones, x[0, :links], x[0, links:], pull)
        assert abs(after - before) < 1e-4 * (1 + abs(before))


def test_acceleration_and_its_jacobian() -> None:
    links, h = 3, 1e-6
    robot, (x, u, theta) = numeric(links), samples(links, 5)
    value, jacobian = robot.acceleration(x, u, theta)
    assert value.shape == (5, 3)
    assert jacobian.shape == (5, 3, 12)
    for row in range(5):
        q, v = x[row, :3], x[row, 3:]
        mass, coriolis, gravity = chain_dynamics(theta, np.ones(3), q, v, (0, -9.81))
        np.testing.assert_allclose(mass @ value[row], u[row] - coriolis - gravity, atol=1e-9)
        np.testing.assert_allclose(jacobian[row, :, 6:9], np.linalg.inv(mass), rtol=1e-9)
    for j, unit in enumerate(np.eye(3)):
        ahead, _ = robot.acceleration(x, u, theta + h * unit)
        behind, _ = robot.acceleration(x, u, theta - h * unit)
        slope = (ahead - behind) / (2 * h)
        np.testing.assert_allclose(jacobian[:, :, 9 + j], slope, rtol=1e-5, atol=1e-4)


def test_points_and_their_jacobians() -> None:
    """The joints of a planar chain by complex numbers: p_j = sum of l_i exp(i phi_i)."""
    links = 3
    robot, (x, _, theta) = numeric(links), samples(links, 4)
    q = x[:, :links]
    points = robot.points(q, theta)
    phases = np.exp(1j * np.cumsum(q, axis=1))
    joints = np.concatenate([np.zeros((4, 1)), np.cumsum(theta * phases, axis=1)], axis=1)
    order = [3, 0, 1, 1, 2, 2, 3]  # the effector, then both ends of every rod
    expected = np.stack([joints[:, order].real, joints[:, order].imag], axis=2)
    np.testing.assert_allclose(points.value, expected, atol=1e-13)
    for j in range(links):
        by_q = [1j * (joints[:, o] - joints[:, j]) if o > j else 0 * joints[:, 0] for o in order]
        by_l = [phases[:, j] if o > j else 0 * joints[:, 0] for o in order]
        for found, wanted in ((points.by_q[..., j], by_q), (points.by_theta[..., j], by_l)):
            pair = np.stack(
                [np.stack([w.real, w.imag], axis=1) for w in map(np.asarray, wanted)], axis=1
            )
            np.testing.assert_allclose(found, pair, atol=1e-13)


def test_mass_matrices_at_many_samples() -> None:
    robot, (x, _, theta) = numeric(2), samples(2, 6)
    found = robot.mass_matrix(x[:, :2], theta)
    for row in range(6):
        mass, _, _ = chain_dynamics(theta, np.ones(2), x[row, :2], np.zeros(2), (0, 0))
        np.testing.assert_allclose(found[row], mass, rtol=1e-12)


def test_a_robot_without_parameters() -> None:
    builder = Builder(dimension=3)
    frame = builder.link(builder.joint(WORLD, "y"), builder.number(2))
    builder.effector(frame)
    robot = NumericRobot(robot_graph(builder.build()))
    x, u, theta = np.array([[0.3, 0.7], [0.1, 0.2]]), np.array([[1.0], [2.0]]), np.zeros(0)
    step = robot.step(x, u, theta, DT, 1)
    # A double integrator of inertia l^3 / 3 = 8 / 3.
    rate = x[:, 1:] + DT * u * 3 / 8
    place = x[:, :1] + DT * x[:, 1:] + DT**2 / 2 * u * 3 / 8
    np.testing.assert_allclose(step.value, np.concatenate([place, rate], axis=1), rtol=1e-12)
    assert step.parameter.shape == (2, 2, 0)
    points = robot.points(x[:, :1], theta)
    tip = np.stack([2 * np.cos(x[:, 0]), 0 * x[:, 0], -2 * np.sin(x[:, 0])], axis=1)
    np.testing.assert_allclose(points.value[:, 0], tip, atol=1e-14)
    assert points.by_theta.shape == (2, 3, 3, 0)


@pytest.mark.parametrize("links", [1, 3])
def test_effectors_alone_are_those_among_all_points(links: int) -> None:
    """By the closed form of a chain whose joints turn one after the other."""
    numeric, rng = NumericRobot(robot_graph(rod_chain(links))), np.random.default_rng(links)
    q, designs = rng.normal(size=(5, links)), rng.uniform(0.5, 2.0, (5, links))
    angles = np.cumsum(q, axis=1)
    along = np.stack([np.cos(angles), np.sin(angles)], axis=2)
    tips = np.sum(designs[:, :, None] * along, axis=1)
    across = designs[:, :, None] * np.stack([-np.sin(angles), np.cos(angles)], axis=2)
    by_q = np.flip(np.cumsum(np.flip(across, axis=1), axis=1), axis=1)
    found = numeric.effectors(q, designs)
    np.testing.assert_allclose(found.value[:, 0], tips, atol=1e-13)
    np.testing.assert_allclose(found.by_q[:, 0], by_q.transpose(0, 2, 1), atol=1e-13)
    np.testing.assert_allclose(found.by_theta[:, 0], along.transpose(0, 2, 1), atol=1e-13)
    for number in range(5):
        places = numeric.places(q[number : number + 1], designs[number])
        np.testing.assert_allclose(places[0, 0], tips[number], atol=1e-13)
