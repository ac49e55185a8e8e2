"""Distances of convex hulls from zero, against the best of all faces by least squares."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from compiler.arrays import Array
from compiler.discretisation.hull_distance import nearest_to_zero
from solvers.trajectory.convex_set import point_set
from solvers.trajectory.separating_planes import Obstacles, separating_planes


def by_faces(points: Array) -> float:
    """The distance of the hull of points (w, d) from zero: that of the best face; 0 if inside.

    A point x of the hull is nearest to zero if and only if x . p >= x . x for all points p.
    """
    scale = np.max(np.abs(points))
    points = points / scale
    for size in range(1, points.shape[1] + 1):
        for face in combinations(range(len(points)), size):
            corners = points[list(face)]
            system = np.ones((size + 1, size + 1))
            system[0, 0], system[1:, 1:] = 0.0, corners @ corners.T
            right = np.eye(size + 1)[0]
            shares = np.linalg.lstsq(system, right, rcond=None)[0][1:]
            nearest = shares @ corners
            if np.all(shares >= -1e-12) and np.all(points @ nearest >= nearest @ nearest - 1e-10):
                return float(scale * np.linalg.norm(nearest))
    return 0.0


def differences(rng: np.random.Generator, shape: tuple[int, int, int], width: int) -> Array:
    """Differences (k, width^2, d) of the points of two bodies; some flat, some small or large."""
    k, _, d = shape
    one, two = rng.normal(size=(2, k, width, d))
    found = (one[:, :, None] - two[:, None]).reshape(k, width**2, d)
    found += rng.normal(size=(k, 1, d)) * rng.choice([0.5, 2.0, 20.0], size=(k, 1, 1))
    return found * 10.0 ** rng.uniform(-3, 2, size=(k, 1, 1))


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("width", [1, 2, 3])
def test_nearest_points(dimension: int, width: int) -> None:
    rng = np.random.default_rng(10 * dimension + width)
    points = differences(rng, (300, 0, dimension), width)
    found = np.linalg.norm(nearest_to_zero(points), axis=1)
    scale = np.max(np.linalg.norm(points, axis=2), axis=1)
    expected = np.array([by_faces(each) for each in points])
    assert np.all(np.abs(found - expected) <= 1e-9 * scale)
    assert np.count_nonzero(expected) > 100


@pytest.mark.parametrize("dimension", [2, 3])
def test_separated_from_a_point(dimension: int) -> None:
    rng = np.random.default_rng(dimension)
    place = rng.normal(size=dimension)
    swept = differences(rng, (200, 0, dimension), 2) + place
    obstacle = Obstacles((point_set(place),))
    normal, support = separating_planes(swept, obstacle)
    assert np.allclose(np.linalg.norm(normal, axis=1), 1.0)
    assert np.allclose(support, normal @ place)
    gap = np.min(np.einsum("kd,kwd->kw", normal, swept), axis=1) - support
    expected = np.array([by_faces(each - place) for each in swept])
    scale = np.max(np.abs(swept - place), axis=(1, 2))
    apart = expected > 1e-6
    assert np.all(np.abs(gap - expected)[apart] <= 1e-9 * scale[apart])
    assert np.all(gap[~apart] <= 1e-9)


def test_touching_and_degenerate_hulls() -> None:
    square = np.array([[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]])
    on_edge = square + np.array([1.0, 0.0])
    alike = np.tile([[0.3, 0.4]], (4, 1))
    line = np.array([[1.0, -1.0], [1.0, 0.0], [1.0, 1.0], [1.0, 2.0]])
    found = nearest_to_zero(np.array([square, on_edge, alike, line]))
    assert np.allclose(found, [[0, 0], [0, 0], [0.3, 0.4], [1, 0]], atol=1e-15)
