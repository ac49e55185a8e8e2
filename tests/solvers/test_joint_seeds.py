"""Ways in joint space and seeds from them, against shapely and the kinematics of an arm by hand."""

from __future__ import annotations

import itertools
from dataclasses import replace
from math import cos, sin, sqrt
from pathlib import Path

import numpy as np
import pytest
import shapely

from solvers.trajectory.body_clearance import BodyClearance
from solvers.trajectory.convex_set import ConvexSet, region_set
from solvers.trajectory.joint_seeds import joint_seeds, stops_of
from solvers.trajectory.joint_ways import ClearSpace, joint_way
from solvers.trajectory.path_following import PathProblem
from solvers.trajectory.position_plan import Dwell
from tests.oracles.planned_arm import planned_spec
from tests.solvers.test_path_following import path_problem
from tests.solvers.test_seeds_of_bodies import OBSTACLE, clearance

THETA = np.array([2.3, 3.1])
"""Too short a first link to pass above the obstacle, which lies 1.7 to 3 m away."""


@pytest.fixture(scope="module")
def problem() -> PathProblem:
    return replace(planned_spec("planar_arm_body"), in_joints=True)


@pytest.fixture(scope="module")
def space(problem: PathProblem) -> ClearSpace:
    corridor = problem.corridor(THETA)
    box = np.full(2, -np.pi), np.full(2, np.pi)
    return ClearSpace(
        problem.numeric, THETA, corridor.clearance, box, corridor.levers, 5.4, problem.margin
    )


def outline(q: np.ndarray) -> shapely.LineString:
    elbow = np.array([THETA[0] * cos(q[0]), THETA[0] * sin(q[0])])
    tip = elbow + THETA[1] * np.array([cos(q[0] + q[1]), sin(q[0] + q[1])])
    return shapely.LineString([(0, 0), elbow, tip])


def poses(problem: PathProblem, rng: np.random.Generator) -> np.ndarray:
    """Within the bounds and clear by far, by shapely."""
    bounds = region_set(problem.workspace.bounds.shape, 2)
    while True:
        q = rng.uniform(-np.pi, np.pi, 2)
        line = outline(q)
        tip = np.array(line.coords[-1])
        inside = np.all(bounds.normals @ tip < bounds.offsets - 0.05)
        if inside and line.distance(OBSTACLE) > 0.05:
            return q


@pytest.mark.parametrize("seed", range(12))
def test_a_way_is_clear_and_joins_its_ends(
    problem: PathProblem, space: ClearSpace, seed: int
) -> None:
    rng = np.random.default_rng(seed)
    start, end = poses(problem, rng), poses(problem, rng)
    way = joint_way(space, start, end, 0)
    if way is None:
        return
    assert np.array_equal(way[0], start)
    assert np.array_equal(way[-1], end)
    fine = [a + s * (b - a) for a, b in itertools.pairwise(way)
            for s in np.linspace(0, 1, 200)]  # fmt: skip
    assert min(outline(q).distance(OBSTACLE) for q in fine) > -1e-9
    again = joint_way(space, start, end, 0)
    assert again is not None
    assert np.array_equal(way, again)


def test_ways_around_an_obstacle_are_found(problem: PathProblem, space: ClearSpace) -> None:
    rng, found, blocked = np.random.default_rng(0), 0, 0
    while blocked < 12:
        start, end = poses(problem, rng), poses(problem, rng)
        straight = [outline(start + s * (end - start)) for s in np.linspace(0, 1, 400)]
        if min(line.distance(OBSTACLE) for line in straight) == 0:
            blocked += 1
            found += joint_way(space, start, end, 0) is not None
    assert found >= 4


def test_stops_are_where_dwells_begin_and_end() -> None:
    problem = planned_spec("planar_arm_body")
    first, second = (region_set(r.shape, 2) for r in problem.workspace.regions[:2])
    dwells = [Dwell(0, 0, 0, first), Dwell(0, 0, 20, second), Dwell(1, 4, 9, second),
              Dwell(0, 9, 9, first)]  # fmt: skip
    stops = stops_of(dwells, 20)
    assert [stop.sample for stop in stops] == [0, 4, 9, 20]
    assert [[point for point, _ in stop.aims] for stop in stops] == [[0], [1], [1, 0], []]


@pytest.mark.parametrize("theta", [(3.3, 4.0), (3.9, 2.9)])
def test_seeds_stop_where_points_are_bound_and_are_clear(
    problem: PathProblem, theta: tuple[float, float]
) -> None:
    found = problem.seeds(np.array(theta))
    assert found
    steps = problem.task.steps
    for seed in found:
        q = seed.x[:, :2]
        assert q.shape == (steps + 1, 2)
        for pose, name in ((q[0], "S"), (q[-1], "T")):
            region = region_set(problem.workspace.region(name).shape, 2)
            elbow = theta[0] * np.array([cos(pose[0]), sin(pose[0])])
            tip = elbow + theta[1] * np.array([cos(pose.sum()), sin(pose.sum())])
            assert np.all(region.normals @ tip < region.offsets)
        assert np.abs(np.diff(q, axis=0)).max() < 0.35
        assert np.abs(q[1] - q[0]).max() < np.abs(np.diff(q, axis=0)).max()
        # Samples only: a chord may cut a corner by a little.
        assert clearance(theta, q) > 0


def test_no_pose_at_a_stop_means_no_seed(problem: PathProblem, space: ClearSpace) -> None:
    drawn = problem.corridor(THETA).drawn(np.random.default_rng(0))
    far = region_set(problem.workspace.region("S").shape, 2)
    far = replace(far, offsets=far.offsets + far.normals @ np.array([50.0, 0.0]),
                  vertices=far.vertices + np.array([50.0, 0.0]))  # fmt: skip
    stops = stops_of([Dwell(0, 0, 0, far)], 10)
    assert joint_seeds(space, stops, drawn, None, 4, 0) == []


@pytest.mark.parametrize(("turned", "middle"), [(0.3, 5.6), (2.0, 5.5), (-2.5, 5.65)])
def test_a_set_is_reached_whose_middle_is_too_far(
    problem: PathProblem, space: ClearSpace, turned: float, middle: float
) -> None:
    """The arm is 5.4 m long; a tilted square of 1 m across begins before that."""
    drawn = problem.corridor(THETA).drawn(np.random.default_rng(0))
    towards = np.array([cos(turned), sin(turned)])
    corners = [
        middle * towards
        + 0.5 * np.array([cos(turned + k * np.pi / 2), sin(turned + k * np.pi / 2)])
        for k in range(4)
    ]
    sides = [turned + np.pi / 4 + k * np.pi / 2 for k in range(4)]
    normals = np.array([[cos(side), sin(side)] for side in sides])
    place = ConvexSet(normals, normals @ (middle * towards) + 0.5 / sqrt(2), np.array(corners))
    anywhere = replace(space, clearance=BodyClearance((), ()))
    stops = stops_of([Dwell(0, 4, 4, place)], 4)
    found = joint_seeds(anywhere, stops, drawn, None, 4, 0, to_edges=True)
    assert found
    for q in found:
        tip = np.array(outline(q[-1]).coords[-1])
        assert np.all(normals @ tip <= place.offsets)


@pytest.mark.parametrize("length", [1.3, 1.55, 1.8])
def test_one_joint_reaches_a_region_though_hardly_any_place_in_it(
    tmp_path: Path, length: float
) -> None:
    """The tip is on a circle, which meets every set from whose points it has to be chosen."""
    turner = path_problem(tmp_path)
    found = turner.joint_ways(np.array([length]), straight=True)
    assert found
    for q in found:
        x, y = length * cos(q[0, 0]), length * sin(q[0, 0])
        assert 1.2 <= x <= 1.9
        assert -0.3 <= y <= 0.3
