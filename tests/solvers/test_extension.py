"""What boxes and discs add to moving points, against samples of their true supports."""

from __future__ import annotations

from fractions import Fraction
from itertools import product

import numpy as np
import pytest
from flint import arb

from solvers.verifier.proofs.apart import Apart
from solvers.verifier.proofs.extension import (
    BoxExtension,
    DiscExtension,
    Extension,
    corner_at,
    corners,
    lowest,
)
from solvers.verifier.proofs.point_map import Slice
from solvers.verifier.proofs.tube_checks import Inside, row

INSTANTS = np.linspace(-1, 1, 201)


class Moving:
    """Two points and five directions, each a polynomial of degree 2 in time, (7, 3, 3)."""

    def __init__(self, seed: int, size: int, half: float) -> None:
        rng = np.random.default_rng(seed)
        self.coefficients = rng.normal(size=(7, size, 3)) * [1.0, 1.0, 0.3]
        self.half, self.size = half, size
        self.halves = rng.uniform(0.1, 0.6, 3)
        self.radius = float(rng.uniform(0.1, 0.6))
        self.normal = rng.normal(size=size)

    @property
    def over(self) -> Slice:
        """The same in balls."""
        points = tuple(
            tuple((arb(a), arb(b), arb(c)) for a, b, c in axes)
            for axes in self.coefficients.tolist()
        )
        return Slice(arb(1), arb(self.half), points)

    @property
    def extensions(self) -> tuple[Extension, ...]:
        """A box along directions 2 to 4 (all that there are), a disc along 5 and 6."""
        box = BoxExtension(
            tuple(range(2, 2 + self.size)), tuple(map(arb, self.halves[: self.size]))
        )
        return box, DiscExtension((5, 6), arb(self.radius))

    def at(self, share: float) -> np.ndarray:
        """All points (7, d) at a share of the half-width from the middle."""
        time = share * self.half
        return self.coefficients @ np.array([1.0, time, time * time])

    def least(self, share: float) -> float:
        """The least of normal . p by the closed form of the support."""
        heights = self.at(share) @ self.normal
        box = np.abs(heights[2 : 2 + self.size]) @ self.halves[: self.size]
        return float(heights[:2].min() - box - self.radius * np.hypot(*heights[5:]))


@pytest.mark.parametrize("seed", range(40))
@pytest.mark.parametrize("half", [0.0, 1e-3, 0.03, 0.5])
def test_lowest_is_below_all_instants_and_close(seed: int, half: float) -> None:
    moving = Moving(seed, 2 + seed % 2, half)
    normal = [arb(x) for x in moving.normal.tolist()]
    forms = list(lowest(moving.over, normal, (0, 1), moving.extensions))
    lower = min(float(value.lower()) for value, _ in forms)
    true = [moving.least(share) for share in INSTANTS]
    assert lower <= min(true) + 1e-12
    assert min(float(at.mid()) for _, at in forms) == pytest.approx(moving.least(0), abs=1e-9)
    if half < 0.1:
        assert lower >= min(true) - 8 * half**2 - 1e-9


@pytest.mark.parametrize("seed", range(20))
def test_corners_lie_in_the_set_and_reach_its_end(seed: int) -> None:
    moving = Moving(seed, 3, 0.0)
    *_, disc = moving.extensions
    way = disc.lowest_on_rim(moving.normal.tolist(), moving.over)
    assert way is not None
    found = corners((0, 1), moving.extensions, ((), (way,)))
    places = np.array([[float(x.mid()) for x in corner_at(moving.over, each)] for each in found])
    assert (places @ moving.normal).min() == pytest.approx(moving.least(0), abs=1e-9)
    rng = np.random.default_rng(seed)
    for direction in rng.normal(size=(50, 3)):
        moving.normal = direction
        assert (places @ direction).min() >= moving.least(0) - 1e-9


@pytest.mark.parametrize("turn", [0.0, 0.4, 1.2])
def test_a_disc_that_is_level_has_no_lowest_point(turn: float) -> None:
    """The normal is along the axis of the disc: all its points are as low as its middle."""
    frame = np.array([[np.cos(turn), np.sin(turn), 0], [-np.sin(turn), np.cos(turn), 0]])
    points = [np.zeros(3), *frame]
    over = Slice(
        arb(0), arb(0),
        tuple(tuple((arb(x), arb(0), arb(0)) for x in point.tolist()) for point in points),
    )  # fmt: skip
    disc = DiscExtension((1, 2), arb(1))
    ((value, at),) = lowest(over, [arb(0), arb(0), arb(1)], (0,), (disc,))
    assert abs(float(value.mid())) < 1e-15
    assert abs(float(at.mid())) < 1e-15
    assert disc.lowest_on_rim([0.0, 0.0, 1.0], over) is None


def still(points: list[list[float]]) -> Slice:
    """Points that do not move."""
    return Slice(
        arb(0), arb(0),
        tuple(tuple((arb(x), arb(0), arb(0)) for x in point) for point in points),
    )  # fmt: skip


@pytest.mark.parametrize("seed", range(30))
def test_boxes_and_cylinders_by_a_wall_and_within_bounds(seed: int) -> None:
    """The clearance from a half-space, and the room left in another one, in closed form."""
    rng = np.random.default_rng(seed)
    frame = np.linalg.qr(rng.normal(size=(3, 3)))[0]
    middle, halves = rng.normal(size=3), rng.uniform(0.1, 1, 3)
    over = still([middle.tolist(), (middle + frame[0]).tolist(), *frame.tolist()])
    normal = [Fraction(int(x)) for x in rng.integers(1, 9, 3)]
    unit = np.array([float(x) for x in normal])
    unit /= np.linalg.norm(unit)
    for extension, points, reach, far in (
        (
            BoxExtension((2, 3, 4), tuple(map(arb, halves))), (0,),
            np.abs(frame @ unit) @ halves, 0.0,
        ),
        (
            DiscExtension((3, 4), arb(float(halves[0]))), (0, 1),
            halves[0] * np.hypot(*(frame[1:] @ unit)), frame[0] @ unit,
        ),
    ):  # fmt: skip
        low = middle @ unit + min(0.0, far) - reach
        wall = Apart("wall", points, (extension,), rows=(row(normal, Fraction(-9)),))
        assert float(wall.bound(over)[0].mid()) == pytest.approx(low + 9 / norm(normal), abs=1e-9)
        assert wall.violated(over) == (low < -9 / norm(normal))
        room = Inside("bounds", points, (extension,), rows=(row(normal, Fraction(2)),))
        high = middle @ unit + max(0.0, far) + reach
        assert float(room.bound(over)[0].mid()) == pytest.approx(2 / norm(normal) - high, abs=1e-9)
        assert room.violated(over) == (high > 2 / norm(normal))


def norm(normal: list[Fraction]) -> float:
    return float(np.linalg.norm([float(x) for x in normal]))


def test_corners_of_a_box_are_all_its_corners() -> None:
    over = still([[0.0, 0.0, 0.0], *np.eye(3).tolist()])
    box = BoxExtension((1, 2, 3), (arb(1), arb(2), arb(3)))
    found = {tuple(float(x) for x in corner_at(over, each)) for each in corners((0,), (box,))}
    assert found == set(product((-1.0, 1.0), (-2.0, 2.0), (-3.0, 3.0)))
