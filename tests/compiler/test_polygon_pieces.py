"""Polygons as convex pieces, against shapely and against sums of areas."""

from __future__ import annotations

import math
import random
import time
from collections.abc import Sequence
from fractions import Fraction

import pytest
import shapely

from compiler.workspaces.hull import turn
from compiler.workspaces.pieces import Corner, Polygon, apart, area
from compiler.workspaces.polygon_pieces import polygon_pieces
from compiler.workspaces.rings import BadRing

Ring = list[Corner]


def ring(*points: tuple[object, object]) -> Ring:
    return [(Fraction(str(x)), Fraction(str(y))) for x, y in points]


def closed(rings: Sequence[Ring]) -> list[Ring]:
    return [[*corners, corners[0]] for corners in rings]


def shapely_of(rings: Sequence[Ring]) -> shapely.Polygon:
    outline, *holes = [[(float(x), float(y)) for x, y in corners] for corners in rings]
    return shapely.Polygon(outline, holes)


def reflex(rings: Sequence[Ring]) -> int:
    """The number of corners where the polygon is not convex, holes by their other side."""
    count = 0
    for number, repeated in enumerate(rings):
        corners = [b for a, b in zip(repeated[-1:] + repeated, repeated, strict=False) if a != b]
        ahead = 1 if (area(corners) > 0) == (number == 0) else -1
        for i in range(len(corners)):
            a, b, c = corners[i - 2], corners[i - 1], corners[i]
            count += turn(a, b, c) * ahead < 0
    return count


def checked(rings: Sequence[Ring]) -> tuple[Polygon, ...]:
    """The pieces, all that is claimed of them looked at."""
    pieces = polygon_pieces(closed(rings))
    sizes = [abs(area(corners)) for corners in rings]
    assert sum(map(area, pieces)) == sizes[0] - sum(sizes[1:])
    for piece in pieces:
        assert len(piece) >= 3
        assert all(turn(piece[i - 2], piece[i - 1], piece[i]) > 0 for i in range(len(piece)))
    if len(pieces) < 16:
        for i, piece in enumerate(pieces):
            assert all(apart(piece, other) for other in pieces[:i])
    whole = shapely_of(rings)
    made = [shapely_of([list(piece)]) for piece in pieces]
    assert shapely.unary_union(made).symmetric_difference(whole).area < 1e-9 * whole.area
    assert all(piece.difference(whole.buffer(1e-9)).area == 0 for piece in made)
    assert len(pieces) <= 2 * reflex(rings) + 1
    return pieces


def turned(rings: Sequence[Ring]) -> list[Ring]:
    """Turned by the angle of the triangle 20, 21, 29, so that no side is upright."""
    c, s = Fraction(20, 29), Fraction(21, 29)
    return [[(c * x - s * y, s * x + c * y) for x, y in corners] for corners in rings]


SQUARE = ring((0, 0), (4, 0), (4, 4), (0, 4))
U = ring((0, 0), (3, 0), (3, 3), (2, 3), (2, 1), (1, 1), (1, 3), (0, 3))
SPIRAL = ring(
    (0, 0), (7, 0), (7, 7), (1, 7), (1, 2), (5, 2), (5, 5), (3, 5), (3, 4), (4, 4), (4, 3), (2, 3),
    (2, 6), (6, 6), (6, 1), (0, 1),
)  # fmt: skip


@pytest.mark.parametrize(
    ("rings", "most"),
    [
        ([SQUARE], 1),
        ([SQUARE[::-1]], 1),
        ([ring((0, 0), (1, 0), (2, 0), (4, 0), (4, 4), (2, 4), (0, 4), (0, 1))], 1),
        ([ring((0, 0), (2, 0), (1, 1))], 1),
        ([ring((0, 0), (0, 0), (2, 0), (2, 0), (2, 2), (0, 0))], 1),
        ([ring((0, 0), (2, 0), (2, 1), (1, 1), (1, 2), (0, 2))], 2),
        ([U], 3),
        ([SPIRAL], 10),
        ([SQUARE, ring((1, 1), (3, 1), (3, 3), (1, 3))], 4),
        ([SQUARE, ring((1, 1), (1, 3), (3, 3), (3, 1))], 4),
        ([SQUARE, ring((0, 0), (2, 1), (1, 2))], 5),  # a corner of both
        ([SQUARE, ring((0, 2), (1, 1), (1, 3))], 5),  # a corner on a side
        ([SQUARE, ring((0, 2), (2, 1), (4, 2), (2, 3))], 4),  # from side to side
        ([SQUARE, ring((1, 1), (2, 1), (2, 2), (1, 2)), ring((2, 2), (3, 2), (3, 3), (2, 3))], 6),
        ([SQUARE, ring((1, 1), (2, 1), (2, 2), (1, 2)), ring((2, 1), (3, "0.5"), (3, "1.5"))], 8),
    ],
)
def test_shapes(rings: list[Ring], most: int) -> None:
    assert len(checked(rings)) <= most
    checked(turned(rings))
    checked([[(-x, y) for x, y in corners] for corners in rings])


def star(rng: random.Random, number: int, low: float = 0.3, high: float = 3) -> Ring:
    """A polygon that is seen as a whole from the origin: no gap of half a turn."""
    while True:
        angles = sorted(rng.sample(range(720), number))
        gaps = [(b - a) % 720 for a, b in zip(angles, angles[1:] + angles[:1], strict=True)]
        if max(gaps) < 360:
            break
    corners: Ring = []
    for angle in angles:
        size = rng.uniform(low, high)
        x, y = size * math.cos(angle * math.pi / 360), size * math.sin(angle * math.pi / 360)
        corners.append((Fraction(round(x, 4)).limit_denominator(10**4),
                        Fraction(round(y, 4)).limit_denominator(10**4)))  # fmt: skip
    return corners


def test_random_stars() -> None:
    rng = random.Random(3)
    for _ in range(80):
        checked([star(rng, rng.randint(4, 30))])


def test_random_stars_with_star_shaped_holes() -> None:
    rng = random.Random(4)
    for _ in range(30):
        outer = star(rng, rng.randint(5, 20), 2, 4)
        inner = star(rng, rng.randint(4, 12), 0.05, 0.15)
        holes = [inner, [(x + Fraction(1, 2), y) for x, y in inner],
                 [(x / 3 - Fraction(1, 4), y / 3) for x, y in inner]]  # fmt: skip
        if shapely_of([outer, *holes]).is_valid:
            checked([outer, *holes])


def test_random_spirals() -> None:
    """A winding strip: most of its inner corners are reflex."""
    rng = random.Random(5)
    for _ in range(10):
        count = rng.randint(20, 60)
        middle = [0.3 + 0.15 * i + rng.uniform(0, 0.05) for i in range(count)]

        def place(i: int, size: float) -> Corner:
            x, y = size * math.cos(0.4 * i), size * math.sin(0.4 * i)
            return Fraction(round(x, 6)), Fraction(round(y, 6))

        strip = [place(i, size) for i, size in enumerate(middle)]
        strip += [place(i, size + 0.4) for i, size in enumerate(middle)][::-1]
        checked([strip])


def test_a_comb_of_many_teeth_is_quick() -> None:
    teeth = [(x, y) for i in range(600) for x, y in ((3 * i, 1), (3 * i + 1, 9), (3 * i + 2, 1))]
    comb = ring((-1, 0), (1800, 0), *teeth[::-1], (-1, 1))
    started = time.perf_counter()
    pieces = polygon_pieces(closed([comb]))
    assert time.perf_counter() - started < 4
    assert sum(map(area, pieces)) == abs(area(comb))
    assert len(pieces) <= 601


@pytest.mark.parametrize(
    ("rings", "message", "number"),
    [
        ([ring((0, 0), (2, 2), (2, 0), (0, 2))], "meets itself at (1, 1)", 0),
        ([ring((0, 0), (2, 0), (2, 2), (1, 0), (0, 2))], "meets itself at (1, 0)", 0),
        ([ring((0, 0), (2, 0), (1, 1), (2, 2), (0, 2), (1, 1))], "meets itself at (1, 1)", 0),
        ([ring((0, 0), (2, 0), (2, 2), (2, 3), (2, 2), (0, 2))], "meets itself at (2, 2)", 0),
        ([ring((0, 0), (3, 0), (1, 0), (1, 1))], "meets itself at", 0),
        ([ring((0, 0), (1, 1), (2, 2), (3, 3))], "has no area", 0),
        ([ring((0, 0), (0, 0), (0, 0), (0, 0))], "has no area", 0),
        ([SQUARE, ring((1, 1), (5, 1), (5, 2), (1, 2))], "crosses another one at (4, 2)", 1),
        ([SQUARE, ring((0, 1), (2, 1), (2, 2), (0, 2))], "crosses another one", 1),
        ([SQUARE, ring((1, 1), (1, 1), (1, 1))], "has no area", 1),
        ([SQUARE, ring((5, 5), (6, 5), (6, 6))], "not within the outline", 0),
        ([SQUARE, ring((1, 1), (3, 1), (2, 3)), ring((2, "1.5"), ("2.1", "1.5"), (2, 2))],
         "within another hole", 0),
        ([U, ring((1, "1.5"), ("1.5", 2), (1, "2.5"), ("0.5", 2))], "not within", 0),
        ([U, ring((1, 3), (2, 3), ("1.5", 4))], "not within", 0),
    ],
)  # fmt: skip
def test_rings_that_are_none(rings: list[Ring], message: str, number: int) -> None:
    with pytest.raises(BadRing) as caught:
        polygon_pieces(closed(rings))
    assert message in caught.value.message
    assert caught.value.ring == number


def test_open_and_short_rings() -> None:
    with pytest.raises(BadRing, match="not closed"):
        polygon_pieces([SQUARE])
    with pytest.raises(BadRing, match="at least four"):
        polygon_pieces([[*SQUARE[:2], SQUARE[0]]])


def test_random_rings_are_refused_where_shapely_says_so() -> None:
    rng = random.Random(8)
    good = 0
    for _ in range(300):
        corners = ring(*((rng.randint(0, 6), rng.randint(0, 6)) for _ in range(rng.randint(3, 6))))
        valid = shapely_of([corners]).is_valid and area(corners) != 0
        good += valid
        if valid:
            checked([corners])
        else:
            with pytest.raises(BadRing):
                polygon_pieces(closed([corners]))
    assert 50 < good < 250


def test_apart() -> None:
    """Of polygons that touch, overlap, or lie within each other, as the areas say."""
    rng = random.Random(9)
    seen = set()
    for _ in range(500):
        pair = []
        while len(pair) < 2:
            corners = ring(*((rng.randint(0, 5), rng.randint(0, 5)) for _ in range(3)))
            if area(corners) > 0:
                pair.append(tuple(corners))
        one, other = (shapely_of([list(p)]) for p in pair)
        seen.add(apart(*pair))
        assert apart(*pair) == (one.intersection(other).area < 1e-9)
    assert seen == {True, False}
