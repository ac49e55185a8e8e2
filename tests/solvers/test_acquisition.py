"""GP-ACB (Eqn. 8) and GP-UCB against their formulas, worked out by hand."""

from __future__ import annotations

from math import log, pi, sqrt

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solvers.parameters.searches.acquisition import exploration, gp_acb, gp_ucb

MEANS = st.lists(st.floats(-5, 5), min_size=2, max_size=8)


def test_exploration_is_the_stated_beta() -> None:
    """beta_t = 2 ln(|D| pi^2 t^2 / (6 delta)) with delta = e^-3, so ln(1 / delta) = 3."""
    assert exploration(512, 7) == pytest.approx(2 * (log(512 * pi**2 * 49 / 6) + 3))


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


@given(MEANS, st.integers(1, 50))
def test_it_explores_at_most_as_much_as_ucb(means: list[float], t: int) -> None:
    mean, deviation = np.array(means), np.ones(len(means))
    adaptive, upper = gp_acb(mean, deviation, t), gp_ucb(mean, deviation, t)
    assert np.all(adaptive <= upper + 1e-12)
    best = int(np.argmax(mean))
    assert adaptive[best] == pytest.approx(upper[best])
