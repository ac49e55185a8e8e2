from __future__ import annotations

from math import pi

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from srgc.render.svg import NAMED, fitted, sight

ANGLES = st.floats(-7, 7)


@given(ANGLES, ANGLES)
def test_sight_is_orthonormal(azimuth: float, elevation: float) -> None:
    axes = sight(azimuth, elevation)
    assert np.allclose(axes @ axes.T, np.eye(2))


@pytest.mark.parametrize(
    ("name", "right", "up"),
    [
        ("Front", (1, 0, 0), (0, 0, 1)),
        ("Side", (0, 1, 0), (0, 0, 1)),
        ("Top", (1, 0, 0), (0, 1, 0)),
    ],
)
def test_named_views(name: str, right: tuple[int, ...], up: tuple[int, ...]) -> None:
    ((azimuth, elevation),) = [each[1:] for each in NAMED if each[0].startswith(name)]
    assert np.allclose(sight(azimuth, elevation), [right, up])


@given(st.lists(st.tuples(*[st.floats(-50, 50)] * 3), min_size=1, max_size=9), ANGLES, ANGLES)
def test_space_stays_in_the_picture_however_it_is_turned(
    corners: list[tuple[float, ...]], azimuth: float, elevation: float
) -> None:
    view = fitted([np.array(corners)])
    turned = type(view)(sight(azimuth, elevation), view.centre, view.scale, view.width, view.height)
    seen = turned.project(np.array(corners))
    assert (seen > -1e-6).all()
    assert (seen < [view.width + 1e-6, view.height + 1e-6]).all()


@given(st.lists(st.tuples(st.floats(-50, 50), st.floats(-50, 50)), min_size=1, max_size=9))
def test_plane_fits_and_is_not_distorted(corners: list[tuple[float, float]]) -> None:
    points = np.array(corners)
    view = fitted([points])
    seen = view.project(points)
    assert (seen >= 0).all()
    assert (seen <= [view.width, view.height]).all()
    assert np.allclose(seen - seen[0], (points - points[0]) * [view.scale, -view.scale])


def test_view_of_a_robot_is_filled() -> None:
    box = np.array([(x, y, z) for x in (0.0, 1) for y in (0.0, 2) for z in (0.0, 9)])
    seen = fitted([box], turning=False).project(box)
    assert np.ptp(seen, axis=0).max() > 500
    assert fitted([box]).scale < fitted([box], turning=False).scale


def test_smaller_picture_is_the_same() -> None:
    points = np.array([(0.0, 0), (3, 1)])
    view = fitted([points])
    assert np.allclose(view.scaled(72).project(points), view.project(points) / 10)


def test_up_is_up_from_everywhere_between() -> None:
    for elevation in np.linspace(-pi / 2 + 0.01, pi / 2 - 0.01, 7):
        assert sight(1.0, float(elevation))[1, 2] > 0
