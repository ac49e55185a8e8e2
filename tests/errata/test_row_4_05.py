"""Row 4.5: point masses at the tips and uniform rods are two robots."""

from __future__ import annotations

from fractions import Fraction

import numpy as np

from compiler.dynamics.equations_of_motion import robot_graph
from tests.oracles.robots import evaluate, point_chain, rod_chain

PULL = (Fraction(1, 3), Fraction(-981, 100))


def test_the_same_link_is_three_times_as_heavy_to_turn() -> None:
    """One link of 1.5 m and 1 kg/m about its end: L^3 with its mass at the tip, L^3/3 as a rod."""
    q, theta = np.zeros(1), np.array([1.5])
    heavy = evaluate(robot_graph(point_chain(1)), "mass_matrix", q, theta)
    light = evaluate(robot_graph(rod_chain(1)), "mass_matrix", q, theta)
    np.testing.assert_allclose([heavy[0, 0], light[0, 0]], [3.375, 1.125], rtol=1e-14)


def test_two_rods_agree_with_the_corrected_closed_form() -> None:
    graph = robot_graph(rod_chain(2), PULL)
    rng = np.random.default_rng(1)
    for _ in range(20):
        (q1, q2), (w1, w2) = rng.uniform(-3, 3, 2), rng.uniform(-2, 2, 2)
        l1, l2 = rng.uniform(0.5, 5, 2)
        q, v, theta = np.array([q1, q2]), np.array([w1, w2]), np.array([l1, l2])
        d12 = l2**3 / 3 + l1 * l2**2 / 2 * np.cos(q2)
        d11 = l1**3 / 3 + l1**2 * l2 + l2**3 / 3 + l1 * l2**2 * np.cos(q2)
        h = l1 * l2**2 / 2 * np.sin(q2)
        gx, gy = map(float, PULL)
        first = np.array([-np.sin(q1), np.cos(q1)]) @ [gx, gy]
        second = np.array([-np.sin(q1 + q2), np.cos(q1 + q2)]) @ [gx, gy]
        g2 = -(l2**2) / 2 * second
        g1 = -(l1**2 / 2 + l2 * l1) * first + g2
        bias = [-h * (2 * w1 * w2 + w2**2) + g1, h * w1**2 + g2]
        mass = evaluate(graph, "mass_matrix", q, theta)
        np.testing.assert_allclose(mass, [[d11, d12], [d12, l2**3 / 3]], rtol=1e-12)
        np.testing.assert_allclose(evaluate(graph, "bias", q, v, theta), bias, rtol=1e-9, atol=1e-9)


def test_two_point_masses_agree_with_the_corrected_closed_form() -> None:
    graph = robot_graph(point_chain(2))
    rng = np.random.default_rng(2)
    for _ in range(20):
        q, v, theta = rng.uniform(-3, 3, 2), rng.uniform(-2, 2, 2), rng.uniform(0.5, 5, 2)
        l1, l2 = theta
        m1, m2, cosine = l1, l2, np.cos(q[1])
        mass = np.array(
            [
                [m1 * l1**2 + m2 * (l1**2 + l2**2 + 2 * l1 * l2 * cosine), 0],
                [m2 * (l2**2 + l1 * l2 * cosine), m2 * l2**2],
            ]
        )
        mass[0, 1] = mass[1, 0]
        h = m2 * l1 * l2 * np.sin(q[1])
        bias = [-h * (2 * v[0] * v[1] + v[1] ** 2), h * v[0] ** 2]
        u = rng.uniform(-5, 5, 2)
        np.testing.assert_allclose(evaluate(graph, "mass_matrix", q, theta), mass, rtol=1e-11)
        np.testing.assert_allclose(
            evaluate(graph, "bias", q, v, theta), bias, rtol=1e-10, atol=1e-10
        )
        expected = np.linalg.solve(mass, u - bias)
        found = evaluate(graph, "acceleration", q, v, u, theta)
        np.testing.assert_allclose(found, expected, rtol=1e-8)
