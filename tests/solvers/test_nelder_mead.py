"""The simplex method against SciPy's, its restarts, and its behaviour at the faces of the cube."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.optimize import minimize

from solvers.parameters.nelder_mead import EDGE, NelderMead
from solvers.parameters.parameter_search import Cube, ParameterSearch


def run(f, start, evaluations, small=1e-3):
    """All points that are evaluated from a start on."""
    search = ParameterSearch(Cube((None,) * len(start)), 0, 1, NelderMead(0, small))
    search.ask(1)
    search.record.pending.clear()
    search.tell(np.array(start), f(np.array(start)))
    while len(search.points) < evaluations:
        for point in search.ask(10):
            search.tell(point, f(point))
    return np.array(search.points[:evaluations])


def valley(point):
    x = 1.2 * point - 0.1 + 0.05 * np.arange(len(point))
    curved = np.sum(20 * (x[1:] - x[:-1] ** 2 - 0.3) ** 2)
    return -float(curved + np.sum((x - 0.45) ** 2))


def ridge(point):
    """Not differentiable, so that simplices shrink."""
    return -float(np.max(np.abs(point - 0.4)) + 0.3 * np.abs(np.sum(point) - 0.9))


@pytest.mark.parametrize("axes", [2, 3, 4])
@pytest.mark.parametrize("f", [valley, ridge])
def test_it_evaluates_what_scipy_evaluates(axes: int, f) -> None:
    """An interior problem, the same simplex, the adaptive coefficients of Gao and Han."""
    # Later on the values are equal but for rounding.
    start, count = np.linspace(0.2, 0.45, axes), 22 * axes
    theirs = []

    def negative(point):
        theirs.append(point.copy())
        return -f(point)

    simplex = np.concatenate([start[None], start + EDGE * np.eye(axes)])
    options = {
        "initial_simplex": simplex,
        "adaptive": True,
        "xatol": 0,
        "fatol": 0,
        "maxfev": count,
    }
    minimize(negative, start, method="Nelder-Mead", options=options)
    expected = np.array(theirs)
    assert len(expected) == count
    assert np.all((expected > 0) & (expected < 1))
    ours = run(f, start, len(expected), small=0.0)
    np.testing.assert_allclose(ours, expected, atol=1e-9)


def test_it_converges_in_one_to_six_axes() -> None:
    for axes in range(1, 7):
        target = np.linspace(0.35, 0.6, axes)
        points = run(lambda p, t=target: -float(np.sum((p - t) ** 2)), [0.2] * axes, 60 * axes)
        assert np.min(np.max(np.abs(points - target), axis=1)) < 0.02


def test_a_corner_is_found_along_the_faces() -> None:
    points = run(lambda p: float(p[0] + 2 * p[1] - p[2]), [0.3, 0.4, 0.5], 80)
    assert points.min() >= 0
    assert points.max() <= 1
    assert np.min(np.max(np.abs(points - [1, 1, 0]), axis=1)) < 1e-3


def test_two_hills_are_found_by_restarts() -> None:
    """The start is on the lower hill, and one simplex never leaves it."""

    def hills(point):
        low = 1 - 30 * np.sum((point - 0.2) ** 2)
        high = 2 - 30 * np.sum((point - 0.8) ** 2)
        return float(max(low, high))

    values = [hills(point) for point in run(hills, [0.15, 0.2], 400)]
    assert max(values[:30]) < 1.01
    assert max(values) > 1.99


def test_a_flat_function_is_no_end() -> None:
    points = run(lambda _: 1.0, [0.5, 0.5], 60)
    assert len({point.tobytes() for point in points}) == 60
    assert np.ptp(points, axis=0).min() > 0.7
