"""The few differences that are taken of two bodies, against all of them."""

from __future__ import annotations

import numpy as np
import pytest

from compiler.discretisation.hull_distance import nearest_to_zero
from compiler.discretisation.near_differences import (
    FAR,
    KEPT,
    near_differences,
    near_differences_of_pairs,
    nearest_differences,
)
from tests.oracles.hulled_arms import hull_gap


def bodies(seed: int, count: int = 60) -> tuple[np.ndarray, np.ndarray]:
    """Pairs of sets of points, far from each other, near, and meeting."""
    rng = np.random.default_rng(seed)
    d = 2 + seed % 2
    one, two = (rng.normal(size=(count, int(rng.integers(1, 40)), d)) for _ in range(2))
    if seed % 3 == 0:  # On a grid, so that many are as low as each other.
        one, two = np.round(one), np.round(two)
    return one, two + rng.normal(size=(count, 1, d)) * rng.choice([0.1, 2, 4, 20], (count, 1, 1))


@pytest.mark.parametrize("seed", range(12))
def test_the_nearest_point_is_between_them(seed: int) -> None:
    one, two = bodies(seed)
    away, first, second = nearest_differences(one, two)
    row = np.arange(len(one))[:, None]
    true = np.array([hull_gap(*pair) for pair in zip(one, two, strict=True)])
    assert np.linalg.norm(away, axis=1) == pytest.approx(true, abs=1e-6)
    between = nearest_to_zero(one[row, first] - two[row, second])
    assert between == pytest.approx(away, abs=1e-6)


@pytest.mark.parametrize("seed", range(24))
def test_they_are_as_near_as_all(seed: int) -> None:
    """Except where bodies are far from each other: there they are no nearer."""
    one, two = bodies(seed)
    first, second = near_differences(one, two)
    assert first.shape == second.shape == (len(one), KEPT)
    row = np.arange(len(one))[:, None]
    found = [hull_gap(each, np.zeros((1, each.shape[1])))
             for each in one[row, first] - two[row, second]]  # fmt: skip
    true = np.array([hull_gap(*pair) for pair in zip(one, two, strict=True)])
    extent = np.maximum(np.ptp(one, axis=1).max(axis=1), np.ptp(two, axis=1).max(axis=1))
    far = true > FAR * extent
    assert np.array(found)[~far] == pytest.approx(true[~far], abs=1e-6)
    assert (np.array(found)[far] >= true[far] - 1e-6).all()
    assert (np.array(found)[far] <= 1.5 * true[far]).all()


@pytest.mark.parametrize("seed", range(6))
def test_pairs_of_other_numbers_of_points_go_together(seed: int) -> None:
    rng = np.random.default_rng(seed)
    sizes = [(3, 20), (1, 1), (32, 7), (16, 16)]
    pairs = [
        (rng.normal(size=(5, a, 3)), rng.normal(size=(5, b, 3)) + rng.normal(size=(5, 1, 3)))
        for a, b in sizes
    ]
    row = np.arange(5)[:, None]
    for (one, two), (first, second) in zip(pairs, near_differences_of_pairs(pairs), strict=True):
        away = nearest_to_zero(one[row, first] - two[row, second])
        true = [hull_gap(*pair) for pair in zip(one, two, strict=True)]
        assert np.linalg.norm(away, axis=1) == pytest.approx(np.array(true), abs=1e-6)
