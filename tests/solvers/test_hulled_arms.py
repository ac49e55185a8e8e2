"""Robots of hulls: what the graph, a search, refutations and proofs say of their corners."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
from flint import arb

from compiler.discretisation.hull_distance import nearest_to_zero
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.discretisation.spanning_points import MOST_DIFFERENCES
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.dynamics.kinematics import absolute_angles
from compiler.expressions.evaluators.balls import BALLS, constant_ball
from compiler.expressions.tape import tape
from compiler.unreachability.enclosed_points import PointTapes
from compiler.unreachability.motion_conditions import body_points
from grammar_lang import ir
from solvers.trajectory.linear_model import bends
from solvers.verifier.proofs.end_conditions import at_instant
from solvers.verifier.proofs.instant_conditions import position_conditions
from solvers.verifier.proofs.scene import Scene
from tests.oracles.hulled_arms import corners_of, hull_gap, hulled_arm


def poses(seed: int, dofs: int, count: int) -> np.ndarray:
    return np.random.default_rng(100 + seed).uniform(-np.pi, np.pi, (count, dofs))


@pytest.mark.parametrize("seed", [0, 1, 2, 3, 4, 5, 7, 8])
def test_corners_and_distances_in_a_search(seed: int) -> None:
    model = hulled_arm(seed)
    numeric, first = NumericRobot(robot_graph(model)), len(model.effectors)
    q = poses(seed, len(model.dofs), 12)
    points, many = numeric.positions(q, np.zeros(0)), 0
    for pose, found in zip(q, points, strict=True):
        true = corners_of(model, pose)
        for corners, hull in zip(true, numeric.spanning.hulls, strict=True):
            assert found[[first + i for i in hull]] == pytest.approx(corners, abs=1e-12)
        for (one, two), gap in zip(model.apart, numeric.spanning.gaps, strict=True):
            total = len(true[one]) * len(true[two])
            many += total > MOST_DIFFERENCES
            assert len(gap) == (16 if total > MOST_DIFFERENCES else total)
            moving = found[[first + i for i in gap]]
            true_gap = hull_gap(true[one], true[two])
            ours = float(np.linalg.norm(nearest_to_zero(moving[None])))
            assert ours >= true_gap - 1e-6
            extents = [np.ptp(true[i], axis=0).max() for i in (one, two)]
            if true_gap < 0.5 * max(extents):
                assert ours == pytest.approx(true_gap, abs=1e-6)
    assert many


def differences(model: Any, pair: tuple[int, int], q: np.ndarray) -> np.ndarray:
    one, two = (corners_of(model, q)[i] for i in pair)
    return (one[:, None] - two[None]).reshape(-1, one.shape[1])


def seen(value: np.ndarray, model: Any, pair: tuple[int, int], q: np.ndarray) -> np.ndarray:
    """Which difference (in world axes, up to a turn of both bodies) a point is, by its length."""
    lengths = np.linalg.norm(differences(model, pair, q), axis=1)
    return np.abs(np.linalg.norm(value, axis=1)[:, None] - lengths).argmin(axis=1)


@pytest.mark.parametrize("seed", range(6))
def test_derivatives_of_what_is_chosen_are_those_of_the_same_difference(seed: int) -> None:
    """By how lengths of differences change: these are the same wherever they are seen from."""
    model = hulled_arm(seed)
    numeric, first = NumericRobot(robot_graph(model)), len(model.effectors)
    q = poses(seed, len(model.dofs), 2)
    found, step = numeric.points(q, np.zeros(0)), 1e-6
    assert (found.value == numeric.positions(q, np.zeros(0))).all()
    compared = 0
    for pair, gap in zip(model.apart, numeric.spanning.gaps, strict=True):
        places = [first + i for i in gap]
        for pose in range(2):
            value = found.value[pose, places]
            number = seen(value, model, pair, q[pose])
            slopes = np.einsum("md,mdn->mn", value, found.by_q[pose, places])
            for dof in range(numeric.n):
                move = step * np.eye(numeric.n)[dof]
                ahead, behind = (
                    np.sum(differences(model, pair, q[pose] + sign * move)[number] ** 2, axis=1) / 2
                    for sign in (1, -1)
                )
                assert slopes[:, dof] == pytest.approx((ahead - behind) / (2 * step), abs=1e-6)
                compared += len(number)
    assert compared > 100


@pytest.mark.parametrize("seed", [1, 3, 5])
def test_bends_of_what_is_chosen(seed: int) -> None:
    """In the plane with absolute angles differences are seen in the axes of the world."""
    model = hulled_arm(seed)
    numeric, first = NumericRobot(robot_graph(model, (), absolute_angles(model))), 1
    rng = np.random.default_rng(seed)
    turn = np.array(numeric.graph.coordinates.rows, float)
    y, rates, dt, step = rng.normal(size=(2, numeric.n)), rng.normal(size=(2, numeric.n)), 0.1, 1e-6
    found = numeric.points(y, np.zeros(0))
    bent = bends(found, rates, dt)[0]
    chosen = 0
    for pair, gap in zip(model.apart, numeric.spanning.gaps, strict=True):
        places = [first + i for i in gap]
        at = differences(model, pair, turn @ y[0])
        away = np.linalg.norm(found.value[0, places][:, None] - at[None], axis=2)
        number = away.argmin(axis=1)
        assert away.min(axis=1) == pytest.approx(0, abs=1e-12)
        velocities = [
            (differences(model, pair, turn @ (a + step * b))
             - differences(model, pair, turn @ (a - step * b)))[number] / (2 * step)
            for a, b in zip(y, rates, strict=True)
        ]  # fmt: skip
        expected = dt / 8 * (velocities[0] - velocities[1])
        assert bent[places] == pytest.approx(expected, abs=1e-8)
        chosen += len(gap) == 16
    assert chosen


@pytest.mark.parametrize("seed", range(6))
def test_refutations_speak_of_the_corners(seed: int) -> None:
    model = hulled_arm(seed)
    q = poses(seed, len(model.dofs), 5)
    found = PointTapes(model).near(q, np.zeros(0))
    hulls = body_points(model)
    for pose, places in zip(q, found, strict=True):
        for corners, hull in zip(corners_of(model, pose), hulls, strict=True):
            assert places[list(hull)] == pytest.approx(corners, abs=1e-12)


def conditions(model: Any, margin: Fraction, q: np.ndarray) -> list[tuple[Any, Any, Any]]:
    """What a verifier says of each pair in a pose: the condition and its bound, and the instant."""
    graph = robot_graph(model)
    half = ir.HalfSpace((Fraction(1),) + (Fraction(0),) * (model.dimension - 1), Fraction(100))
    task = SimpleNamespace(bounds_body=True, avoid=(), avoid_self=SimpleNamespace(margin=margin))
    workspace = SimpleNamespace(
        bounds=SimpleNamespace(shape=ir.Inequalities((half,))), dimension=model.dimension
    )
    scene = Scene(graph, cast(Any, workspace), cast(Any, task), cast(Any, None))
    tail = [constant_ball(item) for item in graph.constants]
    flat = tape(graph.points).evaluate([*(arb(float(x)) for x in q), *tail], BALLS)
    d = model.dimension
    over = at_instant([flat[i : i + d] for i in range(0, len(flat), d)], 0.0)
    made = position_conditions(scene, tail)
    return [(each, each.bound(over)[0], over) for each in made]


@pytest.mark.parametrize("seed", range(10))
def test_proofs_are_of_true_distances(seed: int) -> None:
    model, shown = hulled_arm(seed), 0
    for q in poses(seed, len(model.dofs), 3):
        true = corners_of(model, q)
        found = conditions(model, Fraction(0), q)
        walls = found[1 : 1 + len(true)]
        for corners, (_, bound, _) in zip(true, walls, strict=True):
            assert float(bound) == pytest.approx(100 - corners[:, 0].max(), abs=1e-9)
        for (one, two), (condition, bound, over) in zip(
            model.apart, found[1 + len(true) :], strict=True
        ):
            gap = hull_gap(true[one], true[two])
            assert float(bound) <= gap + 1e-7
            if gap > 1e-5:
                shown += 1
                assert float(bound) == pytest.approx(gap, abs=1e-6)
                assert not condition.violated(over)
                place = np.array([condition.where(over)])
                assert hull_gap(true[one], place) < 1e-6
                assert hull_gap(true[two], place) == pytest.approx(gap, abs=1e-5)
    assert shown > 10


def test_a_hull_has_few_points_however_many_corners() -> None:
    """Four vectors of each, seven of a pair."""
    for corners in (6, 32):
        model = hulled_arm(2, corners)
        graph = robot_graph(replace(model, effectors=()))
        entries = graph.points.size1_out(0)
        assert entries == 3 * (4 * len(model.shapes) + 7 * len(model.apart))
