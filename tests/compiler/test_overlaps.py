from __future__ import annotations

import itertools

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog

from compiler.workspaces.overlaps import candidates, interiors_meet
from compiler.workspaces.polytope import Polytope, polytope_of
from tests.oracles.planes import box_rows, boxes, hull, polygons, row
from tests.oracles.some_cases import examples

SETTINGS = settings(max_examples=examples(40, 80), deadline=None)
ends = st.tuples(st.integers(0, 6), st.integers(1, 3)).map(lambda t: (t[0], t[0] + t[1]))


def all_pairs(shapes):
    return sorted((i, j) for i, j in candidates(shapes) if interiors_meet(shapes[i], shapes[j]))


@SETTINGS
@given(st.sampled_from([2, 3]).flatmap(lambda n: st.lists(st.tuples(*[ends] * n), max_size=9)))
def test_boxes_by_interval_arithmetic(sides):
    shapes = [Polytope(box_rows(*one).rows) for one in sides]
    expected = [
        (i, j)
        for i, j in itertools.combinations(range(len(sides)), 2)
        if all(a < d and c < b for (a, b), (c, d) in zip(sides[i], sides[j], strict=True))
    ]
    assert sorted(candidates(shapes)) == expected
    assert all_pairs(shapes) == expected


def depth(*shapes):
    """The radius of a largest ball, at most 1, in the intersection; negative where it is empty."""
    a = np.vstack([np.column_stack([s.A, np.ones(len(s.rows))]) for s in shapes])
    b = np.concatenate([s.b for s in shapes])
    size = a.shape[1] - 1
    solved = linprog([0.0] * size + [-1.0], a, b, bounds=[(None, None)] * size + [(None, 1)])
    assert solved.status == 0
    return -solved.fun


@SETTINGS
@given(st.lists(polygons() | boxes(), min_size=2, max_size=5))
def test_polygons_by_linear_programming(shapes):
    polytopes = [polytope_of(shape, 2) for shape in shapes]
    expected = [
        (i, j)
        for i, j in itertools.combinations(range(len(polytopes)), 2)
        if depth(polytopes[i], polytopes[j]) > 1e-7
    ]
    assert all_pairs(polytopes) == expected


@SETTINGS
@given(st.data())
def test_polyhedra_by_linear_programming(data):
    entry = st.integers(-2, 2)
    rows = st.lists(st.tuples(entry, entry, entry, st.integers(0, 2)), max_size=3)
    shapes = []
    for x in (0, data.draw(st.integers(0, 3))):
        cut = [row(a, b, c, d + a * x) for a, b, c, d in data.draw(rows) if (a, b, c) != (0, 0, 0)]
        made = Polytope((*box_rows((x - 2, x + 2), (-2, 2), (-2, 2)).rows, *cut))
        if not made.has_interior:
            return
        shapes.append(made.irredundant())
    assert interiors_meet(*shapes) is bool(depth(*shapes) > 1e-7)


def test_two_tetrahedra_that_an_edge_pair_separates():
    # edges along x below and along y above: no facet of either separates them
    low = polytope_of_points((-1, 0, 0), (1, 0, 0), (0, -1, -1), (0, 1, -1))
    high = polytope_of_points((0, -1, 0), (0, 1, 0), (-1, 0, 1), (1, 0, 1))
    assert not interiors_meet(low, high)
    sunk = polytope_of_points((0, -1, "-0.1"), (0, 1, "-0.1"), (-1, 0, 1), (1, 0, 1))
    assert interiors_meet(low, sunk)


def polytope_of_points(*points):
    return polytope_of(hull("H", "region", *points).shape, 3)


def test_few_candidates_in_a_grid():
    shapes = [Polytope(box_rows((i, i + 1), (j, j + 1)).rows) for i in range(12) for j in range(12)]
    assert list(candidates(shapes)) == []
    assert list(candidates(shapes[:1])) == list(candidates([])) == []
