"""Sets of states as zonotopes: what is moved, widened or reduced holds what it should."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from flint import arb, arb_mat

from compiler.expressions.evaluators.balls import working_precision
from solvers.verifier.proofs.zonotope import (
    LIMITS,
    InitialSet,
    OrderLimits,
    Zonotope,
    box,
    zonotope,
)
from tests.solvers.test_feedback import exact


def test_the_image_of_a_zonotope_holds_the_images_of_its_points() -> None:
    rng = np.random.default_rng(11)
    size = 3
    with working_precision(53):
        current = zonotope(box([arb(1, 0.5), arb(-2), arb(0, 0.25)]))
        points = np.array([1, -2, 0]) + np.array([0.5, 0, 0.25]) * rng.uniform(-1, 1, (50, 3))
        for _ in range(60):
            matrix = np.linalg.qr(rng.normal(size=(size, size)))[0]
            to, added = rng.normal(size=size), rng.uniform(0, 0.01, size)
            middle = np.array([float(x) for x in current.middle])
            points = to + (points - middle) @ matrix.T + added * rng.uniform(-1, 1, (50, 3))
            turn = arb_mat([[arb(float(x)) for x in row] for row in matrix])
            current = current.moved([arb(x) for x in to], turn, [arb(x) for x in added])
            assert current.columns.shape[1] <= LIMITS.largest * size
            hull = current.hull()
            for i, item in enumerate(hull):
                low, high = float(item.lower()), float(item.upper())
                assert low - 1e-12 <= points[:, i].min() <= points[:, i].max() <= high + 1e-12
    # The true set has a radius of at most |r| + 60 |d|, here below 1.6, in any direction.
    assert all(float(r) < 2 for r in current.radii)


@pytest.mark.parametrize(("small", "fewer"), [(1e-6, True), (1.0, False)])
def test_columns_are_replaced_where_that_does_not_widen_a_set(small: float, fewer: bool) -> None:
    """Support functions in random directions: the set is held, and is hardly wider."""
    rng = np.random.default_rng(5)
    size, limits = 3, OrderLimits(most=8, kept=6, largest=20, left=10)
    columns = rng.normal(size=(30, size))
    columns[12:] *= small
    with working_precision(53):
        before = Zonotope([arb(0)] * size, columns.T)
        after = before.reduced(limits)
        left = after.columns.T
        assert (len(left) <= limits.kept * size + size) is fewer
        crowd = Zonotope(before.middle, np.tile(before.columns, 3)).reduced(limits)
        assert crowd.columns.shape[1] <= limits.left * size + size
    for _ in range(50):
        direction = rng.normal(size=size)
        own, held, more = (
            np.abs(item @ direction).sum() for item in (columns, left, crowd.columns.T)
        )
        assert held >= own * (1 - 1e-12)
        assert more >= 3 * own * (1 - 1e-12)
    assert all(float(b) <= 1.03 * float(a) for a, b in zip(before.radii, after.radii, strict=True))


@pytest.mark.parametrize(
    ("generators", "radii", "message"),
    [
        ((), (arb(1),), "row of generators"),
        (((arb(1),), (arb(1), arb(2))), (arb(1),), "column of generators"),
        (((arb(1),), (arb(1),)), (arb(-1),), "not negative"),
    ],
)
def test_initial_sets_that_are_none(
    generators: tuple[tuple[arb, ...], ...], radii: tuple[arb, ...], message: str
) -> None:
    with pytest.raises(ValueError, match=message):
        InitialSet((arb(0), arb(0)), generators, radii)


def support(columns: np.ndarray, direction: list[Fraction]) -> Fraction:
    """What the columns reach in a direction, exactly."""
    reach = [
        sum((w * Fraction(x) for w, x in zip(direction, column, strict=True)), Fraction(0))
        for column in columns.T.tolist()
    ]
    return sum(map(abs, reach), Fraction(0))


@pytest.mark.parametrize("seed", range(20))
@pytest.mark.parametrize(
    ("scale", "slope"),
    [
        (1.0, 1.0),
        (2.0**-1030, 1e-20),
        (2.0**-540, 2.0**-520),
        (2.0**500, 1.0),
        (2.0**950, 2.0**-1060),
    ],
)
def test_no_rounding_of_columns_loses_a_state(seed: int, scale: float, slope: float) -> None:
    """Support functions in exact rational numbers, along axes and between them, of all scales."""
    rng = np.random.default_rng(seed)
    size, width = 4, int(rng.integers(1, 40))
    columns = rng.normal(size=(size, width)) * scale * 2.0 ** rng.integers(-30, 30, size=width)
    matrix = rng.normal(size=(size, size)) * 10.0 ** rng.integers(-3, 3, size=(size, size)) * slope
    matrix[1] = [0, 1, 0, 0]
    before = Zonotope([arb(0)] * size, columns)
    turn = arb_mat(matrix.tolist())
    after = before.moved([arb(0)] * size, turn, [arb(0)] * size)
    fewer = before.reduced(OrderLimits(3, 2, 3, 2))
    reached = before.radii_under(turn)
    assert after.columns[1, :width].tolist() == columns[1].tolist()
    for _ in range(10):
        unit = [Fraction(int(x)) for x in rng.integers(-1, 2, size)]
        turned = [
            sum((w * Fraction(matrix[i, j]) for i, w in enumerate(unit)), Fraction(0))
            for j in range(size)
        ]
        assert support(after.columns, unit) >= support(columns, turned)
        assert support(fewer.columns, unit) >= support(columns, unit)
    for row, bound in zip(matrix.tolist(), reached, strict=True):
        assert exact(bound.upper()) >= support(columns, [Fraction(x) for x in row])
