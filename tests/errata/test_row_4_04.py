"""Row 4.4: the E-matrices of Example 3, as printed and corrected, against derived equations."""

from __future__ import annotations

import numpy as np
import pytest

from compiler.arrays import Array
from compiler.discretisation.linearisation import SecondOrderForm, second_order_form
from compiler.dynamics.controlled_system import controlled_system
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.dynamics.kinematics import absolute_angles
from tests.oracles.e_matrices import EMatrices
from tests.oracles.robots import evaluate, point_chain, rod_chain
from tests.oracles.two_rods import rates as rod_rates


def form_of(links: int, q: Array, v: Array, a: Array, theta: Array) -> SecondOrderForm:
    """The second-order form of Example 3's robot in absolute angles, at one sample."""
    model = point_chain(links)
    system = controlled_system(robot_graph(model, (), absolute_angles(model)))
    return second_order_form(system, q[None, :], v[None, :], a[None, :], theta)


def motion(links: int) -> tuple[Array, Array, Array, Array]:
    rng = np.random.default_rng(links)
    rates, accelerations = rng.uniform(1, 2, (2, links)) * rng.choice([-1, 1], (2, links))
    return rng.uniform(0.5, 2, links), rng.uniform(-2, 2, links), rates, accelerations


def test_the_printed_row_loses_a_mass() -> None:
    """Unit links at 0 and 90 degrees: the second one's own inertia is 1, as printed it is 0."""
    lengths, angles, still = np.ones(2), np.array([0.0, np.pi / 2]), np.zeros(2)
    printed = EMatrices(lengths, angles, still, still, printed=True).mass()
    np.testing.assert_allclose(printed, [[2, 0], [0, 0]], atol=1e-15)
    found = form_of(2, angles, still, still, lengths).mass[0]
    np.testing.assert_allclose(found, [[2, 0], [0, 1]], atol=1e-15)


@pytest.mark.parametrize("links", [2, 3, 4])
def test_the_printed_e_matrices_are_another_robot(links: int) -> None:
    """The first row of E_2 has the wrong function and sign."""
    lengths, angles, rates, accelerations = motion(links)
    form = form_of(links, angles, rates, accelerations, lengths)
    printed = EMatrices(lengths, angles, rates, accelerations, printed=True)
    for found, other in (
        (form.mass[0], printed.mass()),
        (form.damping[0], printed.damping()),
        (form.bias[0], printed.bias()),
    ):
        assert np.abs(found - other).max() > 0.1


@pytest.mark.parametrize("links", [2, 3, 4])
def test_mass_damping_and_bias_are_those_of_the_corrected_e_matrices(links: int) -> None:
    lengths, angles, rates, accelerations = motion(links)
    form = form_of(links, angles, rates, accelerations, lengths)
    paper = EMatrices(lengths, angles, rates, accelerations)
    np.testing.assert_allclose(form.mass[0], paper.mass(), rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(form.damping[0], paper.damping(), rtol=1e-12, atol=1e-13)
    np.testing.assert_allclose(form.bias[0], paper.bias(), rtol=1e-12, atol=1e-13)


def test_one_link_that_turns_has_no_stiffness() -> None:
    """A unit link at 1 rad/s: no torque depends on its angle; the E-matrices say -1."""
    one, still = np.ones(1), np.zeros(1)
    np.testing.assert_allclose(EMatrices(one, one, one, still).stiffness(), [[-1]], rtol=1e-14)
    np.testing.assert_allclose(form_of(1, one, one, still, one).stiffness[0], [[0]], atol=1e-14)


@pytest.mark.parametrize("links", [2, 3])
def test_the_stiffness_of_the_e_matrices_holds_at_rest_only(links: int) -> None:
    """Ours are the derivatives of the forces, by differences."""
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


def test_without_coriolis_terms_a_moving_arm_stands_still() -> None:
    """The case study has E = 0: no force, however fast; rods of 1 and 0.5 m, the elbow at 0.4."""
    lengths, q, v = np.array([1.0, 0.5]), np.array([0.3, 0.4]), np.array([2.0, 3.0])
    graph = robot_graph(rod_chain(2))
    forces = evaluate(graph, "bias", q, v, lengths)
    pull = 1.0 * 0.5**2 / 2 * np.sin(0.4)
    np.testing.assert_allclose(forces, [-pull * (2 * 2 * 3 + 3**2), pull * 2**2], rtol=1e-12)
    free = np.array(rod_rates(0.0, np.concatenate([q, v]), lengths, (0.0, 0.0)))
    found = evaluate(graph, "acceleration", q, v, np.zeros(2), lengths)
    np.testing.assert_allclose(found, free[2:], rtol=1e-12)
    assert np.abs(found).max() > 1  # with E = 0 both would be zero
