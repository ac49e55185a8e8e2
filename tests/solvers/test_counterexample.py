"""ZEROPREFIX against its definition by brute force."""

from __future__ import annotations

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from grammar_lang.load import load_text
from solvers.search.path_task import stuck_text
from solvers.trajectory.counterexample import infeasible_prefix, zero_prefix
from tests.oracles.small_specs import TURNER

SLACKS = st.lists(st.sampled_from([0.0, 1e-4, 0.5, 2.0]), max_size=12)


@given(SLACKS, st.sampled_from([1e-3, 0.7]))
def test_it_is_the_least_prefix_above_the_threshold(slacks: list[float], threshold: float) -> None:
    wanted = next((m for m in range(len(slacks)) if sum(slacks[: m + 1]) > threshold), len(slacks))
    assert zero_prefix(np.array(slacks), threshold) == wanted


@given(st.integers(0, 12), st.lists(st.integers(1, 4), min_size=1, max_size=5))
def test_the_cells_that_are_entered_up_to_a_sample(sample: int, gaps: list[int]) -> None:
    entries = tuple(sum(gaps[:i]) for i in range(len(gaps)))
    assert infeasible_prefix(sample, entries) == sum(entry <= sample for entry in entries)
    assert infeasible_prefix(None, entries) == len(entries)


def test_where_a_motion_cannot_go_on() -> None:
    program = load_text(TURNER, "spec.srg").program  # 10 steps of 0.2 s
    assert program is not None
    task = program.tasks["Turn"]
    assert stuck_text(4, task) == "the motion cannot go on at 0.8 s"
    assert stuck_text(10, task) == "the motion does not get there by 2 s"
