"""The seeds of a path problem in the case study, with the whole arm and with its effector only."""

from __future__ import annotations

from math import cos, sin

import numpy as np
import pytest
import shapely

from tests.oracles.planned_arm import planned_spec

OBSTACLE = shapely.box(1.7, 2, 3, 3)


def clearance(theta: tuple[float, float], q: np.ndarray) -> float:
    gaps = []
    for first, second in q:
        elbow = (theta[0] * cos(first), theta[0] * sin(first))
        angle = first + second
        tip = (elbow[0] + theta[1] * cos(angle), elbow[1] + theta[1] * sin(angle))
        gaps.append(shapely.LineString([(0, 0), elbow, tip]).distance(OBSTACLE))
    return min(gaps)


@pytest.mark.parametrize("theta", [(3.89, 2.92), (3.3, 4.0), (3.4, 2.9)])
def test_seeds_are_clear_where_there_are_such(theta: tuple[float, float]) -> None:
    seeds = planned_spec("planar_arm_body").seeds(np.array(theta))
    assert seeds
    gaps = [clearance(theta, seed.x[:, :2]) for seed in seeds]
    assert min(gaps) > 0
    assert gaps == sorted(gaps, reverse=True) or len(gaps) == 1
    for seed in seeds:
        assert seed.x.shape == (82, 4)
        assert np.all(seed.x[0, 2:] == 0)


def test_where_no_pose_is_clear_something_is_left_to_measure() -> None:
    seeds = planned_spec("planar_arm_body").seeds(np.array([2.23, 3.35]))
    assert 1 <= len(seeds) <= 2
    assert all(clearance((2.23, 3.35), seed.x[:, :2]) == 0 for seed in seeds)


def test_the_effector_alone_keeps_all_branches() -> None:
    own = planned_spec("planar_arm")
    assert not own.binds_bodies
    starts = [seed.x[0, :2] for seed in own.seeds(np.array([2.23, 3.35]))]
    assert {float(np.sign(np.sin(elbow))) for _, elbow in starts} == {-1.0, 1.0}
