"""Monotone cubics against scipy's."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from scipy.interpolate import CubicHermiteSpline, PchipInterpolator

from solvers.trajectory.monotone_cubic import monotone_cubic

LENGTHS = st.lists(st.tuples(st.floats(0.1, 9.0), st.floats(0.0, 5.0)), min_size=1, max_size=7)


@given(LENGTHS)
def test_it_is_that_of_scipy_with_rest_at_both_ends(parts: list[tuple[float, float]]) -> None:
    times = np.concatenate([[0.0], np.cumsum([time for time, _ in parts])])
    values = np.concatenate([[1.5], 1.5 + np.cumsum([length for _, length in parts])])
    slopes = PchipInterpolator(times, values).derivative()(times)
    slopes[0] = slopes[-1] = 0.0
    at = np.linspace(0.0, times[-1], 60)
    expected = CubicHermiteSpline(times, values, slopes)(at)
    np.testing.assert_allclose(monotone_cubic(times, values, at), expected, atol=1e-9)


def test_values_that_turn_back_do_so_at_rest() -> None:
    times, values = np.array([0.0, 1.0, 3.0]), np.array([0.0, 2.0, -1.0])
    at = np.linspace(0.0, 3.0, 301)
    found = monotone_cubic(times, values, at)
    assert found.max() == 2.0
    np.testing.assert_allclose(np.gradient(found, at)[100], 0.0, atol=0.05)
