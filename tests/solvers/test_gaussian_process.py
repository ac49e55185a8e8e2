"""The Gaussian process against scikit-learn's, an independent implementation."""

from __future__ import annotations

import warnings

import numpy as np
import pytest
from sklearn.exceptions import ConvergenceWarning
from sklearn.gaussian_process import GaussianProcessRegressor
from sklearn.gaussian_process.kernels import RBF, ConstantKernel, WhiteKernel

from solvers.parameters.bayesian_search import (
    LENGTHS,
    NOISES,
    conditioned,
    fitted,
    log_likelihood,
)


def samples(seed: int, count: int, axes: int):
    """Points and values of a smooth function of unequal axes, with noise, standardised."""
    rng = np.random.default_rng(seed)
    points = rng.uniform(size=(count, axes))
    values = np.sin(5 * points[:, 0]) + 0.3 * points.sum(axis=1) ** 2
    values += 0.03 * rng.normal(size=count)
    return points, (values - values.mean()) / values.std()


@pytest.mark.parametrize("axes", [1, 2, 5])
@pytest.mark.parametrize("amplitude", [0.7, 3.0])
def test_the_posterior_is_that_of_scikit_learn(axes: int, amplitude: float) -> None:
    points, values = samples(axes, 14, axes)
    lengths, noise = np.linspace(0.2, 0.6, axes), 0.02
    theirs = GaussianProcessRegressor(
        ConstantKernel(amplitude, "fixed") * RBF(lengths, "fixed"), alpha=noise, optimizer=None
    ).fit(points, values)
    ours = conditioned(points, values, lengths, amplitude, noise)
    queries = np.random.default_rng(9).uniform(-0.5, 1.5, size=(40, axes))
    mean, deviation = ours.posterior(queries)
    wanted, spread = theirs.predict(queries, return_std=True)
    np.testing.assert_allclose(mean, wanted, atol=1e-8)
    np.testing.assert_allclose(deviation, spread, atol=1e-8)
    likelihood = theirs.log_marginal_likelihood_value_
    assert log_likelihood(points, values, ours) == pytest.approx(likelihood, abs=1e-8)


@pytest.mark.parametrize(("seed", "count", "axes"), [(0, 8, 1), (1, 12, 2), (2, 30, 3), (3, 20, 4)])
def test_the_fit_is_as_likely_as_the_one_of_scikit_learn(seed: int, count: int, axes: int) -> None:
    """The same bounds for both; scikit-learn restarts three times."""
    points, values = samples(seed, count, axes)
    ours = fitted(points, values)
    ratio = ours.noise / ours.amplitude
    for number, bounds in [*((length, LENGTHS) for length in ours.lengths), (ratio, NOISES)]:
        assert bounds[0] * (1 - 1e-9) <= number <= bounds[1] * (1 + 1e-9)
    kernel = ConstantKernel(1.0, (1e-3, 1e3)) * (
        RBF([0.3] * axes, LENGTHS) + WhiteKernel(1e-2, NOISES)
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ConvergenceWarning)
        theirs = GaussianProcessRegressor(
            kernel, alpha=0.0, n_restarts_optimizer=3, random_state=0
        ).fit(points, values)
    best = theirs.log_marginal_likelihood_value_
    assert log_likelihood(points, values, ours) >= best - 0.01


@pytest.mark.parametrize("axes", [1, 3])
def test_no_other_hyperparameters_are_more_likely(axes: int) -> None:
    """Against many random ones, all three kinds free."""
    points, values = samples(5, 15, axes)
    ours = log_likelihood(points, values, fitted(points, values))
    rng = np.random.default_rng(1)
    for _ in range(400):
        lengths = np.exp(rng.uniform(*np.log(LENGTHS), size=axes))
        amplitude = np.exp(rng.uniform(-3, 4))
        noise = amplitude * np.exp(rng.uniform(*np.log(NOISES)))
        other = conditioned(points, values, lengths, amplitude, noise)
        assert log_likelihood(points, values, other) <= ours + 1e-3


def test_an_axis_that_does_not_matter_gets_a_long_scale() -> None:
    rng = np.random.default_rng(4)
    points = rng.uniform(size=(30, 2))
    values = np.sin(9 * points[:, 1])
    lengths = fitted(points, (values - values.mean()) / values.std()).lengths
    assert lengths[0] > 3 * lengths[1]


def test_far_away_it_knows_nothing() -> None:
    points, values = samples(7, 10, 2)
    process = fitted(points, values)
    mean, deviation = process.posterior(np.array([[1e3, 1e3]]))
    np.testing.assert_allclose(mean, 0, atol=1e-9)
    np.testing.assert_allclose(deviation, np.sqrt(process.amplitude))


def test_equal_values_are_no_division_by_zero() -> None:
    points = np.array([[0.0], [0.5], [1.0]])
    mean, deviation = fitted(points, np.zeros(3)).posterior(np.array([[0.25]]))
    np.testing.assert_array_equal(mean, 0)
    assert np.isfinite(deviation).all()
    assert deviation[0] > 0


def test_points_that_all_but_coincide_are_no_fault() -> None:
    points = np.array([[0.3, 0.3], [0.3 + 1e-12, 0.3], [0.8, 0.1]])
    process = fitted(points, np.array([1.0, -0.9, 0.2]))
    mean, deviation = process.posterior(points)
    assert np.isfinite(mean).all()
    assert np.isfinite(deviation).all()
