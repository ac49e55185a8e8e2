"""Batched exponentials against scipy, and held inputs against quadrature."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.linalg import expm

from compiler.discretisation.matrix_exponential import held, matrix_exponential


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
