"""Separation over a slice of time, against distances worked out by hand."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from flint import arb
from scipy.optimize import minimize_scalar
from scipy.spatial.transform import Rotation

from compiler.expressions.evaluators.balls import ball, working_precision
from solvers.verifier.proofs.apart import Apart
from solvers.verifier.proofs.point_map import Slice
from solvers.verifier.proofs.tube_checks import Inside, Row, row


def rows_of_box(low: list[int], high: list[int]) -> tuple[Row, ...]:
    found = []
    for axis in range(len(low)):
        for sign, bound in ((-1, -low[axis]), (1, high[axis])):
            normal = [Fraction(0)] * len(low)
            normal[axis] = Fraction(sign)
            found.append(row(normal, Fraction(bound)))
    return tuple(found)


def corners(low: list[int], high: list[int]) -> tuple[tuple[arb, ...], ...]:
    pairs = list(zip(low, high, strict=True))
    return tuple(tuple(arb(x) for x in point) for point in product(*pairs))


def still(*points: tuple[str, ...]) -> Slice:
    """Points at rest over one second."""
    exact = (tuple((ball(Fraction(x)), arb(0), arb(0)) for x in point) for point in points)
    return Slice(arb(0), arb("0.5"), tuple(exact))


def apart(points: int, dimension: int, distance: str = "0") -> Apart:
    low, high = [0] * dimension, [1] * dimension
    return Apart(
        "obstacle",
        points=tuple(range(points)),
        rows=rows_of_box(low, high),
        vertices=corners(low, high),
        distance=ball(Fraction(distance)),
    )


def margin(constraint: Apart | Inside, over: Slice) -> float:
    with working_precision(80):
        return float(constraint.bound(over)[0])


def test_the_distance_to_a_corner_counts() -> None:
    """(1.3, 1.4) is 0.5 from the corner (1, 1), but only 0.4 beyond a facet."""
    assert margin(apart(1, 2, "0.45"), still(("1.3", "1.4"))) == pytest.approx(0.05)
    assert margin(apart(1, 2, "0.55"), still(("1.3", "1.4"))) == pytest.approx(-0.05)


def test_a_segment_past_a_corner() -> None:
    """From (2, 0.5) to (0.5, 2): x + y = 2.5, at 0.5 / sqrt(2) from (1, 1); no facet separates."""
    assert margin(apart(2, 2), still(("2", "0.5"), ("0.5", "2"))) == pytest.approx(0.5 / 2**0.5)


def test_a_segment_past_an_edge_in_space() -> None:
    """The same line, rising from z = 0.2 to 0.8: only edge times segment separates the sets."""
    over = still(("2", "0.5", "0.2"), ("0.5", "2", "0.8"))
    assert margin(apart(2, 3), over) > 0.3


def test_a_segment_through_an_obstacle_is_never_apart() -> None:
    assert margin(apart(2, 2), still(("-1", "0.5"), ("2", "0.6"))) < 0
    assert margin(apart(2, 3), still(("-1", "0.5", "0.5"), ("2", "0.6", "0.4"))) < 0


def test_a_point_inside_is_a_violation_and_one_outside_is_none() -> None:
    with working_precision(80):
        assert apart(1, 2).violated(still(("0.5", "0.5")))
        assert not apart(1, 2).violated(still(("1.5", "0.5")))
        inside = Inside("bounds", points=(0,), rows=rows_of_box([0, 0], [1, 1]))
        assert inside.violated(still(("1.5", "0.5")))
        assert not inside.violated(still(("0.5", "0.5")))


def test_a_moving_point_is_enclosed_to_second_order() -> None:
    """p = 1.2 + s + s^2 on |s| <= 1/2 has its least value 0.95 at s = -1/2: it enters the box."""
    moving = ((ball(Fraction("1.2")), arb(1), arb(1)), (ball(Fraction("0.5")), arb(0), arb(0)))
    over = Slice(arb(0), arb("0.5"), (moving,))
    assert margin(apart(1, 2), over) <= -0.05
    slower = ((ball(Fraction("1.8")), arb(1), arb(1)), (ball(Fraction("0.5")), arb(0), arb(0)))
    assert 0 < margin(apart(1, 2), Slice(arb(0), arb("0.5"), (slower,))) <= 0.55


@pytest.mark.parametrize(
    ("point", "distance"),
    [(("1.3", "1.4"), "0.51"), (("1.3", "0.5"), "0.31"), (("0.2", "-0.1"), "0.11")],
)
def test_too_near_is_a_violation(point: tuple[str, str], distance: str) -> None:
    """Distances 0.5 (a corner), 0.3 and 0.1 (a facet): asked for more, they are refused."""
    with working_precision(80):
        assert apart(1, 2, distance).violated(still(point))
        assert not apart(1, 2, str(Fraction(distance) - Fraction("0.02"))).violated(still(point))


def test_the_margin_is_the_distance_without_one_asked_for_too() -> None:
    assert margin(apart(1, 2), still(("1.3", "1.4"))) == pytest.approx(0.5)


def test_a_thick_body_keeps_its_radius_from_the_bounds() -> None:
    """A point 0.3 from a tilted facet: a disc of radius 0.25 fits, one of 0.35 does not."""
    slope = row([Fraction(3), Fraction(4)], Fraction(5))
    for radius, room in [("0.25", 0.05), ("0.35", -0.05)]:
        disc = Inside("bounds", points=(0,), rows=(slope,), distance=ball(Fraction(radius)))
        over = still(("0.3", "0.65"))
        assert margin(disc, over) == pytest.approx(room)
        with working_precision(80):
            assert disc.violated(over) == (room < 0)


@pytest.mark.parametrize("seed", range(12))
def test_a_rod_and_a_tilted_box_are_as_far_apart_as_they_are(seed: int) -> None:
    """Never farther than a line search says, and no less in the balls' accuracy."""
    rng = np.random.default_rng(seed)
    turn = Rotation.random(random_state=seed).as_matrix()
    ends = rng.uniform(1, 3, (2, 3)) * rng.choice([-1, 1], 3)
    box = np.array(list(product((-0.5, 0.5), (-0.3, 0.3), (-0.9, 0.9))))
    faces = [row([Fraction(float(x)) for x in a], Fraction(float(b))) for a, b in _faces(box, turn)]
    bodies = Apart(
        "tilted", points=(0, 1), rows=tuple(faces),
        vertices=tuple(tuple(arb(float(x)) for x in corner) for corner in box @ turn.T),
    )  # fmt: skip
    over = still(*(tuple(str(Fraction(float(x))) for x in turn @ end) for end in ends))

    def gap(share: float) -> float:
        point = ends[0] + share * (ends[1] - ends[0])
        return float(np.linalg.norm(point - np.clip(point, box.min(axis=0), box.max(axis=0))))

    true = min(
        gap(0.0), gap(1.0), minimize_scalar(gap, bounds=(0, 1), options={"xatol": 1e-12}).fun
    )
    assert margin(bodies, over) == pytest.approx(true, abs=1e-6)
    assert margin(bodies, over) <= true + 1e-9
    with working_precision(80):
        assert not bodies.violated(over)
        bodies.distance = arb(true + 1e-4)
        assert bodies.violated(over)
        assert margin(bodies, over) < 0


def _faces(box: np.ndarray, turn: np.ndarray) -> list[tuple[np.ndarray, float]]:
    """Outward normals and offsets of the turned box."""
    high = box.max(axis=0)
    return [(sign * turn[:, axis], high[axis]) for axis in range(3) for sign in (-1.0, 1.0)]


def test_a_rod_through_an_obstacle_is_a_violation_though_its_ends_are_outside() -> None:
    with working_precision(80):
        assert apart(2, 2).violated(still(("-1", "0.5"), ("2", "0.6")))
        assert apart(2, 3).violated(still(("-1", "0.5", "0.5"), ("2", "0.6", "0.4")))
        assert not apart(2, 3).violated(still(("-1", "1.1", "0.5"), ("2", "1.2", "0.4")))
        unbounded = Apart("wall", points=(0, 1), rows=rows_of_box([0, 0], [1, 1])[:2])
        assert unbounded.violated(still(("-1", "0.5"), ("2", "0.6")))


def test_the_last_direction_is_enough_where_the_margin_stays() -> None:
    """Where nothing new is to be learned, no better direction is looked for."""
    item = apart(1, 2)
    over = still(("1.3", "1.4"))
    with working_precision(80):
        first = item.bound(over)[0]
        item.margin = 0.4
        again = item.bound(still(("1.31", "1.41")))[0]
    assert 0.5 <= float(again) <= (0.31**2 + 0.41**2) ** 0.5
    assert float(first) == pytest.approx(0.5)


def test_the_place_of_a_rod_is_its_nearest_point() -> None:
    item = apart(2, 2)
    assert item.where(still(("0", "2"), ("4", "2.5"))) == pytest.approx((0, 2))
    share = (2 * 4 + 2 * 1.6) / (4**2 + 1.6**2)
    foot = (-1 + share * 4, 3 - share * 1.6)
    assert item.where(still(("-1", "3"), ("3", "1.4"))) == pytest.approx(foot)


def test_where_rates_are_hardly_known_the_range_of_positions_is_closer() -> None:
    """At 0 +- 1/2 at the middle, rates up to 100, within 1 all along."""
    middle, fast = arb(0, 0.5), arb(0, 100)
    over = Slice(arb(0), arb(1), (((middle, fast, arb(0)),),))
    assert float(over.form([arb(2)], 0)[0].rad()) == pytest.approx(201)
    known = replace(over, ranges=((arb(0, 1),),))
    value, centre = known.form([arb(2)], 0)
    assert 2 <= float(value.rad()) < 2.001
    assert 1 <= float(centre.rad()) < 1.001
