"""Row 4.6: the inertia matrix printed in the case study, and the derived one."""

from __future__ import annotations

import numpy as np
import pytest
from mpmath import iv

from compiler.dynamics.equations_of_motion import robot_graph
from compiler.mass_matrix.mass_matrix_check import mass_matrix_check
from tests.oracles.robots import evaluate, rod_chain


def inertia(first: str, l1, l2, cosine):
    """The D of the case study; the first length in D12 is l1 as printed, l2 as it should be."""
    d11 = (l1**3 + l2**3 + 3 * l1**2 * l2) / 3 + l2**2 * l1 * cosine
    d12 = {"l1": l1, "l2": l2}[first] ** 3 / 3 + l2**2 * l1 * cosine / 2
    return [[d11, d12], [d12, l2**3 / 3]]


@pytest.mark.parametrize(("first", "definite"), [("l1", False), ("l2", True)])
def test_the_printed_inertia_fails_on_a_whole_box(first: str, definite: bool) -> None:
    """By the intervals of mpmath, v'Dv for v = (1, -3) and l1 in [1, 1.02], l2 in [0.5, 0.51].

    It is linear in the cosine, so that its ends stand for all angles.
    """
    for cosine in (-1, 1):
        (a, b), (_, c) = inertia(first, iv.mpf([1, 1.02]), iv.mpf([0.5, 0.51]), cosine)
        form = a - 6 * b + 9 * c
        assert (form > 0) if definite else (form < 0)


def test_the_corrected_inertia_is_proved_on_the_whole_box() -> None:
    """It is the M that is derived, and that is proved for lengths in [0.5, 5] m and all angles."""
    model = rod_chain(2)
    graph, rng = robot_graph(model), np.random.default_rng(4)
    for _ in range(20):
        angle, lengths = rng.uniform(-np.pi, np.pi), rng.uniform(0.5, 5, 2)
        mass = evaluate(graph, "mass_matrix", np.array([rng.uniform(-3, 3), angle]), lengths)
        np.testing.assert_allclose(mass, inertia("l2", *lengths, np.cos(angle)), rtol=1e-12)
    assert mass_matrix_check(model).status == "proved"


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
