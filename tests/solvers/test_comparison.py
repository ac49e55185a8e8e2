"""Bounds of cooperative linear systems against exponentials of matrices to 60 digits."""

from __future__ import annotations

import numpy as np
import pytest
from flint import arb, arb_mat

from compiler.arrays import Array
from compiler.expressions.evaluators.balls import working_precision
from solvers.verifier.proofs.a_priori import comparison


def solution(rates: Array, push: Array, start: Array, time: float) -> Array:
    """y(time) of y' = J y + k from the exponential of a matrix with one row more, to 60 digits."""
    size = len(push)
    matrix = np.zeros((size + 1, size + 1))
    matrix[:size, :size], matrix[:size, size] = rates, push
    with working_precision(400):
        flow = (arb_mat(matrix.tolist()) * arb(time)).exp()
        found = flow * arb_mat([[arb(x)] for x in (*start, 1.0)])
        return np.array([float(found[i, 0]) for i in range(size)])


def bounds(rates: Array, push: Array, start: Array, time: float) -> Array:
    with working_precision(53):
        found = comparison(
            arb_mat(rates.tolist()), list(map(arb, push)), list(map(arb, start)), arb(time)
        )
    return np.array([float(item) for item in found])


@pytest.mark.parametrize("seed", range(20))
def test_bounds_hold_solutions_and_are_close(seed: int) -> None:
    rng = np.random.default_rng(seed)
    size = int(rng.integers(1, 7))
    rates = rng.uniform(0, 1, (size, size)) * 10.0 ** rng.uniform(-3, 1, (size, size))
    push, start = (rng.uniform(0, 1, size) * 10.0 ** rng.uniform(-9, 0, size) for _ in range(2))
    time = float(rng.uniform(0, 0.5) / max(1.0, rates.sum(axis=1).max()))
    exact, found = solution(rates, push, start, time), bounds(rates, push, start, time)
    assert np.all(found >= exact * (1 - 1e-12))
    assert np.all(found <= exact * (1 + 1e-6) + 1e-12 * exact.max())


@pytest.mark.parametrize("inertia", [1e-2, 1e-5, 1e-8])
@pytest.mark.parametrize("time", [1e-3, 0.05])
def test_a_wrist_of_small_inertia_with_inputs_that_are_held(inertia: float, time: float) -> None:
    """q' = v, v' = 50 q + u / inertia, u' = 0, as with a controller: J is large, its powers not."""
    rates = np.array([[0, 1, 0], [50, 0, 1 / inertia], [0, 0, 0]])
    start = np.array([1e-12, 1e-11, 1e-12 * inertia])
    push = np.array([0, 1e-13, 0])
    exact, found = solution(rates, push, start, time), bounds(rates, push, start, time)
    assert np.all(found >= exact * (1 - 1e-12))
    assert np.all(found <= exact * 1.001 + 1e-25)


def test_a_system_that_grows_too_fast_is_refused() -> None:
    for rates in ([[1e4]], [[0, 1e3], [1e3, 0]]):
        size = len(rates)
        with pytest.raises(ZeroDivisionError, match="grows too fast"):
            bounds(np.array(rates), np.ones(size), np.ones(size), 1.0)
