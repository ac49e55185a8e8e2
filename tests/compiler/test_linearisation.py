"""The two forms of the linearisation, and its exact discretisation.

Against the paper's E-matrices: ``tests/errata/test_row_4_04.py``.
"""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm

from compiler.arrays import Array
from compiler.discretisation.linearisation import (
    held,
    linearise,
    matrix_exponential,
    second_order_form,
)
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.controlled_system import controlled_system
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.robot import WORLD
from tests.oracles.driven_robots import driven
from tests.oracles.robots import Builder, rod_chain

PULL = (Fraction(1, 3), Fraction(-981, 100))


def test_the_two_forms_of_the_linearisation_agree() -> None:
    """F, G and H are -M^-1 K, -M^-1 C, M^-1 and -M^-1 H about a free motion."""
    numeric = NumericRobot(robot_graph(rod_chain(3), PULL))
    rng = np.random.default_rng(1)
    x, u, theta = rng.uniform(-1, 1, (4, 6)), rng.uniform(-3, 3, (4, 3)), rng.uniform(1, 2, 3)
    affine = linearise(numeric, x, u, theta)
    system = controlled_system(numeric.graph)
    form = second_order_form(system, x[:, :3], x[:, 3:], affine.drift[:, 3:], theta)
    np.testing.assert_allclose(form.bias, u, rtol=1e-9, atol=1e-9)
    for found, right in (
        (affine.state[:, 3:, :3], -form.stiffness),
        (affine.state[:, 3:, 3:], -form.damping),
        (affine.input[:, 3:], np.broadcast_to(np.eye(3), (4, 3, 3))),
        (affine.parameter[:, 3:], -form.parameter),
    ):
        np.testing.assert_allclose(form.mass @ found, right, rtol=1e-8, atol=1e-8)
    np.testing.assert_array_equal(affine.state[:, :3], np.eye(3, 6, 3)[None].repeat(4, axis=0))
    np.testing.assert_array_equal(affine.drift[:, :3], x[:, 3:])


def test_the_affine_map_is_the_flow_of_the_linearised_system() -> None:
    """An accurate integrator of x' = f0 + F dx + G du + H dtheta, away from the sample."""
    numeric = NumericRobot(robot_graph(driven(rod_chain(2)), PULL))
    rng = np.random.default_rng(2)
    x, u, theta = rng.uniform(-1, 1, (3, 5)), rng.uniform(-2, 2, (3, 2)), rng.uniform(1, 2, 2)
    affine = linearise(numeric, x, u, theta)
    dx, du, dtheta = rng.uniform(-1, 1, (3, 5)), rng.uniform(-1, 1, (3, 2)), rng.uniform(-1, 1, 2)
    found = affine.discretised(0.125)
    for row in range(3):
        constant = affine.drift[row] + affine.input[row] @ du[row] + affine.parameter[row] @ dtheta

        def slope(_: float, state: Array, row: int = row, constant: Array = constant) -> Array:
            return np.asarray(constant + affine.state[row] @ (state - x[row]))

        start = x[row] + dx[row]
        flow = solve_ivp(slope, (0, 0.125), start, method="DOP853", rtol=1e-12, atol=1e-13)
        after = found.value[row] + found.state[row] @ dx[row] + found.input[row] @ du[row]
        after = after + found.parameter[row] @ dtheta
        np.testing.assert_allclose(after, flow.y[:, -1], rtol=1e-9, atol=1e-9)


def test_the_hold_is_exact_for_a_linear_robot() -> None:
    """A mass on a slide, where linearisation loses nothing: constant acceleration."""
    builder = Builder()
    slide = builder.joint(WORLD, "x", "prismatic")
    builder.point(slide, builder.number(Fraction(5, 2)))
    numeric = NumericRobot(robot_graph(builder.build(), (Fraction(2), Fraction(0))))
    x, u = np.array([[0.3, -0.7]]), np.array([[4.0]])
    found, dt = linearise(numeric, x, u, np.zeros(0)).discretised(0.5), 0.5
    rate = 4.0 / 2.5 + 2.0
    expected = [0.3 - 0.7 * dt + rate * dt**2 / 2, -0.7 + rate * dt]
    np.testing.assert_allclose(found.value[0], expected, rtol=1e-13)
    np.testing.assert_allclose(found.state[0], [[1, dt], [0, 1]], rtol=1e-13)
    np.testing.assert_allclose(found.input[0], [[dt**2 / 5], [dt / 2.5]], rtol=1e-13)


@pytest.mark.parametrize("links", [1, 2, 3])
def test_how_the_hold_and_the_step_map_differ(links: int) -> None:
    """Halving the step divides the differences by 8 (values) and by 4 (Jacobians), about."""
    numeric = NumericRobot(robot_graph(rod_chain(links), PULL))
    rng = np.random.default_rng(links)
    x, u = rng.uniform(-1, 1, (20, 2 * links)), rng.uniform(-3, 3, (20, links))
    theta = rng.uniform(1, 2, links)
    gaps = []
    for dt in (1 / 64, 1 / 128):
        hold = linearise(numeric, x, u, theta).discretised(dt)
        flow = numeric.step(x, u, theta, dt, 1)
        pairs = ((hold.value, flow.value), (hold.state, flow.state))
        gaps.append([float(np.abs(a - b).max()) for a, b in pairs])
    ratios = np.array(gaps[0]) / np.array(gaps[1])
    assert 6 < ratios[0] < 10
    assert 3 < ratios[1] < 5


@pytest.mark.parametrize("size", [1, 2, 7, 12])
@pytest.mark.parametrize("scale", [1e-9, 1e-2, 1.0, 5.0])
def test_exponentials_of_random_matrices(size: int, scale: float) -> None:
    matrices = scale * np.random.default_rng(size).normal(size=(9, size, size))
    for found, matrix in zip(matrix_exponential(matrices), matrices, strict=True):
        expected = expm(matrix)
        np.testing.assert_allclose(found, expected, atol=1e-12 * np.abs(expected).max())


def test_matrices_of_very_different_norms_share_a_call() -> None:
    turn = np.array([[0.0, -1.0], [1.0, 0.0]])
    angles = np.array([1e-8, 0.5, 40.0, 400.0])
    found = matrix_exponential(angles[:, None, None] * turn)
    expected = [[[np.cos(a), -np.sin(a)], [np.sin(a), np.cos(a)]] for a in angles]
    np.testing.assert_allclose(found, expected, atol=1e-12)


def test_nilpotent_defective_and_no_matrices() -> None:
    nilpotent = np.array([[[0.0, 3.0], [0.0, 0.0]], [[2.0, 1.0], [0.0, 2.0]]])
    e = np.exp(2.0)
    expected = [[[1, 3], [0, 1]], [[e, e], [0, e]]]
    np.testing.assert_allclose(matrix_exponential(nilpotent), expected, rtol=1e-13)
    assert matrix_exponential(np.zeros((0, 3, 3))).shape == (0, 3, 3)


def test_held_inputs_are_the_integral_of_the_exponential() -> None:
    rng = np.random.default_rng(5)
    state, forcing, time = rng.normal(size=(3, 4, 4)), rng.normal(size=(3, 4, 2)), 0.7
    flow, forced = held(state, forcing, time)
    nodes, weights = np.polynomial.legendre.leggauss(16)
    for row in range(3):
        np.testing.assert_allclose(flow[row], expm(state[row] * time), rtol=1e-11, atol=1e-12)
        integrand = [expm(state[row] * time * (1 + s) / 2) @ forcing[row] for s in nodes]
        expected = time / 2 * np.einsum("s,sij->ij", weights, integrand)
        np.testing.assert_allclose(forced[row], expected, rtol=1e-10, atol=1e-11)


def test_a_singular_state_matrix_is_no_exception() -> None:
    """A double integrator: the formula F^-1 (e^(F t) - 1) G has nothing to invert."""
    state, forcing = np.array([[[0.0, 1.0], [0.0, 0.0]]]), np.array([[[0.0], [1.0]]])
    _, forced = held(state, forcing, 3.0)
    np.testing.assert_allclose(forced[0], [[4.5], [3.0]], rtol=1e-14)
