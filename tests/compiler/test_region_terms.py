"""Points and segments against polygons: the formulas, evaluated, against exact clipping."""

from __future__ import annotations

from collections.abc import Sequence
from fractions import Fraction

import numpy as np
import pytest

from compiler.encodings.region_terms import (
    FAR,
    Formula,
    PolygonTerms,
    beyond,
    constant,
    inside,
    point_clear,
    polygon_terms,
    segment_clear,
)
from compiler.workspaces.polytope import Polytope
from tests.oracles.planar_bodies import random_polygon
from tests.oracles.planes import row

Point = Sequence[Fraction]


def value(formula: Formula) -> bool:
    """The value of a formula without unknowns."""
    words = formula.replace("(", " ( ").replace(")", " ) ").split()

    def read() -> bool:
        word = words.pop(0)
        if word != "(":
            assert word in ("true", "false"), formula
            return word == "true"
        operator, parts = words.pop(0), []
        while words[0] != ")":
            parts.append(read())
        words.pop(0)
        return all(parts) if operator == "and" else any(parts)

    found = read()
    assert not words
    return found


def clear(polygon: PolygonTerms, a: Point, b: Point) -> bool:
    ends = [[constant(x) for x in end] for end in (a, b)]
    u = (b[0] - a[0], b[1] - a[1])
    moment = u[0] * a[1] - u[1] * a[0]
    return value(segment_clear(polygon, ends, [constant(x) for x in (*u, moment)]))


def crosses(polygon: Polytope, a: Point, b: Point) -> bool:
    """Whether a segment of positive length meets the interior (Cyrus & Beck, exact)."""
    low, high = Fraction(0), Fraction(1)
    for half in polygon.rows:
        at_a, at_b = (sum(n * x for n, x in zip(half.normal, p, strict=True)) - half.offset
                      for p in (a, b))  # fmt: skip
        slope = at_b - at_a
        if slope == 0:
            if at_a >= 0:
                return False
        elif slope > 0:
            high = min(high, -at_a / slope)
        else:
            low = max(low, -at_a / slope)
    return low < high


def terms(polygon: Polytope) -> PolygonTerms:
    found = polygon_terms(polygon)
    assert found is not None
    return found


@pytest.mark.parametrize("seed", range(40))
def test_a_segment_is_clear_if_and_only_if_it_misses_the_interior(seed: int) -> None:
    rng = np.random.default_rng(seed)
    polygon = random_polygon(rng, (0, 0), 1)
    found, answers = terms(polygon), []
    for _ in range(40):
        a, b = ([Fraction(int(n), 20) for n in rng.integers(-30, 31, 2)] for _ in range(2))
        if a == b:
            continue
        expected = not crosses(polygon, a, b)
        assert clear(found, a, b) == expected, (a, b)
        assert clear(found, b, a) == expected, (b, a)
        answers.append(expected)
    assert {True, False} == set(answers)


@pytest.mark.parametrize("seed", range(10))
def test_touching_is_clear(seed: int) -> None:
    """Along an edge, from a corner outwards, and from corner to corner, which is not."""
    rng = np.random.default_rng(100 + seed)
    polygon = random_polygon(rng, (0, 0), 1)
    found, corners = terms(polygon), polygon.vertices
    centre = polygon.centre
    for number, corner in enumerate(corners):
        after = corners[(number + 1) % len(corners)]
        assert clear(found, corner, after)
        outwards = [2 * x - c for x, c in zip(corner, centre, strict=True)]
        assert clear(found, corner, outwards)
        assert not clear(found, centre, outwards)
        across = corners[(number + 2) % len(corners)]
        assert clear(found, corner, across) == (len(corners) == 3)


def test_points() -> None:
    triangle = Polytope((row(-1, 0, 0), row(0, -1, 0), row(2, 3, 6)))
    found = terms(triangle)
    for x, y, free in ((1, 1, False), (0, 1, True), (3, 0, True), ("3/2", 1, True), (2, 2, True)):
        place = [constant(Fraction(x)), constant(Fraction(y))]
        assert value(point_clear(found, place)) == free
        assert value(beyond(triangle.rows[2], place)) == (2 * Fraction(x) + 3 * y >= 6)
        assert value(inside(triangle.rows[2], place)) == (2 * Fraction(x) + 3 * y <= 6)


def test_redundant_rows_are_no_edges() -> None:
    square = (row(1, 0, 1), row(-1, 0, 1), row(0, 1, 1), row(0, -1, 1))
    assert terms(Polytope((*square, row(1, 1, 9), row(0, 0, 3)))).rows == square


def test_a_polygon_without_end_is_cut_far_away() -> None:
    wall = terms(Polytope((row(1, 2, 0),)))
    assert not clear(wall, (Fraction(-5), Fraction(1)), (Fraction(7), Fraction(-8)))
    assert clear(wall, (Fraction(-5), Fraction(9)), (Fraction(7), Fraction(8)))
    assert clear(wall, (Fraction(-2), Fraction(1)), (Fraction(2), Fraction(-1)))
    assert clear(wall, (-2 * FAR, Fraction(0)), (-2 * FAR, Fraction(1)))


def test_nothing_is_avoided_in_an_empty_polygon() -> None:
    assert polygon_terms(Polytope((row(1, 0, 0), row(-1, 0, -1)))) is None
