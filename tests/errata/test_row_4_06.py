"""Row 4.6: the inertia matrix printed in the case study, and the derived one."""

from __future__ import annotations

import numpy as np

from compiler.dynamics.equations_of_motion import robot_graph
from tests.oracles.robots import evaluate, rod_chain


def test_the_printed_inertia_is_not_positive_definite_and_ours_is() -> None:
    graph, l1, l2 = robot_graph(rod_chain(2)), 1.0, 0.5
    for angle in np.linspace(-np.pi, np.pi, 73):
        mass = evaluate(graph, "mass_matrix", np.array([0.0, angle]), np.array([l1, l2]))
        printed = mass.copy()
        printed[0, 1] = printed[1, 0] = l1**3 / 3 + l1 * l2**2 / 2 * np.cos(angle)
        assert np.linalg.eigvalsh(mass)[0] > 0
        assert np.linalg.eigvalsh(printed)[0] < 0


def test_mass_matrix_of_the_reference_two_link_arm() -> None:
    graph = robot_graph(rod_chain(2))
    mass = evaluate(graph, "mass_matrix", np.array([0.3, 0.4]), np.array([1.0, 0.5]))
    expected = [[1.1052652485, 0.1567992909], [0.1567992909, 0.0416666667]]
    np.testing.assert_allclose(mass, expected, atol=5e-11)
