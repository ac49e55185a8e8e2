"""How values are compressed for the Gaussian process: in order, without units, and bounded."""

from __future__ import annotations

from math import exp, log

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from solvers.parameters.bayesian_search import compressed, standardised

numbers = st.lists(st.integers(-(10**6), 10**6), min_size=1, max_size=12)


def test_the_formula_by_hand() -> None:
    """The feasible are 0, 6 and 10: middle 6, spread 4; -2 is 2 spreads below the middle."""
    found = compressed(np.array([10.0, 6.0, 0.0, -2.0]))
    wanted = [6 - 4 * (0.5 * (1 - exp(-2 * loss)) + 0.1 * log(1 + loss)) for loss in (1.5, 2)]
    np.testing.assert_allclose(found, [10.0, 6.0, *wanted])


@given(numbers)
def test_the_order_is_kept(values: list[int]) -> None:
    array = np.array(values, dtype=float)
    found = standardised(array)
    by_value = np.argsort(array, kind="stable")
    assert np.all(np.diff(found[by_value]) >= 0)
    assert np.argmax(found) == np.argmax(array)
    if len(values) <= 3:
        # Nothing is so far away that a difference is lost to rounding.
        assert len(set(found.tolist())) == len(set(values))


@given(numbers, st.integers(-20, 20))
def test_the_unit_does_not_matter(values: list[int], power: int) -> None:
    array = np.array(values, dtype=float)
    np.testing.assert_allclose(standardised(array * 2.0**power), standardised(array), atol=1e-9)


@given(numbers)
def test_mean_and_deviation(values: list[int]) -> None:
    found = standardised(np.array(values, dtype=float))
    assert found.mean() == pytest.approx(0, abs=1e-9)
    assert found.std() == pytest.approx(0 if len(set(values)) == 1 else 1)


def test_a_huge_violation_leaves_the_others_apart() -> None:
    """Standardised as they are, the feasible values would be within 1e-6 of each other."""
    values = np.array([9.7, 9.1, 8.0, 7.5, -0.3, -2.0, -1e7])
    found = standardised(values)
    assert found[0] - found[3] > 0.5
    assert found[4] - found[5] > 0.01
    assert np.ptp(((values - values.mean()) / values.std())[:6]) < 1e-5


@pytest.mark.parametrize("values", [[1e308, -1e308], [0.0, 5e-324], [-1e308] * 3, [1e-300, -1e300]])
def test_extreme_values_stay_finite(values: list[float]) -> None:
    assert np.isfinite(standardised(np.array(values))).all()
