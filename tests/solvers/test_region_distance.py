"""Depths and distances of points, at rest and moving, against scipy and by hand."""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from math import inf, sqrt

import numpy as np
import pytest
from flint import arb
from scipy.optimize import nnls

from compiler.expressions.evaluators.balls import ball, working_precision
from compiler.workspaces.polytope import Polytope, polytope_of
from grammar_lang import ir
from solvers.verifier.proofs.point_map import Slice
from solvers.verifier.proofs.region_distance import Gap, region_distance

F = Fraction


def hull(*points: tuple[int | str, ...]) -> Polytope:
    return polytope_of(ir.Hull(tuple(tuple(F(x) for x in p) for p in points)), len(points[0]))


def rows(*items: tuple[tuple[int, ...], int]) -> Polytope:
    spaces = tuple(ir.HalfSpace(tuple(F(a) for a in n), F(b)) for n, b in items)
    return Polytope(spaces)


def moving(*axes: tuple[str, str, str], half: str = "0") -> Slice:
    """A point p(0) + p' s + p''/2 s^2 for |s| <= half."""
    point = tuple((ball(F(a)), ball(F(b)), ball(F(c))) for a, b, c in axes)
    return Slice(arb(0), ball(F(half)), (point,))


def still(*place: str) -> Slice:
    return moving(*((x, "0", "0") for x in place))


def gap(shape: Polytope, time: Slice) -> Gap:
    with working_precision(96):
        return region_distance(shape).over(time, 0)


SQUARE = hull((0, 0), (4, 3), (1, 7), (-3, 4))
"""Edges of length 5 with slopes 3/4 and -4/3."""


@pytest.mark.parametrize(
    ("place", "depth"),
    [
        (("0.5", "3.5"), 2.5),
        (("0", "1.25"), 0.75),
        (("2.6", "-0.2"), -sqrt(2.6**2 + 0.2**2 - (2.6 * 0.8 - 0.2 * 0.6) ** 2)),
        (("0", "-2"), -2.0),
        (("5", "3"), -1.0),
        (("4.6", "2.2"), -1.0),
    ],
)
def test_a_point_at_rest_beside_a_tilted_square(place: tuple[str, str], depth: float) -> None:
    """To facets and corners; the two bounds of a point at rest are one number."""
    found = gap(SQUARE, still(*place))
    assert found.inside == pytest.approx(max(depth, 0))
    assert found.outside == pytest.approx(max(-depth, 0))
    assert max(found.most_inside, found.most_outside) == pytest.approx(abs(depth))
    assert found.inside <= max(depth, 0)


def test_on_the_boundary_nothing_is_certain() -> None:
    found = gap(SQUARE, still("2", "1.5"))
    assert (found.inside, found.outside) == (0, 0)


def test_random_points_in_space() -> None:
    """Nearest points of a tilted tetrahedron by scipy's non-negative least squares."""
    corners = [(0, 0, 0), (3, 1, 0), (1, 3, 1), (0, 1, 3)]
    shape = hull(*corners)
    rng = np.random.default_rng(1)
    seen = 0
    beside, within = rng.integers(-400, 600, (60, 3)) / 100, [[1, 1.25, 1], [1, 1.5, 0.8]]
    for place in [*beside, *within]:
        matrix = np.vstack([np.array(corners, dtype=float).T, 1e6 * np.ones(4)])
        _, distance = nnls(matrix, np.append(place, 1e6))
        found = gap(shape, still(*(str(x) for x in place)))
        assert found.outside == pytest.approx(distance if distance > 1e-5 else 0, rel=1e-5)
        assert (found.inside > 0) == (distance < 1e-5)
        seen += found.inside > 0
    assert seen >= 2


def test_a_moving_point_is_nowhere_nearer_and_hardly_farther() -> None:
    """p = (7 + s, s + s^2) beside the corner (4, 3) of the square, against its samples."""
    over = moving(("7", "1", "0"), ("0.5", "1", "1"), half="0.125")
    found = gap(SQUARE, over)
    s = np.linspace(-0.125, 0.125, 1001)
    true = np.hypot(7 + s - 4, 0.5 + s + s**2 - 3)
    assert true.min() - 0.05 < found.outside <= true.min()
    assert true.max() - 0.05 < found.most_outside < true.max() + 0.05
    assert found.inside == found.most_inside == 0


def test_a_point_that_crosses_the_boundary() -> None:
    """Along x through the side x = 0 of a half-plane: up to 0.2 on either side."""
    found = gap(rows(((-1, 0), 0)), moving(("0", "2", "0"), ("5", "1", "0"), half="0.1"))
    assert (found.inside, found.outside) == (0, 0)
    assert found.most_inside == pytest.approx(0.2)
    assert found.most_outside == pytest.approx(0.2)


def test_unbounded_regions() -> None:
    """Of a quadrant the facets alone tell: beyond its corner less than the distance is known."""
    quadrant = rows(((-1, 0), 0), ((0, -1), 0))
    assert gap(quadrant, still("2", "3")).inside == pytest.approx(2)
    assert gap(quadrant, still("-3", "4")).outside == pytest.approx(3)
    assert gap(quadrant, still("-3", "-4")).outside == pytest.approx(4)
    everything = gap(rows(((0, 0), 0)), still("1", "1"))
    assert (everything.inside, everything.outside) == (inf, 0)


def test_a_flat_region_is_never_certain_but_left() -> None:
    segment = rows(((1, 0), 2), ((-1, 0), -2), ((0, 1), 1), ((0, -1), 1))
    assert gap(segment, still("2", "0.5")).inside == 0
    assert gap(segment, still("5", "5")).outside == pytest.approx(5)
    assert gap(segment, still("2.001", "0")).outside == pytest.approx(0.001)


def test_nothing_is_in_an_empty_region() -> None:
    nothing = rows(((1, 0), 0), ((-1, 0), -1), ((0, 1), 1), ((0, -1), 1))
    found = gap(nothing, still("0.5", "0"))
    assert (found.inside, found.outside) == (0, inf)


def test_a_cube_by_its_faces_edges_and_corners() -> None:
    cube = hull(*product((-1, 1), repeat=3))
    for place, distance in [
        (("3", "0.2", "0.1"), 2), (("4", "5", "0.5"), 5), (("2", "3", "3"), 3),
    ]:  # fmt: skip
        assert gap(cube, still(*place)).outside == pytest.approx(distance)
