"""Row 4.14: the published lengths, judged by the effector and by the whole arm."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from itertools import product
from pathlib import Path

import numpy as np
import shapely

from tests.oracles import result_files
from tests.oracles.planar_bodies import two_link_poses
from tests.oracles.two_rods import tip

LENGTHS = (2.23, 3.35)
OBSTACLE = shapely.box(1.7, 2, 3, 3)


def arms_in_the_target() -> Iterator[shapely.LineString]:
    """Both poses at each of many points of the target, by the law of cosines."""
    for point in product(np.linspace(3.5, 4.2, 29), np.linspace(3.8, 4.5, 29)):
        for first, turn in two_link_poses(*LENGTHS, *point):
            elbow = tip((LENGTHS[0], 0.0), first, 0.0)
            yield shapely.LineString([(0, 0), elbow, tip(LENGTHS, first, turn)])


def test_the_effector_gets_there_and_a_link_is_in_the_obstacle_each_time() -> None:
    arms = list(arms_in_the_target())
    assert len(arms) > 400
    assert all(shapely.Point(arm.coords[-1]).distance(OBSTACLE) > 0.9 for arm in arms)
    assert max(arm.distance(OBSTACLE) for arm in arms) == 0
    assert min(arm.intersection(OBSTACLE).length for arm in arms) > 0.2


def test_with_the_effector_a_design_is_found_and_with_the_body_none(
    made: Callable[[str], Path],
) -> None:
    for spec, verdict in (("planar_arm_paper", "found"), ("planar_arm_body_paper", "impossible")):
        design = result_files.read(made(spec) / "out", "design.json")
        assert design["verdict"] == verdict
