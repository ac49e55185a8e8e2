"""Triangles in unions of convex pieces, against exact samples, areas of shapely, and algebra."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from shapely.geometry import Polygon, box
from shapely.ops import unary_union

from compiler.workspaces.hull import hull_rows
from srgc.imports.meshes import containment
from srgc.imports.meshes.containment import uncovered
from srgc.imports.meshes.convex_piece import convex_piece

ONE = np.array([[0, 1, 2]])


def block(lower, upper, digits=1):
    return convex_piece(product(*zip(lower, upper, strict=True)), digits)


def in_some(point, all_rows):
    return any(
        all(
            sum(a * x for a, x in zip(row.normal, point, strict=True)) <= row.offset for row in rows
        )
        for rows in all_rows
    )


def rows_of(piece):
    """The planes of a piece by polarity, which the compiler does and containment does not use."""
    unit = Fraction(1, 10**piece.digits)
    return hull_rows([tuple(x * unit for x in corner) for corner in piece.corners])


def exact(point):
    return tuple(map(Fraction, point))


@pytest.mark.parametrize("seed", range(12))
def test_verdicts_agree_with_exact_samples(seed):
    rng = np.random.default_rng(seed)
    pieces = [
        convex_piece(map(tuple, rng.integers(-20, 20, size=(6, 3)).tolist()), 1) for _ in range(5)
    ]
    pieces = [piece for piece in pieces if piece is not None]
    corners = rng.uniform(-1, 1, size=(20, 3, 3)) * rng.uniform(0.1, 1.2, size=(20, 1, 1))
    found = uncovered(corners.reshape(-1, 3), np.arange(60).reshape(-1, 3), pieces)
    left = {each.triangle: each.polygons for each in found}
    rows = [rows_of(piece) for piece in pieces]
    steps = 9
    for number, triangle in enumerate(corners):
        a, b, c = map(exact, triangle)
        samples = [
            tuple(
                (i * p + j * q + (steps - i - j) * r) / steps
                for p, q, r in zip(a, b, c, strict=True)
            )
            for i in range(steps + 1)
            for j in range(steps + 1 - i)
        ]
        if number not in left:
            assert all(in_some(point, rows) for point in samples)
            continue
        for polygon in left[number]:  # its middle is in no piece
            middle = tuple(sum(xs) / len(polygon) for xs in zip(*polygon, strict=True))
            assert not in_some(middle, rows)


@pytest.mark.parametrize("seed", range(8))
def test_what_is_left_has_the_area_that_shapely_finds(seed):
    rng = np.random.default_rng([seed, 7])
    lowers = rng.integers(-10, 5, size=(6, 2))
    uppers = lowers + rng.integers(2, 9, size=(6, 2))
    pieces = [
        block((*low, -5), (*high, 5))
        for low, high in zip(lowers.tolist(), uppers.tolist(), strict=True)
    ]
    flat = rng.uniform(-1.2, 1.2, size=(3, 2))
    vertices = np.column_stack([flat, np.zeros(3)])
    rest = Polygon(flat).difference(
        unary_union(
            [box(*(low / 10), *(high / 10)) for low, high in zip(lowers, uppers, strict=True)]
        )
    )
    found = uncovered(vertices, ONE, pieces)
    parts = [
        Polygon([(float(x), float(y)) for x, y, _ in p]) for each in found for p in each.polygons
    ]
    assert sum(part.area for part in parts) == pytest.approx(rest.area, abs=1e-12)


HALF = np.array([[0.0, 0.25, 0.25], [1.0, 0.25, 0.25], [0.5, 0.75, 0.25]])


def test_two_pieces_that_touch_cover_what_lies_across():
    touching = [block((0, 0, 0), (5, 10, 10)), block((5, 0, 0), (10, 10, 10))]
    assert uncovered(HALF, ONE, touching) == ()
    apart = [touching[0], block((5000001, 0, 0), (10000000, 10000000, 10000000), 7)]
    (found,) = uncovered(HALF, ONE, apart)
    (polygon,) = found.polygons
    assert {x for x, _, _ in polygon} == {Fraction(1, 2), Fraction(5000001, 10**7)}


@pytest.mark.parametrize("axis", range(3))
def test_one_unit_in_the_last_place_counts(axis):
    piece = block((0, 0, 0), (10, 10, 10))
    inside = np.array([[0.5, 0.5, 0.5], [1.0, 0.5, 0.5], [0.5, 1.0, 1.0]])
    assert uncovered(inside, ONE, [piece]) == ()
    outside = inside.copy()
    outside[2 if axis else 1, axis] = np.nextafter(1.0, 2.0)
    assert [each.triangle for each in uncovered(outside, ONE, [piece])] == [0]


def test_a_decimal_that_no_double_is_does_not_hold_the_double_above_it():
    tenth = block((0, 0, 0), (1, 1, 1))  # the double 0.1 is more than 1/10
    vertices = np.array([[0.0, 0.0, 0.0], [0.1, 0.0, 0.0], [0.0, 0.05, 0.05]])
    assert [each.triangle for each in uncovered(vertices, ONE, [tenth])] == [0]
    assert uncovered(vertices, ONE, [block((0, 0, 0), (10001, 10001, 10001), 5)]) == ()


@pytest.mark.parametrize("numbers", [[0, 0, 0], [0, 1, 1], [0, 1, 0]])
def test_points_and_segments_are_triangles_too(numbers):
    vertices = np.array([[0.1, 0.1, 0.1], [1.5, 0.1, 0.1]])
    pieces = [block((0, 0, 0), (7, 10, 10)), block((6, 0, 0), (20, 10, 10))]
    assert uncovered(vertices, np.array([numbers]), pieces) == ()
    found = uncovered(vertices, np.array([numbers]), pieces[1:])
    assert [each.triangle for each in found] == [0]


def test_without_pieces_everything_is_left():
    (found,) = uncovered(HALF, ONE, [])
    assert {tuple(map(float, point)) for point in found.polygons[0]} == {tuple(p) for p in HALF}


def test_a_thin_gap_far_from_the_origin_is_found():
    far = np.array([[1000.0, 0, 0], [1001.0, 0, 0], [1000.5, 0.5, 0]])
    wide = 10**7
    pieces = [
        block((9999000000, -wide, -wide), (10005000000, wide, wide), 7),
        block((10005000001, -wide, -wide), (10020000000, wide, wide), 7),
    ]
    assert [each.triangle for each in uncovered(far, ONE, pieces)] == [0]
    pieces.append(block((10004999999, -wide, -wide), (10005000002, wide, wide), 7))
    assert uncovered(far, ONE, pieces) == ()


@pytest.mark.parametrize("seed", range(10))
def test_doubles_never_contradict_integers(seed, monkeypatch):
    """Corners on the planes of pieces that touch, and a last place beside them."""
    rng = np.random.default_rng([seed, 3])
    # A box in eight that touch, two of which are left out, and pieces at random.
    cells = list(product((-4, 0), repeat=3))
    pieces = [block(low, [x + 4 for x in low]) for low in cells[: 8 - seed % 3]]
    found = (convex_piece(map(tuple, rng.integers(-5, 5, size=(5, 3)).tolist()), 1) for _ in "abc")
    pieces += [piece for piece in found if piece is not None]
    vertices = rng.integers(-4, 5, size=(120, 3)) / 10
    vertices += rng.integers(-1, 2, size=(120, 3)) / rng.choice([20.0, 32.0, 40.0])
    moved = rng.random(vertices.shape) < 0.2
    vertices[moved] = np.nextafter(vertices[moved], rng.choice([-9.0, 9.0]))
    triangles = rng.integers(0, 120, size=(60, 3))
    quick = [each.triangle for each in uncovered(vertices, triangles, pieces)]
    assert 0 < len(quick) < 60
    monkeypatch.setattr(containment, "in_two", lambda sides, _: np.zeros(len(sides), dtype=bool))
    nothing = staticmethod(lambda *given: np.zeros(len(given[-1]), dtype=bool))
    monkeypatch.setattr(containment.Heights, "hold", nothing)
    whole = [each.triangle for each in uncovered(vertices, triangles, pieces)]
    assert quick == whole
