"""Margins along a whole motion against the distances of many of its instants."""

from __future__ import annotations

from dataclasses import dataclass
from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from flint import arb
from scipy.spatial.transform import Rotation

from compiler.expressions.evaluators.balls import working_precision
from solvers.verifier.proofs.apart import Apart, BodiesApart
from solvers.verifier.proofs.checked_condition import CheckedCondition
from solvers.verifier.proofs.enclosure import TubeSegment
from solvers.verifier.proofs.least_margins import close_margins
from solvers.verifier.proofs.point_map import Slice
from solvers.verifier.proofs.state_limits import StateLimit, check_limits
from solvers.verifier.proofs.tube_checks import Inside, Status, Stretch, check_segment, row

SIZES = np.array([0.5, 0.3, 0.9])


@dataclass
class StraightPoints:
    """Points that move along straight lines, (p, 3) at first and per second."""

    places: np.ndarray
    rates: np.ndarray

    def over(self, segment: TubeSegment, u: object, middle: arb, half: arb) -> Slice:
        del u
        time = segment.start + middle
        points = tuple(
            tuple(
                (arb(x) + arb(v) * time, arb(v), arb(0)) for x, v in zip(place, rate, strict=True)
            )
            for place, rate in zip(self.places.tolist(), self.rates.tolist(), strict=True)
        )
        return Slice(time, half, points)


def checked(points: StraightPoints, constraint: Apart | Inside, count: int) -> None:
    """Hold a constraint against so many segments of a second together."""
    for k in range(count):
        steps = Fraction(k, count), Fraction(k + 1, count)
        segment = TubeSegment(arb(k) / count, arb(1) / count, steps, (), ())
        check_segment(points, Stretch.of(segment, ()), [constraint])  # type: ignore[arg-type]
    close_margins(points, [constraint])  # type: ignore[arg-type]


def distance(ends: np.ndarray, turn: np.ndarray) -> float:
    """From a rod to the turned box; the share along the rod is found by ternary search."""
    low, high = 0.0, 1.0
    local = ends @ turn

    def gap(share: float) -> float:
        point = local[0] + share * (local[1] - local[0])
        return float(np.linalg.norm(point - np.clip(point, -SIZES, SIZES)))

    for _ in range(60):
        left, right = low + (high - low) / 3, high - (high - low) / 3
        low, high = (low, right) if gap(left) < gap(right) else (left, high)
    return gap((low + high) / 2)


@pytest.mark.parametrize("part", [0.0, 0.99, 0.9999])
@pytest.mark.parametrize("seed", range(12))
def test_margins_are_close_to_the_least_distance(seed: int, part: float) -> None:
    """A rod that tumbles past a tilted box, asked to keep a part of the distance that it does."""
    rng = np.random.default_rng(seed)
    turn = Rotation.random(random_state=seed).as_matrix()
    first = rng.uniform(-0.5, 0.5, (2, 3)) + rng.choice([-1, 1], 3) * rng.uniform(1.0, 1.6)
    last = first + rng.uniform(-1, 1, (2, 3))
    motion = StraightPoints(first @ turn.T, (last - first) @ turn.T)
    faces = [
        row([Fraction(float(x)) for x in sign * turn[:, axis]], Fraction(float(SIZES[axis])))
        for axis in range(3)
        for sign in (-1.0, 1.0)
    ]
    corners = np.array(list(product(*((-s, s) for s in SIZES)))) @ turn.T
    bodies = Apart(
        "tumbling", points=(0, 1), rows=tuple(faces),
        vertices=tuple(tuple(arb(x) for x in corner) for corner in corners.tolist()),
    )  # fmt: skip
    times = np.linspace(0, 1, 600)
    true = min(distance(motion.places + t * motion.rates, turn) for t in times)
    if true < 1e-3:
        pytest.skip("it touches the box")
    with working_precision(80):
        bodies.distance = arb(part * true)
        checked(motion, bodies, 24)
    room = (1 - part) * true
    assert bodies.status is Status.HOLDS
    assert 0.95 * room <= bodies.margin <= room + 1e-6


def test_the_margin_of_what_does_not_move_is_told() -> None:
    box = [row([Fraction(1), Fraction(0), Fraction(0)], Fraction(1))]
    room = Inside("bounds", points=(0,), rows=tuple(box))
    still = StraightPoints(np.array([[0.25, 0.0, 0.0]]), np.zeros((1, 3)))
    with working_precision(80):
        checked(still, room, 5)
    assert room.margin == pytest.approx(0.75, rel=1e-9)
    assert room.time < 1


@pytest.mark.parametrize("seed", range(8))
def test_margins_of_limits_are_close(seed: int) -> None:
    """A polynomial of degree 9 against its values at 20,000 instants."""
    rng = np.random.default_rng(seed)
    coefficients = rng.normal(size=(2, 10)) * 3.0 ** np.arange(10)[::-1] / 3**9
    times = np.linspace(0, 2, 20_001)
    values = [np.polynomial.polynomial.polyval(times, row) for row in coefficients]
    sums = values[0] - 2 * values[1]
    room = 0.003
    upper, lower = float(sums.max()) + room, float(sums.min()) - 3 * room
    limit = StateLimit("range", "rad", (1, -2), arb(lower), arb(upper))
    with working_precision(80):
        states = tuple([arb(x) for x in row] for row in coefficients.tolist())
        steps = Fraction(0), Fraction(1)
        segment = TubeSegment(arb(0), arb(2), steps, states, ())
        check_limits(Stretch.of(segment, ()), [limit])
    assert limit.status is Status.HOLDS
    assert 0.97 * room <= limit.margin <= room + 1e-6


@pytest.mark.parametrize(
    ("margin", "digits", "shown"),
    [
        (0.00019999999964, 6, 0.000199999),
        (1.8215673184, 6, 1.82156),
        (0.5, 4, 0.5),
        (-0.00012345, 4, -0.0001235),
    ],
)
def test_digits_of_a_margin_say_no_more_than_was_proved(
    margin: float, digits: int, shown: float
) -> None:
    assert CheckedCondition("bounds", Status.HOLDS, margin, "m").least(digits) == shown


def rods_apart(dimension: int, distance: float) -> BodiesApart:
    """Two rods, points 0 and 1, and 2 and 3; the differences of their points are 4 to 7."""
    axes = range(dimension)
    return BodiesApart(
        "bodies",
        points=(4, 5, 6, 7),
        rows=tuple(row([Fraction(s * (i == j)) for j in axes], Fraction(0)) for i in axes
                   for s in (1, -1)),
        vertices=(tuple(arb(0) for _ in axes),),
        distance=arb(distance),
        body=(0, 1),
    )  # fmt: skip


def with_differences(ends: np.ndarray) -> np.ndarray:
    """Ends of two rods (4, 3), and then the differences of the first one's from the second's."""
    return np.concatenate([ends, (ends[:2, None] - ends[None, 2:]).reshape(4, 3)])


def rods_distance(ends: np.ndarray) -> float:
    """The distance of two rods by the closest places on 60 x 60 parts, refined three times."""
    low, high = np.zeros(2), np.ones(2)
    for _ in range(4):
        s, t = (np.linspace(low[i], high[i], 61) for i in range(2))
        one = ends[0] + s[:, None] * (ends[1] - ends[0])
        two = ends[2] + t[:, None] * (ends[3] - ends[2])
        gaps = np.linalg.norm(one[:, None] - two[None], axis=2)
        i, j = np.unravel_index(int(gaps.argmin()), gaps.shape)
        width = (high - low) / 30
        centre = np.array([s[i], t[j]])
        low, high = np.maximum(0, centre - width), np.minimum(1, centre + width)
    return float(gaps.min())


@pytest.mark.parametrize("seed", range(12))
def test_two_rods_that_move(seed: int) -> None:
    rng = np.random.default_rng(seed)
    ends = rng.normal(size=(4, 3)) + np.array([[3.0], [3.0], [0.0], [0.0]])
    rates = rng.normal(size=(4, 3))
    instants = [ends + t * rates for t in np.linspace(0, 1, 200)]
    least = min(rods_distance(each) for each in instants)
    distance = least / 2
    bodies = rods_apart(3, distance)
    with working_precision(80):
        points = StraightPoints(with_differences(ends), with_differences(rates))
        checked(points, bodies, 5)
    assert bodies.status is Status.HOLDS
    assert bodies.margin <= least - distance + 1e-9
    assert bodies.margin >= 0.97 * (least - distance) - 1e-3
    at = ends + bodies.time * rates
    line = np.array(bodies.place) - at[0]
    along = at[1] - at[0]
    assert np.linalg.norm(np.cross(line, along)) <= 1e-6 * np.linalg.norm(along)
    too_near = rods_apart(3, least + 0.05)
    with working_precision(80):
        checked(points, too_near, 5)
    assert too_near.status is Status.FAILS


def test_rods_that_cross_in_the_plane() -> None:
    """Thin rods that pass through each other; those that only come near each other do not."""
    for reach, expected in ((0.6, Status.FAILS), (0.4, Status.HOLDS)):
        ends = np.array([[-1.0, 0.5], [1.0, 0.5], [0.1, reach - 1], [-0.1, reach - 3]])
        rates = np.array([[0.0, -0.5], [0.0, -0.5], [0.0, 0.5], [0.0, 0.5]])
        ends, rates = (
            np.concatenate([e, (e[:2, None] - e[None, 2:]).reshape(4, 2)]) for e in (ends, rates)
        )
        bodies = rods_apart(2, 0.0)
        with working_precision(80):
            checked(StraightPoints(ends, rates), bodies, 3)
        assert bodies.status is expected
