"""Where a point of a box can be among closed regions, against areas by shapely."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
import shapely

from compiler.expressions.evaluators.balls import ball, working_precision
from compiler.workspaces.polytope import Polytope, polytope_of
from grammar_lang import ir
from solvers.verifier.proofs.formula_proof import box_around, may_be
from solvers.verifier.proofs.point_map import Slice

F = Fraction


def hull(*points: tuple[float, float]) -> Polytope:
    return polytope_of(ir.Hull(tuple((F(x), F(y)) for x, y in points)), 2)


BOX = hull((0, 0), (2, 0), (2, 1), (0, 1))
LEFT = hull((-1, -3), (1.5, -3), (0.5, 4), (-1, 4))
RIGHT = hull((1.5, -3), (5, -3), (5, 4), (0.5, 4))
"""Both sides of one tilted line through the box."""
LATER = hull((1.6, -3), (5, -3), (5, 4), (0.6, 4))


@pytest.mark.parametrize(
    ("within", "without", "expected"),
    [
        ((LEFT,), (), True),
        ((LEFT,), (RIGHT,), True),
        ((), (LEFT, RIGHT), False),
        ((), (LEFT, LATER), True),
        ((LEFT, RIGHT), (), True),
        ((LEFT, LATER), (), False),
        ((LEFT, RIGHT), (LEFT,), False),
        ((LEFT, RIGHT), (LATER,), True),
        ((BOX,), (LEFT, RIGHT), False),
        ((hull((3, 3), (4, 3), (3, 4)),), (), False),
        ((), (BOX,), False),
        ((), (), True),
    ],
)
def test_by_hand(within: list[Polytope], without: list[Polytope], expected: bool) -> None:
    """LEFT and RIGHT share an edge, on which a point is in both; LATER leaves a gap."""
    assert may_be(BOX, within, without) is expected


def test_unbounded_and_flat_regions() -> None:
    half = Polytope((ir.HalfSpace((F(1), F(2)), F(2)),))
    other = Polytope((ir.HalfSpace((F(-1), F(-2)), F(-2)),))
    assert not may_be(BOX, [], [half, other])
    assert may_be(BOX, [half, other], [])
    flat = half.intersection(other)
    assert may_be(BOX, [], [flat])
    assert not may_be(BOX, [flat], [half])


def test_random_triangles() -> None:
    """Where something of positive area is possible, or the closed sets are far apart."""
    rng = np.random.default_rng(3)
    box = shapely.Polygon([(float(x), float(y)) for x, y in BOX.vertices])
    seen = set()
    for _ in range(60):
        corners = [rng.integers(-8, 12, (3, 2)) / 4 for _ in range(4)]
        shapes = [shapely.Polygon(c) for c in corners]
        if min(shape.area for shape in shapes) < 0.1:
            continue
        exact = [hull(*map(tuple, c.tolist())) for c in corners]
        place = box.intersection(shapes[0]).intersection(shapes[1])
        rest = place.difference(shapes[2]).difference(shapes[3])
        found = may_be(BOX, exact[:2], exact[2:])
        if rest.area > 1e-9:
            assert found
        elif place.is_empty:
            assert not found
        seen.add((found, rest.area > 1e-9))
    assert {(True, True), (False, False)} <= seen


def test_the_box_of_a_moving_point() -> None:
    """p = (1 + s, 2 - s + s^2) for |s| <= 1/2: [0.5, 1.5] x [1.5, 2.75], rounded outwards."""
    with working_precision(96):
        x = (ball(F(1)), ball(F(1)), ball(F(0)))
        y = (ball(F(2)), ball(F(-1)), ball(F(1)))
        box = box_around(Slice(ball(F(0)), ball(F(1, 2)), ((x, y),)), 0)
    assert box is not None
    low, high = box.box
    np.testing.assert_allclose(low, (0.5, 1.5), rtol=1e-6)
    np.testing.assert_allclose(high, (1.5, 2.75), rtol=1e-6)
    for s in (F(-1, 2), F(0), F(1, 2)):
        assert box.contains_point((1 + s, 2 - s + s * s))


def test_a_point_that_stays_on_a_line_is_in_a_box_with_interior() -> None:
    with working_precision(128):
        x = (ball(F(1)), ball(F(1)), ball(F(0)))
        y = (ball(F(0)), ball(F(0)), ball(F(0)))
        box = box_around(Slice(ball(F(0)), ball(F(1, 2)), ((x, y),)), 0)
    assert box is not None
    assert box.has_interior
    assert box.contains_point((F(1, 2), F(0)))
    left, right = hull((0, -1), (1, -1), (1, 1), (0, 1)), hull((1, -1), (2, -1), (2, 1), (1, 1))
    assert not may_be(box, [], [left, right])
    assert may_be(box, [], [left])
