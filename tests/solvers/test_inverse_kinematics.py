"""Inverse kinematics against the geometry of planar arms."""

from __future__ import annotations

import numpy as np
import pytest

from compiler.arrays import Array
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.robot import WORLD
from solvers.trajectory.inverse_kinematics import branches, solve_positions
from tests.oracles.robots import Builder, rod_chain

TWO = NumericRobot(robot_graph(rod_chain(2)))
THREE = NumericRobot(robot_graph(rod_chain(3)))
LENGTHS = np.array([1.0, 0.5])


def box(n: int, size: float = np.pi) -> tuple[Array, Array]:
    return np.full(n, -size), np.full(n, size)


def tip(q: Array, lengths: Array) -> Array:
    phi = np.cumsum(q, axis=-1)
    return np.stack([(lengths * np.cos(phi)).sum(-1), (lengths * np.sin(phi)).sum(-1)], axis=-1)


def elbows(target: Array, l1: float, l2: float) -> list[Array]:
    """Both solutions of the two-link arm by the law of cosines."""
    cosine = (target @ target - l1**2 - l2**2) / (2 * l1 * l2)
    found = []
    for q2 in (np.arccos(cosine), -np.arccos(cosine)):
        q1 = np.arctan2(*target[::-1]) - np.arctan2(l2 * np.sin(q2), l1 + l2 * np.cos(q2))
        found.append(np.array([q1, q2]))
    return found


def test_both_elbows_are_found() -> None:
    rng = np.random.default_rng(1)
    for seed in range(10):
        radius, angle = rng.uniform(0.6, 1.4), rng.uniform(-1, 1)
        target = radius * np.array([np.cos(angle), np.sin(angle)])
        found = branches(TWO, LENGTHS, 0, target, box(2), seed, 8)
        for expected in elbows(target, *LENGTHS):
            gaps = np.abs(np.angle(np.exp(1j * (found - expected)))).max(axis=1)
            assert gaps.min() < 1e-4
        np.testing.assert_allclose(tip(found[:2], LENGTHS), np.tile(target, (2, 1)), atol=1e-6)


def test_a_target_out_of_reach_is_approached() -> None:
    target = np.array([0.0, 2.0])
    q, gap = solve_positions(TWO, np.array([[0.3, 0.2]]), LENGTHS, 0, target[None], box(2))
    assert gap[0] == pytest.approx(0.5, abs=1e-4)
    np.testing.assert_allclose(tip(q, LENGTHS)[0], [0, 1.5], atol=1e-2)


def test_the_remaining_distance_is_that_of_the_answer() -> None:
    rng = np.random.default_rng(3)
    lengths = np.array([1.0, 0.8, 0.6])
    starts, targets = rng.uniform(-1, 1, (12, 3)), rng.uniform(-2.5, 2.5, (12, 2))
    limits = box(3, 1.2)
    q, gap = solve_positions(THREE, starts, lengths, 0, targets, limits)
    np.testing.assert_allclose(gap, np.linalg.norm(tip(q, lengths) - targets, axis=1), atol=1e-12)
    assert np.all(np.abs(q) <= 1.2)
    before = np.linalg.norm(tip(starts, lengths) - targets, axis=1)
    assert np.all(gap <= before + 1e-12)


def test_reachable_targets_are_reached() -> None:
    rng = np.random.default_rng(4)
    lengths = np.array([1.0, 0.8, 0.6])
    goal = rng.uniform(-1.2, 1.2, (20, 3))
    targets = tip(goal, lengths)
    near = goal + rng.uniform(-0.2, 0.2, goal.shape)
    _, gap = solve_positions(THREE, near, lengths, 0, targets, box(3))
    assert np.mean(gap < 1e-6) > 0.9


def test_branches_are_distinct_deterministic_and_bounded_in_number() -> None:
    lengths, target = np.array([1.0, 0.8, 0.6]), np.array([1.1, 0.9])
    found = branches(THREE, lengths, 0, target, box(3), 7, 5)
    np.testing.assert_array_equal(found, branches(THREE, lengths, 0, target, box(3), 7, 5))
    assert 1 < len(found) <= 5
    for i, a in enumerate(found):
        for b in found[:i]:
            assert np.abs(np.sin((a - b) / 2)).max() > 0.1
    distances = np.linalg.norm(tip(found, lengths) - target, axis=1)
    assert np.all(np.diff(np.round(distances, 6)) >= 0)


def test_other_points_than_the_effector() -> None:
    """Point 2 is the far end of the first rod: only the first joint moves it."""
    target = np.array([np.cos(0.7), np.sin(0.7)])
    q, gap = solve_positions(TWO, np.array([[0.1, 0.3]]), LENGTHS, 2, target[None], box(2))
    assert gap[0] < 1e-9
    assert q[0, 0] == pytest.approx(0.7)


def slider(low: float, high: float) -> tuple[NumericRobot, tuple[Array, Array]]:
    """A turret with a slide."""
    builder = Builder()
    slide = builder.joint(builder.joint(WORLD), "x", "prismatic")
    builder.effector(slide)
    limits = np.array([-np.pi, low]), np.array([np.pi, high])
    return NumericRobot(robot_graph(builder.build())), limits


def test_slides_start_within_their_range() -> None:
    """A range that holds no number between -pi and pi."""
    numeric, limits = slider(5.0, 10.0)
    target = 7.5 * np.array([np.cos(2.0), np.sin(2.0)])
    found = branches(numeric, np.zeros(0), 0, target, limits, 1, 4)
    np.testing.assert_allclose(found[0], [2.0, 7.5], atol=1e-6)
    assert np.all((found[:, 1] >= 5.0) & (found[:, 1] <= 10.0))


def test_angles_start_within_their_range() -> None:
    limits = np.array([3.6, 0.5]), np.array([4.4, 2.5])
    target = tip(np.array([4.0, 1.0]), LENGTHS)
    found = branches(TWO, LENGTHS, 0, target, limits, 1, 4)
    np.testing.assert_allclose(found[0], [4.0, 1.0], atol=1e-6)


def test_unlimited_coordinates() -> None:
    limits = np.full(2, -np.inf), np.full(2, np.inf)
    target = np.array([0.9, 0.7])
    found = branches(TWO, LENGTHS, 0, target, limits, 1, 4)
    np.testing.assert_allclose(tip(found[0], LENGTHS), target, atol=1e-6)


def test_slide_positions_a_turn_apart_are_two_branches() -> None:
    """Lengths do not repeat every 2 pi metres."""
    builder = Builder()
    slide = builder.joint(WORLD, "x", "prismatic")
    builder.effector(builder.move(builder.joint(slide), "x", builder.number(4)))
    numeric = NumericRobot(robot_graph(builder.build()))
    # The tip on the axis at x = 0 + 4 cos q: height h leaves two slides, 2 sqrt(16 - h^2) apart.
    height = np.sqrt(16 - np.pi**2)
    limits = np.array([-9.0, 0.0]), np.array([9.0, np.pi])
    found = branches(numeric, np.zeros(0), 0, np.array([0.0, height]), limits, 1, 6)
    slides = sorted(round(float(q[0]), 4) for q in found)
    assert slides[0] == pytest.approx(-np.pi, abs=1e-4)
    assert slides[-1] == pytest.approx(np.pi, abs=1e-4)


def test_tracking_follows_waypoints() -> None:
    """A circle that the two-link arm can follow, with one elbow all the way."""
    angle = np.linspace(0, 2 * np.pi, 60)
    path = np.array([0.9, 0.2]) + 0.25 * np.stack([np.cos(angle), np.sin(angle)], axis=1)
    first = elbows(path[0], *LENGTHS)[0]
    q = TWO.track(first, LENGTHS, 0, path, box(2))
    assert q.shape == (60, 2)
    np.testing.assert_array_equal(q[0], first)
    np.testing.assert_allclose(tip(q, LENGTHS), path, atol=1e-3)
    assert np.abs(np.diff(q, axis=0)).max() < 0.4
    assert np.all(q[:, 1] > 0)


def test_tracking_keeps_to_the_box() -> None:
    path = np.stack([np.linspace(1.4, 0.4, 30), np.linspace(0.0, 0.8, 30)], axis=1)
    limits = np.array([-0.2, 0.0]), np.array([0.6, 1.5])
    q = TWO.track(np.array([-0.1, 0.5]), LENGTHS, 0, path, limits)
    assert np.all(q >= limits[0] - 1e-12)
    assert np.all(q <= limits[1] + 1e-12)
