"""Functions over many samples agree with themselves, sample by sample."""

from __future__ import annotations

import casadi as ca
import numpy as np
import pytest

from compiler.discretisation.batched_function import MOST_IN_BATCH, BatchedFunction


def function() -> ca.Function:
    """Entries of every kind: of samples, of shared inputs alone, a literal, structurally zero."""
    a, b, shared = (ca.SX.sym(name, size) for name, size in (("a", 2), ("b", 1), ("s", 3)))
    rows = [
        [a[0] * ca.sin(b), a[1] / shared[0], -ca.sqrt(ca.fabs(a[0]))],
        [shared[1] * shared[2], ca.SX(7), ca.SX(0)],
    ]
    matrix = ca.vertcat(*(ca.horzcat(*row) for row in rows))
    return ca.Function("f", [a, b, shared], [ca.densify(matrix)])


@pytest.mark.parametrize(
    "count", [0, 1, 5, MOST_IN_BATCH, MOST_IN_BATCH + 1, 3 * MOST_IN_BATCH - 1]
)
def test_all_samples_are_as_one_by_one(count: int) -> None:
    scalar, rng = function(), np.random.default_rng(count)
    batch = BatchedFunction.of(scalar)
    a, b, shared = rng.normal(size=(count, 2)), rng.normal(size=(count, 1)), rng.normal(size=3)
    for turn in range(2):
        found = batch((a + turn, b), shared * (1 + turn))
        assert found.shape == (count, 2, 3)
        for row in range(count):
            one = np.asarray(scalar(a[row] + turn, b[row], shared * (1 + turn)).full())
            np.testing.assert_allclose(found[row], one, rtol=1e-15, atol=0)


def test_results_outlive_the_next_call() -> None:
    batch = BatchedFunction.of(function())
    a, b, shared = np.ones((4, 2)), np.ones((4, 1)), np.ones(3)
    first = batch((a, b), shared)
    kept = first.copy()
    batch((5 * a, b), shared)
    np.testing.assert_array_equal(first, kept)


def test_strided_columns_and_inputs_without_entries() -> None:
    a, none, shared = (ca.SX.sym(name, size) for name, size in (("a", 2), ("n", 0), ("s", 0)))
    batch = BatchedFunction.of(ca.Function("g", [a, none, shared], [ca.vertcat(a[1], 2 * a[0])]))
    whole = np.arange(24.0).reshape(6, 4)
    found = batch((whole[:, 1:3], np.zeros((6, 0))), np.zeros(0))
    expected = np.stack([whole[:, 2], 2 * whole[:, 1]], axis=1)[:, :, None]
    np.testing.assert_array_equal(found, expected)


def test_the_last_block_may_overlap() -> None:
    """More samples than batch, not a multiple of them: nothing is left out or mixed up."""
    a, shared = ca.SX.sym("a"), ca.SX.sym("s")
    batch = BatchedFunction.of(ca.Function("h", [a, shared], [a * shared]))
    count = 2 * MOST_IN_BATCH + 3
    column = np.arange(count, dtype=float)[:, None]
    found = batch((column,), np.array([3.0]))
    np.testing.assert_array_equal(found[:, 0, 0], 3 * column[:, 0])
