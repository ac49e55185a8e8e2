"""What `benchmarks/search.py` searches: known optima, exact interpolation, values without noise."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator

from benchmarks.search_functions import (
    SHIFT,
    ackley,
    interpolated,
    lifted,
    rastrigin,
    robustness_table,
)


@pytest.mark.parametrize("p", [1, 2, 4])
@pytest.mark.parametrize("function", [rastrigin, ackley])
def test_the_functions_are_greatest_where_the_literature_says(function, p: int) -> None:
    assert function(np.zeros(p)) == pytest.approx(0, abs=1e-12)
    points = np.random.default_rng(p).uniform(-0.75, 0.75, size=(2000, p))
    assert np.all(function(points) < 0)
    assert function(points).shape == (2000,)


def test_the_functions_by_hand() -> None:
    """One period from the origin the waves are where they were, and the bowls are deeper."""
    assert rastrigin(np.array([2 / 10.24, -1 / 10.24])) == pytest.approx(-5)
    deeper = 20 * np.exp(-0.2 * np.sqrt(5 / 2)) - 20
    assert ackley(np.array([0.2, -0.1])) == pytest.approx(deeper)


@pytest.mark.parametrize("function", [rastrigin, ackley])
def test_every_seed_has_its_optimum_somewhere_else(function) -> None:
    objective = lifted("a function", function, 2, 30)
    assert objective.target == pytest.approx(0.95 * objective.best)
    centres = set()
    for seed in range(20):
        moved = objective.of_seed(seed)
        assert moved == objective.of_seed(seed)
        centre = np.array(moved.centre)
        assert np.all(np.abs(centre - 0.5) <= SHIFT)
        assert moved.value(centre) == pytest.approx(objective.best)
        corners = [moved.value(np.array([x, y], dtype=float)) for x in (0, 1) for y in (0, 1)]
        # The worst value was sampled.
        assert -0.05 * objective.best <= min(corners) < moved.target
        centres.add(moved.centre)
    assert len(centres) == 20
    other = pickle.loads(pickle.dumps(objective.of_seed(3)))
    assert other.value(np.array([0.2, 0.7])) == objective.of_seed(3).value(np.array([0.2, 0.7]))


@pytest.mark.parametrize("p", [1, 2, 3])
def test_tables_are_interpolated_as_scipy_does(p: int) -> None:
    rng = np.random.default_rng(p)
    table = rng.normal(size=(4,) * p)
    theirs = RegularGridInterpolator([np.linspace(0, 1, 4)] * p, table)
    points = np.concatenate([rng.uniform(size=(50, p)), np.zeros((1, p)), np.ones((1, p))])
    np.testing.assert_allclose([interpolated(table, x) for x in points], theirs(points), atol=1e-12)


def test_a_table_without_anything_feasible_is_no_objective() -> None:
    objective = robustness_table("good", np.array([[1.0, -2.0], [4.0, 0.5]]), 10)
    assert (objective.best, objective.dimension, objective.noise) == (4.0, 2, 0)
    assert objective.of_seed(7) == objective
    assert objective.value(np.array([1.0, 0.0])) == 4
    with pytest.raises(SystemExit, match="nothing in the table is feasible"):
        robustness_table("bad", -np.ones((2, 2)), 10)
