from fractions import Fraction

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st
from scipy.optimize import linprog
from scipy.spatial import ConvexHull, HalfspaceIntersection

from compiler.workspaces.polytope import Polytope, half_space_complement, polytope_of
from grammar_lang.ir import HalfSpace, Hull, Inequalities
from tests.oracles.planes import box_rows, in_hull, points, polygons, row, turn
from tests.oracles.some_cases import examples

SETTINGS = settings(max_examples=examples(40, 80), deadline=None)


def small_rows(dimension, least, most):
    entry = st.integers(-3, 3)
    one = st.tuples(*([entry] * dimension), st.integers(-4, 6))
    return st.lists(one.map(lambda e: row(*e)), min_size=least, max_size=most)


def arrays(rows):
    return (
        np.array([[float(a) for a in r.normal] for r in rows]),
        np.array([float(r.offset) for r in rows]),
    )


def test_a_box_with_a_redundant_row():
    polytope = Polytope((*box_rows(("1.7", 3), (2, 3)).rows, row(1, 1, 10), row(2, 0, 6)))
    assert polytope.vertices == ((Fraction(17, 10), 2), (3, 2), (3, 3), (Fraction(17, 10), 3))
    assert polytope.volume == Fraction(13, 10)
    assert polytope.centre == (Fraction(47, 20), Fraction(5, 2))
    assert polytope.irredundant().rows == box_rows(("1.7", 3), (2, 3)).rows
    assert polytope.inequalities() == [
        "x <= 3", "-x <= -17/10", "y <= 3", "-y <= -2", "x + y <= 10", "x <= 3",
    ]  # fmt: skip
    assert np.allclose(polytope.A[4], np.sqrt([0.5, 0.5]))
    assert polytope.b[4] == pytest.approx(10 / np.sqrt(2))


@pytest.mark.parametrize(
    ("rows", "empty", "bounded", "dimension"),
    [
        ([row(1, 0, 3)], False, False, 2),
        ([row(1, 0, 3), row(-1, 0, -4)], True, True, -1),
        ([row(1, 0, 3), row(-1, 0, -3)], False, False, 1),
        ([row(0, 0, 1)], False, False, 2),
        ([row(0, 0, -1)], True, True, -1),
        ([row(0, 0, 0), *box_rows((0, 1), (0, 1)).rows], False, True, 2),
        ([*box_rows((1, 1), (0, 1)).rows], False, True, 1),
        ([*box_rows((1, 1), (2, 2)).rows], False, True, 0),
        ([row(-1, 0, 0), row(0, -1, 0)], False, False, 2),
        ([row(-1, 0, 0), row(0, -1, 0), row("0.001", 1, 1)], False, True, 2),
        ([*box_rows((0, 1), (0, 1), (0, 1)).rows], False, True, 3),
        ([*box_rows((0, 1), (0, 1), (0, 0)).rows], False, True, 2),
        ([*box_rows((0, 1), (0, 1), (0, 1)).rows[:-1]], False, False, 3),
    ],
)
def test_empty_bounded_and_dimension(rows, empty, bounded, dimension):
    polytope = Polytope(tuple(rows))
    assert polytope.is_empty is empty
    assert polytope.is_bounded is bounded
    assert polytope.affine_dimension == dimension
    assert polytope.has_interior is (dimension == polytope.dimension)


@SETTINGS
@given(small_rows(2, 1, 7) | small_rows(3, 1, 8))
def test_emptiness_and_boundedness_agree_with_linear_programming(rows):
    polytope, (a, b) = Polytope(tuple(rows)), arrays(rows)
    dimension = a.shape[1]
    free = [(None, None)] * dimension
    feasible = linprog(np.zeros(dimension), a, b, bounds=free).status == 0
    assert polytope.is_empty is not feasible
    if feasible:
        # bounded iff the recession cone, cut to the unit cube, is the origin
        cube = [(-1, 1)] * dimension
        reach = [
            -linprog(s * e, a, 0 * b, bounds=cube).fun for e in np.eye(dimension) for s in (1, -1)
        ]
        assert polytope.is_bounded is bool(max(reach) < 1e-6)


@SETTINGS
@given(small_rows(2, 0, 5), st.data())
def test_vertices_and_volume_agree_with_qhull_in_the_plane(rows, data):
    check_with_qhull(Polytope((*box_rows((-3, 4), (-2, 5)).rows, *rows)))


@SETTINGS
@given(small_rows(3, 0, 5))
def test_vertices_and_volume_agree_with_qhull_in_space(rows):
    check_with_qhull(Polytope((*box_rows((-3, 4), (-2, 5), (-1, 3)).rows, *rows)))


def check_with_qhull(polytope):
    assume(polytope.has_interior)
    a, b = polytope.A, polytope.b
    inner = np.array([float(x) for x in polytope.centre])
    assert (a @ inner < b).all()
    theirs = HalfspaceIntersection(np.column_stack([a, -b]), inner).intersections
    ours = np.array([[float(x) for x in v] for v in polytope.vertices])
    assert all(np.abs(ours - p).max(axis=1).min() < 1e-6 for p in theirs)
    assert all(np.abs(theirs - p).max(axis=1).min() < 1e-6 for p in ours)
    assert float(polytope.volume) == pytest.approx(ConvexHull(ours).volume, rel=1e-9)
    assert (polytope.box[0] < ours.min(axis=0)).all()
    assert (polytope.box[1] > ours.max(axis=0)).all()


@SETTINGS
@given(polygons())
def test_vertices_of_a_polygon_turn_left_at_every_corner(shape):
    corners = polytope_of(shape, 2).vertices
    assert set(corners) <= set(shape.points)
    for i in range(len(corners)):
        assert turn(corners[i - 2], corners[i - 1], corners[i]) > 0


@SETTINGS
@given(polygons(), points)
def test_points_of_a_hull(shape, point):
    assert polytope_of(shape, 2).contains_point(point) is in_hull(shape.points, point)


@SETTINGS
@given(polygons(), polygons())
def test_intersection_laws(left, right):
    first, second = polytope_of(left, 2), polytope_of(right, 2)
    common = first.intersection(second)
    assert first.meets(second) is not common.is_empty
    assert first.separated_interiors(second) is (common.volume == 0)
    assert first.contains(common)
    assert second.contains(common)
    assert first.contains(second) is all(in_hull(left.points, p) for p in right.points)
    assert set(common.vertices) == set(second.intersection(first).vertices)
    assert set(common.vertices) == set(Polytope(common.rows).vertices)
    if common.has_interior:
        slim = common.irredundant()
        assert slim.vertices == common.vertices == Polytope(slim.rows).vertices
        assert len(slim.rows) == len(slim.vertices)


@SETTINGS
@given(small_rows(3, 0, 4), small_rows(3, 1, 1))
def test_a_cut_splits_the_volume(rows, cut):
    whole = Polytope((*box_rows((-3, 4), (-2, 5), (-1, 3)).rows, *rows))
    parts = whole.clipped(cut[0]), whole.clipped(half_space_complement(cut[0]))
    assume(any(cut[0].normal))
    assert sum(part.volume for part in parts) == whole.volume
    for part in parts:
        if part.has_interior:
            slim = part.irredundant()
            assert slim.volume == part.volume
            assert slim.vertices == Polytope(slim.rows).vertices == part.vertices


def test_what_has_no_answer_is_an_error():
    half_plane, nothing = Polytope((row(1, 0, 3),)), Polytope((row(0, 0, -1),))
    with pytest.raises(ValueError, match="unbounded"):
        _ = half_plane.vertices
    with pytest.raises(ValueError, match="unbounded"):
        _ = half_plane.volume
    with pytest.raises(ValueError, match="unbounded"):
        nothing.contains(half_plane)
    with pytest.raises(ValueError, match="no centre"):
        _ = nothing.centre
    with pytest.raises(ValueError, match="no bounding box"):
        _ = nothing.box
    with pytest.raises(ValueError, match="interior"):
        nothing.irredundant()
    with pytest.raises(ValueError, match="at least one row"):
        Polytope(())
    with pytest.raises(ValueError, match="one dimension"):
        Polytope((row(1, 0, 3), row(1, 3)))


def test_unbounded_sets_can_be_cut_and_slimmed():
    strip = Polytope((row(1, 0, 3), row(-1, 0, 0), row(1, 0, 4)))
    assert strip.irredundant().rows == strip.rows[:2]
    square = strip.intersection(Polytope((row(0, 1, 2), row(0, -1, 0))))
    assert not strip.intersection(Polytope((row(1, 1, 0),))).is_bounded
    assert square.volume == 6
    assert polytope_of(Inequalities(()), 3).affine_dimension == 3


def test_inequalities_are_scaled_to_primitive_normals():
    shape = Polytope((row("0.5", "-0.75", "1/3"), row(-4, 6, 8), row(0, 0, 1)))
    assert shape.inequalities() == ["2*x - 3*y <= 4/3", "-2*x + 3*y <= 4", "0 <= 1"]
    assert Polytope((row(0, -1, 2, 1),)).inequalities() == ["-y + 2*z <= 1"]


def test_exact_where_floats_are_not():
    tiny = Fraction(1, 10**30)
    sliver = Polytope((*box_rows((0, tiny), (0, 1)).rows,))
    assert sliver.volume == tiny
    assert Polytope(box_rows((tiny, 0), (0, 1)).rows).is_empty
    third = polytope_of(
        Hull(
            ((Fraction(0), Fraction(0)), (Fraction(1), Fraction(1, 3)), (Fraction(1), Fraction(0)))
        ),
        2,
    )
    assert third.contains_point((Fraction(3, 7), Fraction(1, 7)))
    assert not third.contains_point((Fraction(3, 7), Fraction(1, 7) + tiny))
    assert isinstance(third.rows[0], HalfSpace)
