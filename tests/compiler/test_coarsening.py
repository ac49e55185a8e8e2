from __future__ import annotations

from itertools import combinations

from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.workspaces.convex_pieces import coarsened, convex_pieces, is_division
from compiler.workspaces.partition import divide, glue
from compiler.workspaces.polytope import Polytope, polytope_of
from tests.oracles.planes import box_rows, in_shape, points, polygons
from tests.oracles.some_cases import examples

SETTINGS = settings(max_examples=examples(30, 60), deadline=None)


def square(*sides):
    return Polytope(box_rows(*sides).rows).irredundant()


def left_over(whole, cutters):
    """Pieces of a polygon without others; they may be many, and apart from each other."""
    pieces = [polytope_of(whole, 2).irredundant()]
    for cutter in cutters:
        shape = polytope_of(cutter, 2).irredundant()
        pieces = [part for piece in pieces for part in divide(piece, shape)[0]]
    return pieces


@SETTINGS
@given(polygons(), st.lists(polygons(), max_size=4), st.lists(points, min_size=6, max_size=6))
def test_another_division_of_the_same_set(whole, cutters, samples):
    pieces = left_over(whole, cutters)
    if not pieces:
        return
    for parts in (convex_pieces(pieces), coarsened(pieces)):
        assert sum(part.volume for part in parts) == sum(piece.volume for piece in pieces)
        assert all(a.separated_interiors(b) for a, b in combinations(parts, 2))
        for point in samples:
            # on the boundary of a cutter the pieces, which are closed, still have the point
            before = any(piece.contains_point(point) for piece in pieces)
            assert any(part.contains_point(point) for part in parts) is before
            if not in_shape(whole, point):
                assert not before
        for part in parts:
            assert part.vertices == Polytope(part.rows).vertices
            assert len(part.facets) == len(part.rows)
    assert len(coarsened(pieces)) <= len(glue(pieces))


def test_what_is_no_division():
    halves = [square((0, 1), (0, 2)), square((1, 2), (0, 2))]
    whole = [square((0, 2), (0, 2))]
    assert is_division(halves, whole)
    assert is_division(whole, halves)
    assert not is_division(halves[:1], whole)
    assert not is_division([*halves, square((0, 1), (0, 1))], whole)
    # the areas agree, but a part is outside, or two parts overlap and leave a gap
    assert not is_division([halves[0], square((2, 3), (0, 2))], whole)
    assert not is_division([halves[0], square((0, 1), (0, 2))], whole)


def test_pieces_apart_and_a_hole():
    ring = [square((0, 3), (0, 1)), square((0, 3), (2, 3)), square((0, 1), (1, 2)),
            square((2, 3), (1, 2))]  # fmt: skip
    apart = square((5, 6), (0, 1))
    parts = coarsened([*ring, apart])
    assert len(parts) == 5
    assert is_division(parts, [*ring, apart])
    cross = [square((1, 2), (0, 3)), square((0, 1), (1, 2)), square((2, 3), (1, 2))]
    assert len(coarsened(cross)) == 3
