"""What the animation shows, against the trajectory and the spec of the result."""

from __future__ import annotations

import re
from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from srgc.render.workspace_drawing import shape_marks
from srgc.report.animation import show_speeds
from srgc.report.evidence import Evidence
from srgc.report.motion_data import GRID, scene_data
from srgc.report.motion_scene import (
    MOST_NUMBERS,
    RobotMotion,
    motion_scene,
    robot_motion,
    seen_corners,
)
from srgc.report.tables import Trajectory

On = Callable[[str], Evidence]


def motion_of(evidence: Evidence) -> RobotMotion:
    motion = motion_scene(evidence).motion
    assert motion is not None
    return motion


@pytest.mark.parametrize("spec", ["planar_arm", "spatial", "slider", "turner", "motor"])
def test_effectors_are_where_the_trajectory_says(evidence_on: On, spec: str) -> None:
    evidence = evidence_on(spec)
    motion, trajectory = motion_of(evidence), evidence.trajectory
    assert trajectory is not None
    for time, places in zip(trajectory.t, trajectory.effectors, strict=True):
        index = int(np.abs(motion.times - time).argmin())
        assert motion.times[index] == pytest.approx(time)
        assert np.allclose(motion.tips[index], places, atol=1e-9)


def test_rods_of_the_arm_are_as_long_as_its_links(evidence_on: On) -> None:
    evidence = evidence_on("planar_arm")
    assert evidence.found is not None
    motion = motion_of(evidence)
    for rod, length in zip(motion.robot.rods, evidence.found.theta, strict=True):
        ends = motion.points[:, rod.ends[1]] - motion.points[:, rod.ends[0]]
        assert np.allclose(np.linalg.norm(ends, axis=1), float(length))
        assert rod.radius is None


def test_joints_of_space_have_their_axes(evidence_on: On) -> None:
    """The first turns about z at the height of the base, the second about y behind a bend."""
    motion = motion_of(evidence_on("spatial"))
    first, second = motion.robot.joints
    assert first.tip is not None
    assert second.tip is not None
    assert np.allclose(motion.points[:, first.point], [0, 0, 0.3])
    assert np.allclose(motion.points[:, first.tip], [0, 0, 1.3])
    axis = motion.points[:, second.tip] - motion.points[:, second.point]
    q1, bend = motion.q[:, 0], np.radians(30)
    y = np.stack([-np.sin(q1) * np.cos(bend), np.cos(q1) * np.cos(bend), np.full_like(q1, 0.5)], 1)
    assert np.allclose(axis, y)


def test_bodies_of_space_are_at_their_centres_of_mass(evidence_on: On) -> None:
    """The first link's is in its middle: halfway between the joints."""
    evidence = evidence_on("spatial")
    motion = motion_of(evidence)
    first, second = (motion.points[:, joint.point] for joint in motion.robot.joints)
    assert np.allclose(motion.points[:, motion.robot.masses[0].point], (first + second) / 2)
    assert [mass.solid for mass in motion.robot.masses] == [True, True, False]
    assert np.allclose(motion.points[:, motion.robot.masses[2].point], motion.tips[:, 0])


@pytest.mark.parametrize("spec", ["planar_arm", "spatial", "turner"])
def test_boxes_of_the_tube_hold_the_effector_throughout(evidence_on: On, spec: str) -> None:
    motion = motion_of(evidence_on(spec))
    tube = motion.tube
    assert tube is not None
    assert tube.times[0] == 0
    assert tube.times[-1] == pytest.approx(motion.times[-1])
    for (begin, end), boxes in zip(pairwise(tube.times), tube.boxes, strict=True):
        inside = (motion.times >= begin) & (motion.times <= end)
        for tips in motion.tips[inside]:
            # Between samples the drawn motion is a cubic, not the motion itself.
            assert (tips > boxes[..., 0] - 1e-3).all()
            assert (tips < boxes[..., 1] + 1e-3).all()
    assert (tube.half_widths >= 0).all()
    assert tube.half_widths.max() < 1e-3


def test_data_are_the_points_on_a_fine_grid(evidence_on: On) -> None:
    scene = motion_scene(evidence_on("planar_arm"))
    data = scene_data(scene)
    assert scene.motion is not None
    points = np.array(data["motion"]["points"]).reshape(scene.motion.points.shape)
    near = points * data["unit"] + scene.view.centre
    assert np.abs(near - scene.motion.points).max() <= data["unit"] * 0.501
    assert data["unit"] * scene.view.scale == pytest.approx(GRID)
    low = np.array(data["motion"]["tube"]["low"]) * data["unit"]
    assert scene.motion.tube is not None
    boxes = scene.motion.tube.boxes[..., 0].reshape(len(low), -1) - scene.view.centre
    assert (low <= boxes + 1e-12).all()


def test_long_motion_stays_small(evidence_on: On) -> None:
    """The same robot over 2000 steps."""
    evidence = evidence_on("planar_arm")
    assert evidence.found is not None
    assert evidence.trajectory is not None
    t = np.linspace(0, 60, 2001)
    q = np.stack([np.sin(t), np.cos(3 * t)], axis=1)
    qd = np.stack([np.cos(t), -3 * np.sin(3 * t)], axis=1)
    blank = np.zeros((2001, 0))
    long = Trajectory(t, q, qd, blank, np.zeros((2000, 2)), np.zeros((2001, 1, 2)))
    found = evidence.found
    claim = replace(found.claim, path=(("S",) * 2001,))
    motion = robot_motion(replace(found, claim=claim), long)
    assert motion.points.size <= MOST_NUMBERS
    assert motion.steps == 2000
    assert motion.times[-1] == 60


def test_visits_are_the_path_of_the_certificate(evidence_on: On) -> None:
    evidence = evidence_on("planar_arm")
    assert evidence.found is not None
    (visits,) = motion_of(evidence).visits
    (path,) = evidence.found.claim.path
    again = []
    for visit, following in pairwise([*visits, None]):
        assert visit is not None
        end = len(path) if following is None else following.since
        again += [visit.cell] * (end - visit.since)
    assert tuple(again) == path


def test_without_a_robot_there_are_the_sets_alone(evidence_on: On) -> None:
    scene = motion_scene(evidence_on("beyond_reach"))
    assert scene.motion is None
    kinds = [shape.kind for shape in scene.shapes]
    assert kinds[0] == "bounds"
    assert {"cell", "target", "region"} <= {*kinds}
    assert "motion" not in scene_data(scene)


def test_edges_of_a_box_of_space(evidence_on: On) -> None:
    (post,) = [s for s in motion_scene(evidence_on("spatial")).shapes if s.kind == "obstacle"]
    assert len(post.corners) == 8
    assert len(post.edges) == 12
    for a, b in post.edges:
        assert (post.corners[a] != post.corners[b]).sum() == 1


def test_bounds_are_whole_unless_they_are_vast(evidence_on: On) -> None:
    """A workspace is seen to its edges; where it is far larger than what is in it, that is said."""
    evidence = evidence_on("turner")
    scene = motion_scene(evidence)
    assert not scene.beyond
    vast = replace(scene.shapes[0], corners=20 * scene.shapes[0].corners)
    assert replace(scene, shapes=(vast, *scene.shapes[1:])).beyond
    points = np.array([[-0.2, -0.2], [1.4, 1.4]])
    bounds = np.array([[-3.0, -3], [3, -3], [3, 3], [-3, 3]])
    shapes = [
        replace(vast, corners=bounds),
        replace(vast, kind="region", corners=points),
    ]
    corners = np.concatenate(seen_corners(shapes, None))
    assert corners.min() == -3
    assert corners.max() == 3


def test_short_motions_keep_their_times(evidence_on: On) -> None:
    """A motion of microseconds: neither its times nor its way may be rounded away."""
    scene = motion_scene(evidence_on("slider"))
    assert scene.motion is not None
    tiny = replace(scene.motion, times=1e-6 * scene.motion.times, q=1e-6 * scene.motion.q)
    data = scene_data(replace(scene, motion=tiny))["motion"]
    np.testing.assert_allclose(data["times"], tiny.times, rtol=1e-6)
    np.testing.assert_allclose(data["q"], tiny.q, rtol=1e-6)


@pytest.mark.parametrize("total", [2e-6, 3e-4, 0.4, 2, 30, 100, 7200, 1e6])
def test_some_speed_shows_a_motion_in_seconds(total: float) -> None:
    choice = show_speeds(total)
    assert choice == sorted(choice)
    assert any(1 <= total / speed <= 20 for speed in choice)


def test_a_map_of_thousands_of_pieces_is_one_mark(evidence_on: On) -> None:
    """As many octagons as a map may have: well below the size that a page may have."""
    scene = motion_scene(evidence_on("turner"))
    (obstacle,) = [shape for shape in scene.shapes if shape.kind == "obstacle"]
    turns = np.linspace(0, 2 * np.pi, 8, endpoint=False)
    octagon = 0.01 * np.stack([np.cos(turns), np.sin(turns)], axis=1)
    pieces = [
        replace(obstacle, name=f"map.{i + 1}", label="" if i else "map", corners=octagon + at)
        for i, at in enumerate(np.random.default_rng(1).uniform(-1, 3, (5000, 2)))
    ]
    marks = shape_marks([*scene.shapes, *pieces], scene.view)
    assert marks.count("<title>map</title>") == 1
    assert marks.count("Z") == len(scene.shapes) + len(pieces)
    (paths,) = re.findall('<title>map</title><path class="face" d="([^"]*)"', marks)
    for path, piece in zip(paths.split("Z"), pieces, strict=False):
        at, steps = path.removeprefix("M").split("l")
        moves = [at.split(), *re.findall(r"(-?[\d.]+) ?(-?[\d.]+)", steps)]
        corners = np.cumsum(np.array(moves, dtype=float), axis=0)
        expected = scene.view.project(piece.corners)
        apart = np.linalg.norm(corners[:, None] - expected[None], axis=-1)
        assert apart.min(axis=0).max() < 0.08
        assert apart.min(axis=1).max() < 0.08
    assert len(marks) < 350_000
