"""Refined gains: a known optimum is found, and the tube of a robot with a motor gets narrower."""

from __future__ import annotations

import numpy as np
import pytest

from compiler.arrays import Array
from solvers.trajectory.gain_refinement import hats, refined_gains

RNG = np.random.default_rng(3)
GAINS = RNG.normal(size=(13, 2, 5))
MEASURED = 4


def test_hats_interpolate() -> None:
    values = np.array([1.0, -2.0, 0.5, 3.0])
    times = np.linspace(0, 1, 13)
    expected = np.interp(times, [0, 1 / 3, 2 / 3, 1], values)
    np.testing.assert_allclose(values @ hats(13, 4), expected, atol=1e-12)
    assert hats(3, 12).shape == (3, 3)


def test_the_optimum_of_a_quadratic_is_found() -> None:
    """Half a unit more at the start and half a unit less at the end, on the way linearly."""
    sizes = np.sqrt((GAINS**2).mean(axis=0))
    best = GAINS.copy()
    best[:, :, :MEASURED] += np.linspace(0.5, -0.5, 13)[:, None, None] * sizes[:, :MEASURED]

    def cost(gains: Array) -> float:
        return 1 + float(((gains - best) ** 2).sum())

    found, change = refined_gains(GAINS, MEASURED, cost)
    assert cost(found) < 1 + 1e-3 * (cost(GAINS) - 1)
    np.testing.assert_array_equal(found[:, :, MEASURED:], GAINS[:, :, MEASURED:])
    again, _ = refined_gains(GAINS, MEASURED, cost, change)
    assert cost(again) <= cost(found)


def test_no_gain_changes_by_more_than_its_size() -> None:
    found, _ = refined_gains(GAINS, MEASURED, lambda gains: 100.0 - float(gains[:, 0, 0].sum()))
    more = (found - GAINS)[:, 0, 0]
    assert np.max(more) == pytest.approx(np.sqrt((GAINS[:, 0, 0] ** 2).mean()))


@pytest.mark.parametrize("value", [np.inf, np.nan, 0.0])
def test_gains_of_no_use_stay(value: float) -> None:
    found, change = refined_gains(GAINS, MEASURED, lambda _: value)
    assert found is GAINS
    assert not change.any()
