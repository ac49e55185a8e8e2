"""The Gaussian process adapter: interpolation, and ignorance far from what is known."""

from __future__ import annotations

import numpy as np

from solvers.parameters.surrogate import posterior


def test_it_interpolates_in_standard_units() -> None:
    known = np.linspace(0, 1, 9)[:, None]
    values = 40 + 3 * np.sin(4 * known[:, 0])
    mean, deviation = posterior(known, values, known)
    np.testing.assert_allclose(mean, (values - values.mean()) / values.std(), atol=0.05)
    assert np.all(deviation < 0.1)


def test_far_away_it_knows_nothing() -> None:
    """The prior has mean 0 and deviation 1 (and a little noise) in standard units."""
    known = np.array([[0.0, 0.0], [0.01, 0.0], [0.0, 0.01]])
    mean, deviation = posterior(known, np.array([1.0, -1.0, 2.0]), np.array([[1e3, 1e3]]))
    np.testing.assert_allclose(mean, 0, atol=1e-6)
    np.testing.assert_allclose(deviation, 1, atol=0.1)


def test_equal_values_are_no_division_by_zero() -> None:
    known = np.array([[0.0], [0.5], [1.0]])
    mean, deviation = posterior(known, np.array([2.0, 2.0, 2.0]), np.array([[0.25]]))
    np.testing.assert_allclose(mean, 0, atol=1e-9)
    assert np.isfinite(deviation).all()
