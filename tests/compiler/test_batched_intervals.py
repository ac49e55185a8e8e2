"""Interval arithmetic in batches against samples, and against extrema that are known."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest

from compiler.arrays import Array
from compiler.expressions.evaluators.intervals import (
    BatchedIntervalEvaluator,
    IntervalBatch,
)

SLACK = 1e-12
UNARY: dict[str, Callable[[Array], Array]] = {
    "neg": lambda x: -x, "sq": lambda x: x * x, "sqrt": np.sqrt, "sin": np.sin, "cos": np.cos,
    "tan": np.tan, "fabs": np.abs, "sign": np.sign, "inv": lambda x: 1 / x,
    "twice": lambda x: 2 * x,
}  # fmt: skip
BINARY: dict[str, Callable[[Array, Array], Array]] = {
    "add": np.add, "sub": np.subtract, "mul": np.multiply, "div": np.divide,
}  # fmt: skip


def intervals(seed: int, count: int = 400) -> tuple[IntervalBatch, Array]:
    """Random intervals, narrow and wide, and samples of each (S, K), ends included."""
    rng = np.random.default_rng(seed)
    low = rng.uniform(-8, 8, count)
    high = low + 10 ** rng.uniform(-3, 1, count)
    t = np.concatenate([[0.0, 1.0], rng.uniform(size=200)])[:, None]
    return IntervalBatch(low, high), np.clip(low + t * (high - low), low, high)


def check(found: IntervalBatch, values: Array) -> None:
    known = ~np.isnan(found.low)
    assert known.any()
    low, high = found.low[known], found.high[known]
    assert np.all(low - SLACK * np.maximum(1, abs(low)) <= values[:, known])
    assert np.all(values[:, known] <= high + SLACK * np.maximum(1, abs(high)))


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("name", UNARY)
def test_functions_hold_all_values(name: str) -> None:
    argument, samples = intervals(1)
    found = getattr(BatchedIntervalEvaluator(), name)(argument)
    check(found, UNARY[name](samples))
    if name in ("inv", "tan", "sqrt"):
        # Exactly what has a pole, or leaves the domain, is not known.
        bad = {
            "inv": (argument.low <= 0) & (argument.high >= 0),
            "sqrt": argument.low < 0,
            "tan": np.cos(argument.low) * np.cos(argument.high) <= 0,
        }[name]
        assert np.all(np.isnan(found.low)[bad])
        assert not np.isnan(found.low)[argument.high - argument.low < 0.01].all()


@pytest.mark.filterwarnings("ignore::RuntimeWarning")
@pytest.mark.parametrize("name", BINARY)
def test_operations_hold_all_values(name: str) -> None:
    (left, a), (right, b) = intervals(2), intervals(3)
    found = getattr(BatchedIntervalEvaluator(), name)(left, right)
    check(found, BINARY[name](a, np.random.default_rng(4).permuted(b, axis=0)))
    check(found, BINARY[name](a, b[::-1]))


def test_waves_are_as_sharp_as_they_can_be() -> None:
    ends = [(0.1, 0.2), (-0.1, 0.3), (3.0, 3.3), (1.0, 2.0), (-4.0, -2.0), (0.0, 7.0), (9.0, 10.0)]
    batch = IntervalBatch(np.array([a for a, _ in ends]), np.array([b for _, b in ends]))
    for name, function in (("cos", math.cos), ("sin", math.sin)):
        found = getattr(BatchedIntervalEvaluator(), name)(batch)
        for i, (a, b) in enumerate(ends):
            values = [function(a + (b - a) * k / 20_000) for k in range(20_001)]
            assert found.low[i] == pytest.approx(min(values), abs=1e-6)
            assert found.high[i] == pytest.approx(max(values), abs=1e-6)


def test_what_is_not_known_stays_unknown() -> None:
    run = BatchedIntervalEvaluator()
    hole = run.inv(IntervalBatch(np.array([-1.0, 1.0]), np.array([1.0, 2.0])))
    total = run.add(run.constant(3), run.sq(hole))
    assert np.isnan(total.low[0])
    assert np.isnan(total.high[0])
    assert (total.low[1], total.high[1]) == (3.25, 4.0)
