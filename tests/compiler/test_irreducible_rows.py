from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from compiler.checks.region_checks import irreducible_rows
from compiler.workspaces.polytope import Polytope
from tests.oracles.planes import box_rows, row
from tests.oracles.some_cases import examples

SETTINGS = settings(max_examples=examples(60, 120), deadline=None)


def rows_of(dimension: int) -> st.SearchStrategy:
    entry = st.integers(-3, 3)
    one = st.tuples(*([entry] * dimension), st.integers(-4, 3))
    return st.lists(one.map(lambda e: row(*e)), min_size=2, max_size=9)


def depth(rows: list) -> float:
    """The largest slack, up to 1, that all rows can have at once; negative where there is none."""
    if not rows:
        return 1.0
    a = np.array([[*map(float, r.normal), 1.0] for r in rows])
    b = np.array([float(r.offset) for r in rows])
    bounds = [(None, None)] * (a.shape[1] - 1) + [(None, 1)]
    solved = linprog([0.0] * (a.shape[1] - 1) + [-1.0], a, b, bounds=bounds)
    assert solved.status == 0
    return -solved.fun


def without_each(rows):
    return [[r for r in rows if r is not left] for left in rows]


@SETTINGS
@given(rows_of(2) | rows_of(3))
def test_contradictions_agree_with_linear_programming(rows):
    if not Polytope(tuple(rows)).is_empty:
        return
    few = irreducible_rows(rows, lambda part: part.is_empty)
    assert [r for r in rows if any(r is one for one in few)] == list(few)
    assert len(few) <= len(rows[0].normal) + 1
    assert depth(list(few)) < -1e-9
    assert all(depth(rest) > -1e-9 for rest in without_each(few))


@SETTINGS
@given(rows_of(2) | rows_of(3), st.data())
def test_lost_interiors_agree_with_linear_programming(rows, data):
    rows = [r for r in rows if any(r.normal)]  # `0 <= 0` has an interior, but no slack
    if not rows:
        return
    opposite = data.draw(st.sampled_from(rows))
    rows.append(row(*(-a for a in opposite.normal), -opposite.offset))
    shape = Polytope(tuple(rows))
    if shape.is_empty or shape.has_interior:
        return
    few = irreducible_rows(rows, lambda part: not part.has_interior)
    assert len(few) <= shape.dimension + 1
    assert depth(list(few)) < 1e-9
    assert all(depth(rest) > 1e-9 for rest in without_each(few))


@pytest.mark.parametrize(
    ("rows", "expected"),
    [
        ([row(1, 0, 1), row(0, 1, 1), row(-1, 0, -2)], (0, 2)),
        ([row(0, 1, 0), row(0, 0, -1), row(0, -1, -1)], (1,)),
        ([row(1, 1, 0), row(0, 1, 9), row(-1, 0, -1), row(0, -1, 0), row(1, 0, 9)], (0, 2, 3)),
        ([*box_rows((0, 1), (0, 1), (0, 1)).rows, row(1, 1, 1, -1)], (1, 3, 5, 6)),
    ],
)
def test_which_rows(rows, expected):
    few = irreducible_rows(rows, lambda part: part.is_empty)
    assert few == tuple(rows[i] for i in expected)


def test_many_rows():
    rows = [row(i % 7 - 3, i % 5 - 2, 100 + i) for i in range(300)]
    rows.insert(100, row(1, 0, -20))
    rows.append(row(-1, 0, 19))
    few = irreducible_rows(rows, lambda part: part.is_empty)
    assert few == (rows[100], rows[-1])
