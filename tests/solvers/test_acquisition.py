"""GP-ACB (Eqn. 8) and GP-UCB against their formulas; the corrections are row 4.12 of the errata."""

from __future__ import annotations

from math import log, pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.search_methods import gp_ucb
from solvers.parameters.bayesian_search import exploration, gp_acb

MEANS = st.lists(st.floats(-5, 5), min_size=2, max_size=8)


def test_exploration_is_the_stated_beta() -> None:
    """beta_t = 2 ln(|D| pi^2 t^2 / (6 delta)) with delta = e^-3, so ln(1 / delta) = 3."""
    assert exploration(512, 7) == pytest.approx(2 * (log(512 * pi**2 * 49 / 6) + 3))


@given(MEANS, st.integers(1, 50))
def test_it_explores_at_most_as_much_as_ucb(means: list[float], t: int) -> None:
    mean, deviation = np.array(means), np.ones(len(means))
    adaptive, upper = gp_acb(mean, deviation, t), gp_ucb(mean, deviation, t)
    assert np.all(adaptive <= upper + 1e-12)
    best = int(np.argmax(mean))
    assert adaptive[best] == pytest.approx(upper[best])
