import time
from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog
from scipy.spatial import ConvexHull

from compiler.workspaces.hull import hull_rows
from compiler.workspaces.polytope import Polytope
from tests.oracles.some_cases import examples

coordinate = st.integers(-6, 6).map(lambda n: Fraction(n, 3))


def clouds(dimension):
    return st.lists(st.tuples(*[coordinate] * dimension), min_size=1, max_size=9)


@settings(max_examples=examples(60, 120), deadline=None)
@given(clouds(1) | clouds(2) | clouds(3))
def test_the_hull_is_the_least_convex_set(cloud):
    shape = Polytope(hull_rows(cloud))
    assert shape.is_bounded
    assert all(shape.contains_point(point) for point in cloud)
    assert {vertex.point() for vertex in shape.description.vertices} <= set(cloud)
    differences = np.array(
        [[float(a - b) for a, b in zip(p, cloud[0], strict=True)] for p in cloud]
    )
    assert shape.affine_dimension == np.linalg.matrix_rank(differences)


@settings(max_examples=60, deadline=None)
@given(clouds(2) | clouds(3), st.data())
def test_membership_agrees_with_convex_combinations(cloud, data):
    dimension = len(cloud[0])
    point = data.draw(st.tuples(*[coordinate] * dimension))
    a = np.vstack([np.array(cloud, dtype=float).T, np.ones(len(cloud))])
    b = np.array([*map(float, point), 1.0])
    inside = linprog(np.zeros(len(cloud)), A_eq=a, b_eq=b).status == 0
    assert Polytope(hull_rows(cloud)).contains_point(point) is inside


@settings(max_examples=40, deadline=None)
@given(clouds(3))
def test_volumes_agree_with_qhull(cloud):
    shape = Polytope(hull_rows(cloud))
    if shape.has_interior:
        theirs = ConvexHull(np.array(cloud, dtype=float))
        assert float(shape.volume) == pytest.approx(theirs.volume)
        assert len(shape.rows) == len(np.unique(theirs.equations.round(6), axis=0))
        assert hull_rows(cloud[::-1]) == shape.rows


def test_a_cube_and_its_middle():
    corners = [tuple(map(Fraction, p)) for p in product((0, 2), repeat=3)]
    rows = hull_rows([*corners, (Fraction(1), Fraction(1), Fraction(1))])
    assert len(rows) == 6
    assert Polytope(rows).volume == 8


def test_no_points():
    with pytest.raises(ValueError, match="no points"):
        hull_rows([])


def test_a_polygon_of_thousands_of_corners():
    # points of a parabola are all corners; its hull is found in the time of a sort
    cloud = [(Fraction(x), Fraction(x * x)) for x in range(-2000, 2001)]
    inner = [(Fraction(x), Fraction(x * x + 1)) for x in range(-1999, 2000)]
    started = time.process_time()
    rows = hull_rows([*inner, *cloud])
    assert time.process_time() - started < 2
    assert len(rows) == len(cloud)
    assert rows == hull_rows(cloud)
