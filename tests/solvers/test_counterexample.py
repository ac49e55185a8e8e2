"""ZEROPREFIX against its definition by brute force."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from solvers.motions.counterexample import zero_prefix

SLACKS = st.lists(st.sampled_from([0.0, 1e-4, 0.5, 2.0]), max_size=12)


@given(SLACKS, st.sampled_from([1e-3, 0.7]))
def test_it_is_the_least_prefix_above_the_threshold(slacks: list[float], threshold: float) -> None:
    wanted = next((m for m in range(len(slacks)) if sum(slacks[: m + 1]) > threshold), len(slacks))
    assert zero_prefix(np.array(slacks), threshold) == wanted
