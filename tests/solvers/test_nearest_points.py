"""Nearest points of convex hulls, against shapely in the plane and a line search in space."""

from __future__ import annotations

import numpy as np
import pytest
import shapely
from scipy.optimize import minimize_scalar
from scipy.spatial.transform import Rotation

from solvers.verifier.proofs.apart import nearest_points

BOX = np.array([[x, y, z] for x in (-1, 1) for y in (-2, 2) for z in (-0.5, 0.5)])


@pytest.mark.parametrize("seed", range(40))
def test_in_the_plane(seed: int) -> None:
    rng = np.random.default_rng(seed)
    left = rng.normal(size=(rng.integers(1, 4), 2))
    right = rng.normal(size=(rng.integers(3, 9), 2)) + rng.uniform(-3, 3, 2)
    found = nearest_points(left.tolist(), right.tolist())
    sets = [shapely.MultiPoint(points).convex_hull for points in (left, right)]
    assert np.linalg.norm(found.difference) == pytest.approx(shapely.distance(*sets), abs=1e-9)


@pytest.mark.parametrize("seed", range(40))
def test_a_segment_and_a_tilted_box(seed: int) -> None:
    rng = np.random.default_rng(seed)
    turn = Rotation.random(random_state=seed)
    ends = rng.uniform(-4, 4, (2, 3))

    def gap(share: float) -> float:
        point = ends[0] + share * (ends[1] - ends[0])
        return float(np.linalg.norm(point - np.clip(point, BOX.min(axis=0), BOX.max(axis=0))))

    least = min(
        gap(0.0), gap(1.0), minimize_scalar(gap, bounds=(0, 1), options={"xatol": 1e-12}).fun
    )
    found = nearest_points(turn.apply(ends).tolist(), turn.apply(BOX).tolist())
    assert np.linalg.norm(found.difference) == pytest.approx(least, abs=1e-6)
    for weights in (found.left, found.right):
        assert min(weights) >= 0
        assert sum(weights) == pytest.approx(1)
    mixed = np.array(found.left) @ turn.apply(ends) - np.array(found.right) @ turn.apply(BOX)
    assert mixed == pytest.approx(np.array(found.difference), abs=1e-9)


def test_sets_that_meet_have_no_direction() -> None:
    found = nearest_points([[-3.0, 0.1, 0.2], [3.0, -0.1, 0.1]], BOX.tolist())
    assert np.linalg.norm(found.difference) == pytest.approx(0, abs=1e-9)
