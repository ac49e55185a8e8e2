"""Clearances of many poses at once, against GEOS."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from grammar_lang import ir
from solvers.trajectory.body_clearance import ENOUGH, Avoidances, body_clearance
from tests.oracles.arms import ArmBuilder
from tests.oracles.planar_bodies import bodies_of, depth, random_polygon
from tests.oracles.planes import box
from tests.oracles.tasks import task


def arm() -> NumericRobot:
    """Two links, a bend and a slide; the free length is a parameter."""
    built = ArmBuilder().revolute()
    built.link(built.parameter(Fraction(1, 2), 2)).revolute()
    built.turn(built.degrees(30)).link(1).prismatic(0, (0, 1)).link("1/2").effector()
    return NumericRobot(robot_graph(built.model()))


@pytest.mark.parametrize("seed", range(6))
def test_the_least_distance_of_any_rod_from_any_obstacle(seed: int) -> None:
    rng = np.random.default_rng(seed)
    numeric, margin = arm(), 0.05 * seed
    polygons = [random_polygon(rng, rng.uniform(-2, 2, 2), 0.7) for _ in range(3)]
    regions = tuple(
        ir.Region(f"O{i}", "obstacle", ir.Inequalities(polygon.rows))
        for i, polygon in enumerate(polygons)
    )
    workspace = ir.Workspace("W", 2, box("bounds", "bounds", (-99, 99), (-99, 99)), regions)
    avoided = ir.Avoid(tuple(r.name for r in regions), "body", Fraction(margin))
    clearance = body_clearance(Avoidances(numeric, workspace, task(avoided)))
    q = rng.uniform((-3, -3, 0), (3, 3, 1), size=(60, 3))
    theta = np.array([0.8])
    found = clearance.of(numeric.points(q, theta).value)
    capped = clearance.of(numeric.points(q, theta).value, 0.1)
    assert np.allclose(capped, np.minimum(found, 0.1))
    for one, pose in zip(found, q, strict=True):
        bodies = bodies_of(numeric.graph.model, pose, theta)
        distance = min(depth(bodies, polygon.vertices) for polygon in polygons)
        if distance > 0:
            assert one == pytest.approx(min(distance - margin, ENOUGH), abs=1e-9)
        else:
            assert one < -margin + 1e-9
    assert np.any(found > 0)
    assert np.any(found < 0)


def test_bounds_bind_effectors_and_bodies_where_the_task_says_so() -> None:
    """The elbow of an arm of one and one metre is out by 0.2, the effector in by 0.4."""
    built = ArmBuilder().revolute().link(1).revolute().link(1).effector()
    numeric = NumericRobot(robot_graph(built.model()))
    workspace = ir.Workspace("W", 2, box("bounds", "bounds", (-1, "1.4"), ("-0.5", "0.8")), ())
    q = np.array([[np.pi / 2, -np.pi / 2], [0.0, 0.0]])
    positions = numeric.points(q, np.zeros(0)).value
    own = task()
    assert body_clearance(Avoidances(numeric, workspace, own)).of(positions) == pytest.approx(
        [-0.2, -0.6]
    )
    low = np.array([[np.pi / 2, -np.pi]])
    positions = numeric.points(low, np.zeros(0)).value
    bodies = replace(own, bounds_body=True)
    assert body_clearance(Avoidances(numeric, workspace, own)).of(positions) > 0
    assert body_clearance(Avoidances(numeric, workspace, bodies)).of(positions) == pytest.approx(
        [-0.2]
    )
