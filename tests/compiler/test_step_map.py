"""The step map of random robots: against the equations of motion, differences and point masses."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.controlled_system import controlled_system
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.dynamics.kinematics import absolute_angles
from compiler.robots.robot import RobotModel
from tests.oracles.driven_robots import driven
from tests.oracles.mass_points import energy, mass_points
from tests.oracles.mixed_robots import mixed_robot
from tests.oracles.robots import evaluate, rod_chain

PULL = {
    2: (Fraction(1, 3), Fraction(-981, 100)),
    3: (Fraction(1, 3), Fraction(-2, 7), Fraction(-981, 100)),
}
KINDS = [(1, False), (2, False), (3, False), (3, True), (4, True)]
SHAPES = [(dimension, *kind) for dimension in (2, 3) for kind in KINDS]


def robot(dimension: int, joints: int, *, tree: bool) -> RobotModel:
    return mixed_robot(1, dimension, joints, tree=tree)


def samples(numeric: NumericRobot, count: int) -> tuple[Array, Array, Array]:
    rng = np.random.default_rng(numeric.size)
    x, u = rng.uniform(-1, 1, (count, numeric.size)), rng.uniform(-3, 3, (count, numeric.m))
    return x, u, rng.uniform(0.8, 1.6, numeric.p)


@pytest.mark.parametrize(("dimension", "joints", "tree"), SHAPES)
def test_jacobians_of_random_robots_with_dynamics_of_their_own(
    dimension: int, joints: int, tree: bool
) -> None:
    """Differences of order four in every direction of (x, u, theta)."""
    model = driven(robot(dimension, joints, tree=tree))
    numeric = NumericRobot(robot_graph(model, PULL[dimension]))
    assert numeric.r == 1
    assert numeric.m == joints
    x, u, theta = samples(numeric, 3)
    found = numeric.step(x, u, theta, 0.0625, 2)
    rates, slopes = numeric.acceleration(x, u, theta)
    sizes, h = [numeric.size, numeric.size + numeric.m], 1e-3

    def moved(shift: Array) -> tuple[Array, Array]:
        dx, du, dtheta = np.split(shift, sizes)
        place = x + dx, u + du, theta + dtheta
        return numeric.step(*place, 0.0625, 2).value, numeric.acceleration(*place)[0]

    jacobian = np.concatenate([found.state, found.input, found.parameter], axis=2)
    for j, unit in enumerate(np.eye(numeric.size + numeric.m + numeric.p)):
        points = {c: moved(c * h * unit) for c in (-2, -1, 1, 2)}
        for place, by_all in enumerate((jacobian, slopes)):
            near = points[1][place] - points[-1][place]
            far = points[2][place] - points[-2][place]
            expected = (8 * near - far) / (12 * h)
            scale = 1 + float(np.abs(by_all).max())
            np.testing.assert_allclose(by_all[:, :, j], expected, atol=1e-6 * scale)
    assert np.isfinite(rates).all()


@pytest.mark.parametrize(("dimension", "joints", "tree"), SHAPES)
def test_forces_and_accelerations_are_those_of_the_validated_graph(
    dimension: int, joints: int, tree: bool
) -> None:
    """Newton and Euler agree with Lagrange and Christoffel, in absolute angles too."""
    model = driven(robot(dimension, joints, tree=tree))
    for coordinates in (None, absolute_angles(model)):
        graph = robot_graph(model, PULL[dimension], coordinates)
        numeric, system = NumericRobot(graph), controlled_system(graph)
        x, u, theta = samples(numeric, 4)
        rates, _ = numeric.acceleration(x, u, theta)
        n, rng = numeric.n, np.random.default_rng(7)
        for row in range(4):
            q, w = x[row, :n], x[row, n:]
            wanted = evaluate(graph, "acceleration", q, w, u[row], theta)
            np.testing.assert_allclose(rates[row], wanted, rtol=1e-9, atol=1e-9)
            a = rng.uniform(-2, 2, n)
            forces = np.asarray(system.inertial(q, w[:n], a, theta, system.constants)).ravel()
            mass = evaluate(graph, "mass_matrix", q, theta)
            expected = mass @ a + evaluate(graph, "bias", q, w[:n], theta)
            np.testing.assert_allclose(forces, expected, rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize(("dimension", "joints", "tree"), SHAPES)
def test_energy_of_random_robots_is_conserved(dimension: int, joints: int, tree: bool) -> None:
    """Accelerations integrated to 12 digits; energies of point masses, without a mass matrix."""
    model, pull = robot(dimension, joints, tree=tree), PULL[dimension]
    numeric = NumericRobot(robot_graph(model, pull))
    x, _, theta = samples(numeric, 1)
    u, n = np.zeros((1, numeric.m)), numeric.n

    def slope(_: float, state: Array) -> Array:
        rates, _jacobian = numeric.acceleration(state[None, :], u, theta)
        return np.concatenate([state[n:], rates[0]])

    times = np.linspace(0, 1, 6)
    flow = solve_ivp(slope, (0, 1), x[0], method="DOP853", t_eval=times, rtol=1e-12, atol=1e-12)
    cloud, weights = mass_points(model, theta), [float(value) for value in pull]
    energies = [energy(cloud, state[:n], state[n:], weights) for state in flow.y.T]
    still = energy(cloud, x[0, :n], 0 * x[0, n:], weights)
    assert np.abs(flow.y[:n, -1] - x[0, :n]).max() > 0.1
    scale = max(1.0, abs(energies[0]), abs(energies[0] - still))
    np.testing.assert_allclose(energies, energies[0], atol=1e-8 * scale, rtol=0)


def test_the_rollout_is_the_step_repeated() -> None:
    numeric = NumericRobot(robot_graph(driven(rod_chain(3)), PULL[2]))
    x, u, theta = samples(numeric, 5)
    states = numeric.simulate(x[0], u, theta, 0.125, 3)
    assert states.shape == (6, 7)
    for row in range(5):
        step = numeric.step(states[row : row + 1], u[row : row + 1], theta, 0.125, 3)
        np.testing.assert_allclose(step.value[0], states[row + 1], rtol=1e-12, atol=1e-12)
