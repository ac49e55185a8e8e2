"""Row 4.12: the acquisition rule GP-ACB (Eqn. 8), worked out by hand."""

from __future__ import annotations

from math import log, pi, sqrt

import numpy as np

from benchmarks.search_methods import gp_ucb
from solvers.parameters.bayesian_search import gp_acb


def printed_eta(mean: np.ndarray) -> np.ndarray:
    return (mean - mean.min()) / (mean.max() - mean.min())


def test_the_rule_on_three_candidates() -> None:
    """eta is 0 where the mean is least, 1 where it is greatest, and 1/4 in between here."""
    mean, deviation = np.array([-1.0, 0.0, 3.0]), np.array([2.0, 1.0, 0.5])
    beta = 2 * (log(3 * pi**2 / 6) + 3)
    wanted = [-1.0, 0.0 + sqrt(beta / 4), 3.0 + sqrt(beta) / 2]
    np.testing.assert_allclose(gp_acb(mean, deviation, 1), wanted)


def test_a_flat_mean_explores_everywhere() -> None:
    """As printed eta is 0/0 there (row 4.12); it is taken to be 1, which is GP-UCB."""
    mean, deviation = np.zeros(4), np.array([0.1, 0.5, 0.2, 0.4])
    np.testing.assert_array_equal(gp_acb(mean, deviation, 3), gp_ucb(mean, deviation, 3))
    assert int(np.argmax(gp_acb(mean, deviation, 3))) == 1


def test_as_printed_a_flat_mean_has_no_value() -> None:
    with np.errstate(invalid="ignore"):
        assert np.all(np.isnan(printed_eta(np.zeros(4))))


def test_it_is_no_confidence_bound_where_the_mean_is_least() -> None:
    """There eta is 0 and the bound the mean, which a normal value exceeds every second time.

    GP-UCB's bound is exceeded with probability delta at most, over all candidates and all times.
    """
    mean, deviation = np.array([0.0, 1.0]), np.array([5.0, 0.1])
    assert printed_eta(mean)[0] == 0
    draws = np.random.default_rng(1).normal(mean[0], deviation[0], 100_000)
    assert abs(np.mean(draws > gp_acb(mean, deviation, 10)[0]) - 0.5) < 0.01
    assert np.mean(draws > gp_ucb(mean, deviation, 10)[0]) < np.exp(-3)
    # Two times in five the first one is the better one; the rule asks for the second for ever.
    assert [int(np.argmax(gp_acb(mean, deviation, t))) for t in (1, 10, 10**6)] == [1, 1, 1]
