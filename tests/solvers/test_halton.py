"""The Halton sequence against SciPy's, and how evenly it fills the cube."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import qmc

from solvers.parameters.parameter_search import Halton
from tests.oracles.loaded_modules import loaded_after


@pytest.mark.parametrize("axes", [1, 2, 6, 12])
def test_without_a_seed_it_is_halton_s_own(axes: int) -> None:
    theirs = qmc.Halton(axes, scramble=False).random(100)
    np.testing.assert_allclose(Halton(axes, None).points(0, 100), theirs, atol=1e-15)


@pytest.mark.parametrize("seed", range(5))
def test_scrambled_it_visits_the_same_intervals(seed: int) -> None:
    """Of b^k points in a row from a multiple on, one lies in each interval of length b^-k."""
    points = Halton(3, seed).points(0, 2 * 27 * 125)
    for axis, block in enumerate((8, 27, 125)):
        for first in (0, 3 * block):
            cells = np.floor(points[first : first + block, axis] * block).astype(int)
            assert sorted(cells.tolist()) == list(range(block))
    assert points.min() >= 0
    assert points.max() < 1


@pytest.mark.parametrize("axes", [1, 2, 4, 6])
@pytest.mark.parametrize("count", [8, 64, 512])
def test_it_is_more_even_than_chance(axes: int, count: int) -> None:
    def unevenness(points):
        return qmc.discrepancy(points, method="CD")

    ours = [unevenness(Halton(axes, seed).points(0, count)) for seed in range(12)]
    rng = np.random.default_rng(0)
    chance = [unevenness(rng.uniform(size=(count, axes))) for _ in range(12)]
    assert np.median(ours) < np.median(chance)


def test_points_are_the_same_however_they_are_asked_for() -> None:
    whole = Halton(4, 3).points(0, 50)
    np.testing.assert_array_equal(Halton(4, 3).points(17, 31), whole[17:31])
    # A further axis changes nothing of the ones before.
    np.testing.assert_array_equal(Halton(6, 3).points(0, 50)[:, :4], whole)
    assert not np.any(np.all(Halton(4, 4).points(0, 50) == whole, axis=1))
    assert Halton(0, 1).points(0, 3).shape == (3, 0)


def test_the_sequence_needs_no_casadi() -> None:
    """In a fresh interpreter, wherever its module is."""
    loaded = loaded_after(f"import {Halton.__module__}")
    assert "numpy" in loaded
    assert {name.partition(".")[0] for name in loaded}.isdisjoint({"casadi", "scipy", "flint"})
