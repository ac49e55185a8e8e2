"""The linearisation against the paper's E-matrices, and its exact discretisation."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from numpy.typing import NDArray
from scipy.integrate import solve_ivp

from compiler.discretisation.float_reading import FloatReading
from compiler.discretisation.linearisation import SecondOrderForm, linearise, second_order_form
from compiler.dynamics.absolute_angles import absolute_angles
from compiler.dynamics.controlled_system import controlled_system
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.robot import WORLD
from tests.oracles.driven_robots import driven
from tests.oracles.e_matrices import EMatrices
from tests.oracles.robots import Builder, point_chain, rod_chain

Array = NDArray[np.float64]
PULL = (Fraction(1, 3), Fraction(-981, 100))


def form_of(links: int, q: Array, v: Array, a: Array, theta: Array) -> SecondOrderForm:
    """The second-order form of Example 3's robot in absolute angles, at one sample."""
    model = point_chain(links)
    system = controlled_system(robot_graph(model, (), absolute_angles(model)))
    return second_order_form(system, q[None, :], v[None, :], a[None, :], theta)


def motion(links: int) -> tuple[Array, Array, Array, Array]:
    rng = np.random.default_rng(links)
    rates, accelerations = rng.uniform(1, 2, (2, links)) * rng.choice([-1, 1], (2, links))
    return rng.uniform(0.5, 2, links), rng.uniform(-2, 2, links), rates, accelerations


@pytest.mark.parametrize("links", [2, 3, 4])
def test_mass_damping_and_bias_are_those_of_the_corrected_e_matrices(links: int) -> None:
    lengths, angles, rates, accelerations = motion(links)
    form = form_of(links, angles, rates, accelerations, lengths)
    paper = EMatrices(lengths, angles, rates, accelerations)
    np.testing.assert_allclose(form.mass[0], paper.mass(), rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(form.damping[0], paper.damping(), rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(form.bias[0], paper.bias(), rtol=1e-12, atol=1e-13)


@pytest.mark.parametrize("links", [2, 3, 4])
def test_the_printed_e_matrices_are_another_robot(links: int) -> None:
    """Contract, 4.4: the first row of E_2 has the wrong function and sign."""
    lengths, angles, rates, accelerations = motion(links)
    form = form_of(links, angles, rates, accelerations, lengths)
    printed = EMatrices(lengths, angles, rates, accelerations, printed=True)
    for found, other in (
        (form.mass[0], printed.mass()),
        (form.damping[0], printed.damping()),
        (form.bias[0], printed.bias()),
    ):
        assert np.abs(found - other).max() > 0.1


@pytest.mark.parametrize("links", [2, 3])
def test_the_stiffness_of_the_e_matrices_holds_at_rest_only(links: int) -> None:
    """Contract, 4.4; ours are the derivatives of the forces, by differences."""
    lengths, angles, rates, accelerations = motion(links)
    still = np.zeros(links)
    at_rest = form_of(links, angles, still, still, lengths)
    paper = EMatrices(lengths, angles, still, still).stiffness()
    np.testing.assert_allclose(at_rest.stiffness[0], paper, atol=1e-14)
    h = 1e-4
    for v, a in ((rates, still), (still, accelerations), (rates, accelerations)):
        form = form_of(links, angles, v, a, lengths)
        assert np.abs(form.stiffness[0] - EMatrices(lengths, angles, v, a).stiffness()).max() > 0.1
        for j, unit in enumerate(np.eye(links)):
            ahead, behind = (
                EMatrices(lengths, angles + shift * unit, v, a).bias() for shift in (h, -h)
            )
            slope = (ahead - behind) / (2 * h)
            np.testing.assert_allclose(form.stiffness[0, :, j], slope, rtol=1e-6, atol=1e-7)


def test_the_parameter_column_of_the_second_order_form() -> None:
    lengths, angles, rates, accelerations = motion(3)
    form, h = form_of(3, angles, rates, accelerations, lengths), 1e-5
    for j, unit in enumerate(np.eye(3)):
        ahead, behind = (
            EMatrices(lengths + shift * unit, angles, rates, accelerations).bias()
            for shift in (h, -h)
        )
        slope = (ahead - behind) / (2 * h)
        np.testing.assert_allclose(form.parameter[0, :, j], slope, rtol=1e-7, atol=1e-8)


def test_the_two_forms_of_the_linearisation_agree() -> None:
    """F, G and H are -M^-1 K, -M^-1 C, M^-1 and -M^-1 H about a free motion."""
    reading = FloatReading(robot_graph(rod_chain(3), PULL))
    rng = np.random.default_rng(1)
    x, u, theta = rng.uniform(-1, 1, (4, 6)), rng.uniform(-3, 3, (4, 3)), rng.uniform(1, 2, 3)
    affine = linearise(reading, x, u, theta)
    system = controlled_system(reading.graph)
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
    reading = FloatReading(robot_graph(driven(rod_chain(2)), PULL))
    rng = np.random.default_rng(2)
    x, u, theta = rng.uniform(-1, 1, (3, 5)), rng.uniform(-2, 2, (3, 2)), rng.uniform(1, 2, 2)
    affine = linearise(reading, x, u, theta)
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
    reading = FloatReading(robot_graph(builder.build(), (Fraction(2), Fraction(0))))
    x, u = np.array([[0.3, -0.7]]), np.array([[4.0]])
    found, dt = linearise(reading, x, u, np.zeros(0)).discretised(0.5), 0.5
    rate = 4.0 / 2.5 + 2.0
    expected = [0.3 - 0.7 * dt + rate * dt**2 / 2, -0.7 + rate * dt]
    np.testing.assert_allclose(found.value[0], expected, rtol=1e-13)
    np.testing.assert_allclose(found.state[0], [[1, dt], [0, 1]], rtol=1e-13)
    np.testing.assert_allclose(found.input[0], [[dt**2 / 5], [dt / 2.5]], rtol=1e-13)


@pytest.mark.parametrize("links", [1, 2, 3])
def test_how_the_hold_and_the_step_map_differ(links: int) -> None:
    """Halving the step divides the differences by 8 (values) and by 4 (Jacobians), about."""
    reading = FloatReading(robot_graph(rod_chain(links), PULL))
    rng = np.random.default_rng(links)
    x, u = rng.uniform(-1, 1, (20, 2 * links)), rng.uniform(-3, 3, (20, links))
    theta = rng.uniform(1, 2, links)
    gaps = []
    for dt in (1 / 64, 1 / 128):
        hold = linearise(reading, x, u, theta).discretised(dt)
        flow = reading.step(x, u, theta, dt, 1)
        pairs = ((hold.value, flow.value), (hold.state, flow.state))
        gaps.append([float(np.abs(a - b).max()) for a, b in pairs])
    ratios = np.array(gaps[0]) / np.array(gaps[1])
    assert 6 < ratios[0] < 10
    assert 3 < ratios[1] < 5
