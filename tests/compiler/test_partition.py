from fractions import Fraction
from itertools import combinations

from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.workspaces.hull import hull_rows
from compiler.workspaces.partition import divide, glue, remainder
from compiler.workspaces.polytope import Polytope, polytope_of
from tests.oracles.planes import box_rows, in_shape, points, polygons
from tests.oracles.some_cases import examples

SETTINGS = settings(max_examples=examples(40, 80), deadline=None)


def square(*sides):
    return Polytope(box_rows(*sides).rows)


@SETTINGS
@given(polygons(), polygons(), st.lists(points, min_size=5, max_size=5))
def test_the_pieces_partition_the_cell(left, right, samples):
    cell, region = (polytope_of(shape, 2).irredundant() for shape in (left, right))
    outside, inside = divide(cell, region)
    parts = [*outside, *([inside] if inside is not None else [])]
    assert sum(part.volume for part in parts) == cell.volume
    assert all(a.separated_interiors(b) for a, b in combinations(parts, 2))
    assert all(part.separated_interiors(region) for part in outside)
    assert inside is None or region.contains(inside)
    assert (inside is None) is cell.separated_interiors(region)
    if inside is None:
        assert outside == (cell,)
    assert len(outside) <= len(region.rows)
    for p in samples:
        assert in_shape(left, p) is any(part.contains_point(p) for part in parts)


@SETTINGS
@given(polygons(), st.lists(polygons(), max_size=3))
def test_gluing_keeps_the_set_and_is_maximal(left, cutters):
    whole = polytope_of(left, 2).irredundant()
    pieces = [whole]
    for cutter in cutters:
        parts = [divide(piece, polytope_of(cutter, 2)) for piece in pieces]
        pieces = [p for out, inner in parts for p in (*out, *([inner] if inner else []))]
    glued = glue(pieces)
    assert len(glued) <= len(pieces)
    assert sum(piece.volume for piece in glued) == whole.volume
    assert all(a.separated_interiors(b) for a, b in combinations(glued, 2))
    assert all(any(big.contains(small) for big in glued) for small in pieces)
    for a, b in combinations(glued, 2):
        # no two pieces left have a convex union: their hull is larger than both together
        corners = (*a.vertices, *b.vertices)
        assert Polytope(hull_rows(corners)).volume > a.volume + b.volume


def test_four_quarters_make_one_square_again():
    half = Fraction(1, 2)
    quarters = [square(x, y) for x in ((0, half), (half, 1)) for y in ((0, half), (half, 1))]
    (whole,) = glue(quarters)
    assert set(whole.vertices) == set(square((0, 1), (0, 1)).vertices)


def test_a_box_in_the_middle_leaves_four_pieces():
    outside, inside = divide(square((0, 3), (0, 3)), square((1, 2), (1, 2)))
    assert len(outside) == 4
    assert inside is not None
    assert inside.volume == 1


def test_a_cover_by_two_leaves_nothing():
    cell = square((0, 2), (0, 1))
    assert remainder(cell, [square((0, 1), (0, 1)), square((1, 2), (0, 1))]) == ()
    (left,) = remainder(cell, [square((0, 1), (-1, 3))])
    assert left.volume == 1
    assert remainder(cell, []) == (cell,)


def test_space():
    cube = Polytope(box_rows((0, 3), (0, 3), (0, 3)).rows)
    inner = Polytope(box_rows((1, 2), (1, 2), (1, 2)).rows)
    outside, inside = divide(cube, inner)
    assert len(outside) == 6
    assert sum(piece.volume for piece in outside) == 26
    assert inside is not None
    (whole,) = glue([*divide(cube, Polytope(box_rows((0, 1), (0, 3), (0, 3)).rows))[0],
                     Polytope(box_rows((0, 1), (0, 3), (0, 3)).rows)])  # fmt: skip
    assert whole.volume == 27
