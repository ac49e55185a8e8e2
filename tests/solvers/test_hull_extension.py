"""What hulls add to moving points, against all their corners in exact fractions, and distances.

Frames are turned by rational rotations (Cayley's), so that corners, heights and gaps are exact.
"""

from __future__ import annotations

from fractions import Fraction
from itertools import product
from typing import Any

import numpy as np
import pytest
from flint import arb, arb_mat
from scipy.optimize import linprog

from compiler.expressions.evaluators.balls import ball
from solvers.verifier.proofs.apart import Apart, BodiesApart
from solvers.verifier.proofs.extension import (
    BoxExtension,
    DiscExtension,
    corner_at,
    corners,
    lowest,
)
from solvers.verifier.proofs.hull_extension import HullExtension, ManyCorners
from solvers.verifier.proofs.point_map import Slice
from solvers.verifier.proofs.tube_checks import Inside, row
from tests.oracles.hulled_arms import hull_gap

INSTANTS = [Fraction(i, 40) for i in range(-40, 41)]


def fractions(rng: np.random.Generator, shape: tuple[int, ...], size: int = 1000) -> np.ndarray:
    """Random fractions between about -1 and 1, as objects."""
    numbers = rng.integers(-size, size + 1, shape)
    return np.vectorize(lambda i: Fraction(int(i), size), otypes=[object])(numbers)


def rotation(rng: np.random.Generator) -> np.ndarray:
    """A random rotation matrix of fractions, by Cayley's transform."""
    x, y, z = fractions(rng, (3,), 60) * 2
    skew = np.array([[0, -z, y], [z, 0, -x], [-y, x, 0]], dtype=object)
    size = 1 + x * x + y * y + z * z
    own = np.array([x, y, z], dtype=object)
    eye = np.array([[Fraction(int(i == j)) for j in range(3)] for i in range(3)], dtype=object)
    return ((2 - size) * eye + 2 * np.outer(own, own) + 2 * skew) / size


def test_rotations_are_exact() -> None:
    for seed in range(5):
        turn = rotation(np.random.default_rng(seed))
        assert (turn @ turn.T == np.eye(3, dtype=int)).all()


def still(points: np.ndarray) -> Slice:
    """Points that do not move."""
    zero = arb(0)
    return Slice(zero, zero, tuple(tuple((ball(x), zero, zero) for x in p) for p in points))


class Moving:
    """A point and the columns of two hulls, polynomials of degree 2 in time, (1 + 2d, d, 3)."""

    def __init__(self, seed: int, size: int, half: Fraction) -> None:
        rng = np.random.default_rng(seed)
        self.size, self.half = size, half
        self.coefficients = fractions(rng, (1 + 2 * size, size, 3))
        counts = rng.integers(1, 33, 2)
        self.hulls = [fractions(rng, (int(count), size)) for count in counts]
        if seed % 3 == 0:  # All as far away as each other in some directions: ties.
            self.hulls[0] = np.array(list(product((Fraction(-1), Fraction(1)), repeat=size)))
        self.normal = fractions(rng, (size,))
        if seed % 4 == 0:
            self.normal = np.array([Fraction(1)] + [Fraction(0)] * (size - 1), dtype=object)
            self.coefficients[1, 0] = [Fraction(0), Fraction(seed % 8), Fraction(1)]

    @property
    def over(self) -> Slice:
        points = tuple(
            tuple((ball(a), ball(b), ball(c)) for a, b, c in axes) for axes in self.coefficients
        )
        return Slice(arb(1), ball(self.half), points)

    @property
    def extensions(self) -> tuple[HullExtension, HullExtension]:
        size = self.size
        return (
            HullExtension.of(tuple(range(1, 1 + size)), self.hulls[0].tolist()),
            HullExtension.of(
                tuple(range(1 + size, 1 + 2 * size)), self.hulls[1].tolist()
            ).opposite(),
        )

    def least(self, share: Fraction) -> Fraction:
        """The least of normal . p over all corners of the first less those of the second."""
        time = share * self.half
        heights = self.coefficients @ np.array([Fraction(1), time, time * time]) @ self.normal
        one, two = (
            hull @ heights[1 + i * self.size : 1 + (i + 1) * self.size]
            for i, hull in enumerate(self.hulls)
        )
        found: Fraction = heights[0] + min(one) - max(two)
        return found


@pytest.mark.parametrize("seed", range(48))
@pytest.mark.parametrize("half", ["0", "1/1000", "3/100", "1/2"])
def test_no_corner_is_lower_at_any_instant(seed: int, half: str) -> None:
    moving = Moving(seed, 2 + seed % 2, Fraction(half))
    normal = [ball(x) for x in moving.normal]
    forms = list(lowest(moving.over, normal, (0,), moving.extensions))
    true = [moving.least(share) for share in INSTANTS]
    lower = arb("inf")
    for value, _ in forms:
        lower = lower.min(value)
    assert not bool(lower.lower() > ball(min(true)))
    at_middle = min(float(at.lower()) for _, at in forms)
    middle = float(moving.least(Fraction(0)))
    assert at_middle <= middle + 1e-12
    if moving.half < Fraction(1, 10):
        # What is lost is of first order in the slice, and only where a great many corners tie.
        assert float(lower.lower()) >= float(min(true)) - 40 * float(moving.half) - 1e-12
    if moving.half == 0:
        assert at_middle == pytest.approx(middle, abs=1e-12)


@pytest.mark.parametrize("seed", range(8))
def test_corners_that_are_left_out_count(seed: int) -> None:
    """Of 32 corners on a sphere, over so long a slice that each of them may be the lowest."""
    moving = Moving(seed, 3, Fraction(2))
    rng = np.random.default_rng(seed)
    moving.hulls[0] = np.array([rotation(rng)[0] for _ in range(32)])
    first, _ = moving.extensions
    forms = [moving.over.form([ball(x) for x in moving.normal], i) for i in first.columns]
    kept, over, _ = first.lowest(forms)
    assert len(kept) == 8
    assert float(over.lower()) < 0
    moving.hulls[1] = np.array([[Fraction(0)] * 3])
    lower = arb("inf")
    for value, _ in lowest(moving.over, [ball(x) for x in moving.normal], (0,), moving.extensions):
        lower = lower.min(value)
    assert not bool(lower.lower() > ball(min(moving.least(share) for share in INSTANTS)))


@pytest.mark.parametrize("seed", range(24))
@pytest.mark.parametrize("size", [1, 100])
def test_no_corner_is_lower_in_any_state_of_a_wide_tube(seed: int, size: int) -> None:
    """Points and axes that are off a path by columns times the same shares between -1 and 1."""
    moving = Moving(seed, 2 + seed % 2, Fraction(0))
    rng = np.random.default_rng(seed)
    path, d = moving.coefficients[:, :, 0], moving.size
    spread = fractions(rng, (len(path), d, 5)) * Fraction(size, 300)
    ranges = np.abs(spread).sum(axis=2)
    none = arb(0)
    over = Slice(
        none, none,
        tuple(
            tuple((ball(x) + ball(r) * arb(0, 1), none, none) for x, r in zip(*each, strict=True))
            for each in zip(path, ranges, strict=True)
        ),
        tuple(tuple(map(ball, each)) for each in path),
        tuple(arb_mat([[ball(x) for x in axis] for axis in each]) for each in spread),
    )  # fmt: skip
    lower = arb("inf")
    for value, _ in lowest(over, [ball(x) for x in moving.normal], (0,), moving.extensions):
        lower = lower.min(value)
    true = []
    for number in range(60):
        shares = fractions(rng, (5,)) if number % 2 else fractions(rng, (5,), 1)
        moving.coefficients = (path + spread @ shares)[:, :, None] * np.array([1, 0, 0])
        true.append(moving.least(Fraction(0)))
    assert not bool(lower.lower() > ball(min(true)))
    if size == 1:
        assert float(lower.lower()) > float(min(true)) - 0.3


class Pair:
    """Two hulls in tilted frames, and what a verifier is told of them: rational throughout."""

    def __init__(self, one: np.ndarray, two: np.ndarray, turns: list[np.ndarray], at: Any) -> None:
        self.local, self.turns, self.at = (one, two), turns, at

    @property
    def corners(self) -> tuple[np.ndarray, np.ndarray]:
        """In the world; the first one is ``at`` a place, the second one at zero."""
        one, two = (hull @ turn.T for hull, turn in zip(self.local, self.turns, strict=True))
        return one + self.at, two

    def apart(self, distance: Fraction = Fraction(0)) -> tuple[BodiesApart, Slice]:
        """The condition that they are so far apart, and the instant."""
        over = still(np.concatenate([[self.at], self.turns[0].T, self.turns[1].T]))
        one = HullExtension.of((1, 2, 3), self.local[0].tolist())
        two = HullExtension.of((4, 5, 6), self.local[1].tolist()).opposite()
        zero = tuple(
            row([Fraction(sign * (i == j)) for j in range(3)], Fraction(0))
            for i in range(3) for sign in (1, -1)
        )  # fmt: skip
        made = BodiesApart(
            "pair", (0,), (one, two), rows=zero, vertices=((arb(0),) * 3,),
            distance=ball(distance), body=(0,), shape=(one,),
        )  # fmt: skip
        return made, over

    def true(self) -> float:
        """Their distance by least squares."""
        one, two = (each.astype(float) for each in self.corners)
        return hull_gap(one, two)


@pytest.mark.parametrize("seed", range(60))
def test_pairs_are_apart_by_their_distance(seed: int) -> None:
    rng = np.random.default_rng(seed)
    hulls = [fractions(rng, (int(rng.integers(5, 33)), 3)) for _ in range(2)]
    turns = [rotation(rng) for _ in range(2)]
    pair = Pair(*hulls, turns, fractions(rng, (3,)) * int(rng.integers(1, 5)))
    true = pair.true()
    apart, over = pair.apart()
    bound, _ = apart.bound(over)
    if true > 1e-6:
        assert float(bound) == pytest.approx(true, abs=1e-7)
        one, _ = pair.corners
        assert inside(one.astype(float), np.array(apart.where(over)))
        nearer, over = pair.apart(Fraction(true) + Fraction(1, 10**5))
        assert nearer.violated(over)
        assert not bool(nearer.bound(over)[0] > 0)
        assert not apart.violated(over)
    else:
        assert not bool(bound > 0)


def inside(corners_: np.ndarray, place: np.ndarray) -> bool:
    """Whether a place is in a hull, up to rounding, by linear programming."""
    count = len(corners_)
    rows = np.concatenate([corners_.T, np.ones((1, count))])
    sides = np.concatenate([rows, -rows])
    most = np.concatenate([place, [1.0], -place, [-1.0]]) + 1e-7
    return bool(linprog(np.zeros(count), A_ub=sides, b_ub=most, bounds=(0, None)).success)


@pytest.mark.parametrize("seed", range(40))
@pytest.mark.parametrize("off", ["0", "-1/1000000000000", "1/1000000"])
def test_near_misses(seed: int, off: str) -> None:
    """Hulls that touch in one place, meet by a picometre, or are a micrometre apart.

    A plane through zero separates them by construction: all corners of one are on its one side, all
    of the other on the other side, some of either are on it and around a common place.
    """
    rng = np.random.default_rng(seed)
    turn = rotation(rng)
    normal = turn[:, 0]
    kind = seed % 4
    flat = [(0, 1, 0), (0, -1, 1), (0, -1, -1)] if kind in {0, 1} else [(0, 0, 0)]
    other = [(0, 0, 0)] if kind in {0, 2} else [(0, 1, 1), (0, -1, 1), (0, 0, -1)]
    if kind == 3:  # edges that cross
        flat, other = [(0, 1, 0), (0, -1, 0)], [(0, 0, 1), (0, 0, -1)]

    def hull(face: list[tuple[int, ...]], side: int) -> np.ndarray:
        rest = fractions(rng, (12, 3))
        rest[:, 0] = side * (abs(rest[:, 0]) + Fraction(1, 10 ** int(rng.integers(1, 4))))
        local = np.concatenate([np.array(face) * Fraction(1), rest])
        return local @ turn.T

    world = hull(flat, 1), hull(other, -1)
    turns = [rotation(rng) for _ in range(2)]
    local = [each @ frame for each, frame in zip(world, turns, strict=True)]
    gap = Fraction(off)
    pair = Pair(local[0], local[1], turns, normal * gap)
    one, two = pair.corners
    assert min(one @ normal) == gap
    assert max(two @ normal) == 0
    apart, over = pair.apart()
    bound, _ = apart.bound(over)
    assert bool(bound > 0) == (gap > 0)
    if gap > 0:
        assert float(bound) == pytest.approx(float(gap), rel=1e-3)
        assert not apart.violated(over)


@pytest.mark.parametrize("seed", range(30))
def test_a_hull_by_a_wall_and_within_bounds(seed: int) -> None:
    rng = np.random.default_rng(seed)
    turn, middle = rotation(rng), fractions(rng, (3,))
    local = fractions(rng, (int(rng.integers(1, 33)), 3))
    world = local @ turn.T + middle
    over = still(np.concatenate([[middle], turn.T]))
    hull = HullExtension.of((1, 2, 3), local.tolist())
    normal = [Fraction(int(x)) for x in rng.integers(1, 9, 3)]
    length = float(np.linalg.norm([float(x) for x in normal]))
    heights = world @ np.array(normal, dtype=object)
    low, high = min(heights), max(heights)
    wall = Apart("wall", (0,), (hull,), rows=(row(normal, low - Fraction(1, 10**9)),))
    assert float(wall.bound(over)[0]) == pytest.approx(1e-9 / length, rel=1e-5)
    assert not wall.violated(over)
    wall = Apart("wall", (0,), (hull,), rows=(row(normal, low + Fraction(1, 10**9)),))
    assert not bool(wall.bound(over)[0] > 0)
    assert wall.violated(over)
    for off in (-1, 1):
        room = Inside("bounds", (0,), (hull,), rows=(row(normal, high + Fraction(off, 10**9)),))
        assert bool(room.bound(over)[0] > 0) == (off > 0)
        assert room.violated(over) == (off < 0)


@pytest.mark.parametrize("seed", range(40))
def test_a_hull_and_other_shapes(seed: int) -> None:
    """Boxes by all their corners, cylinders by many places on their rims."""
    rng = np.random.default_rng(seed)
    local = fractions(rng, (20, 3))
    turns = [rotation(rng) for _ in range(2)]
    at = fractions(rng, (3,)) * 3
    far = turns[1].T[2] * Fraction(1, 2)  # the axis of a cylinder that begins at zero
    round_ = bool(seed % 2)
    points = [at, *([at - far] if round_ else []), *turns[0].T, *turns[1].T]
    over = still(np.array(points))
    first = 2 if round_ else 1
    hull = HullExtension.of((first, first + 1, first + 2), local.tolist())
    radius = Fraction(1, 5)
    if round_:
        other: Any = DiscExtension((first + 3, first + 4), ball(radius))
        angles = np.linspace(0, 2 * np.pi, 120, endpoint=False)
        rim = float(radius) * np.stack([np.cos(angles), np.sin(angles)], 1)
        frame = turns[1].astype(float)
        places = np.concatenate([rim @ frame.T[:2], rim @ frame.T[:2] + far.astype(float)])
    else:
        other = BoxExtension((first + 3, first + 4, first + 5), (ball(radius),) * 3)
        places = np.array(list(product((-0.2, 0.2), repeat=3))) @ turns[1].astype(float).T
    zero = tuple(row([Fraction(int(i == j)) for j in range(3)], Fraction(0)) for i in range(3))
    apart = BodiesApart(
        "pair", tuple(range(first)), (hull, other), rows=zero, vertices=((arb(0),) * 3,),
        body=(0,), shape=(hull,),
    )  # fmt: skip
    corners_ = (local @ turns[0].T + at).astype(float)
    true = hull_gap(corners_, places)
    bound = float(apart.bound(over)[0])
    assert bound <= true + 1e-7
    if true > 1e-4:
        assert bound >= true - 1e-4


def test_many_corners_are_those_in_order() -> None:
    rng = np.random.default_rng(1)
    over = still(fractions(rng, (8, 3)))
    extensions = (
        HullExtension.of((2, 3, 4), fractions(rng, (7, 3)).tolist()),
        HullExtension.of((5, 6, 7), fractions(rng, (5, 3)).tolist()).opposite(),
    )
    all_ = corners((0, 1), extensions)
    many = ManyCorners.of(over, (0, 1), extensions, ((), ()))
    assert [many.corner(i) for i in range(len(all_))] == all_
    places = [[float(x.mid()) for x in corner_at(over, each)] for each in all_]
    assert many.places == pytest.approx(np.array(places), abs=1e-12)


def test_hulls_of_the_plane_that_overlap_are_seen_to() -> None:
    """Two squares of which one covers the middle of the other: zero is among the differences."""
    square = [[Fraction(x), Fraction(y)] for x in (-1, 1) for y in (-1, 1)]
    eye = np.array([[1, 0], [0, 1]]) * Fraction(1)
    for at, meets in ((Fraction(3, 2), True), (Fraction(5, 2), False)):
        over = still(np.array([[at, Fraction(1, 3)], *eye, *eye]))
        one = HullExtension.of((1, 2), square)
        two = HullExtension.of((3, 4), square).opposite()
        apart = BodiesApart(
            "pair", (0,), (one, two), rows=(row([Fraction(1), Fraction(0)], Fraction(0)),),
            vertices=((arb(0), arb(0)),), body=(0,), shape=(one,),
        )  # fmt: skip
        assert apart.violated(over) == meets
        assert bool(apart.bound(over)[0] > 0) != meets
