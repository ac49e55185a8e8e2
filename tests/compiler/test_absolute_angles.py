"""Absolute angles: the same robot in other coordinates, q = D y."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from compiler.dynamics.equations_of_motion import robot_graph
from compiler.dynamics.kinematics import absolute_angles, own_coordinates
from compiler.robots.robot import WORLD, RobotModel
from tests.oracles.robots import Builder, evaluate, rod_chain

PULL = (Fraction(1, 3), Fraction("-9.81"))


def tree() -> RobotModel:
    """Two arms on one shoulder, a reversed elbow, a rigid turn and a slide in between."""
    builder = Builder()
    shoulder = builder.joint(WORLD)
    upper = builder.link(shoulder, builder.parameter())
    bent = builder.turn(upper, "z", builder.number(Fraction(1, 3)))
    elbow = builder.joint(bent, "-z")
    builder.effector(builder.link(elbow, builder.parameter()))
    slide = builder.joint(upper, "x", "prismatic")
    builder.point(slide, builder.number(2))
    builder.effector(builder.link(builder.joint(slide), builder.number(1)))
    return builder.build()


def spatial() -> RobotModel:
    """z, y, y in space: the last joint follows a coaxial one, the second does not."""
    builder = Builder(dimension=3)
    first = builder.link(builder.joint(WORLD, "z"), builder.parameter())
    second = builder.link(builder.joint(first, "y"), builder.number(1))
    builder.point(second, builder.number(1))
    third = builder.link(builder.joint(second, "-y"), builder.number(1))
    builder.point(builder.move(third, "y", builder.number(1)), builder.number(1))
    builder.effector(third)
    return builder.build()


def test_a_chain_is_measured_from_the_world() -> None:
    assert absolute_angles(rod_chain(3)).rows == ((1, 0, 0), (-1, 1, 0), (0, -1, 1))


def test_a_tree_and_a_reversed_joint() -> None:
    measured = absolute_angles(tree())
    assert measured.rows == ((1, 0, 0, 0), (1, -1, 0, 0), (0, 0, 1, 0), (-1, 0, 0, 1))
    assert measured.absolute == {0, 1, 3}


def test_only_coaxial_joints_lead_in_space() -> None:
    assert absolute_angles(spatial()).rows == ((1, 0, 0), (0, 1, 0), (0, 1, -1))


@pytest.mark.parametrize("model", [rod_chain(1), rod_chain(4), tree()], ids=["1", "4", "tree"])
def test_the_motion_is_the_same_in_the_plane(model: RobotModel) -> None:
    check_same_motion(model, PULL)


def test_the_motion_is_the_same_in_space() -> None:
    check_same_motion(spatial(), (*PULL, Fraction(2)))


def check_same_motion(model: RobotModel, pull: tuple[Fraction, ...]) -> None:
    """q = D y, so y'' has to satisfy q'' = D y'' for the same inputs, and points are the same."""
    own, measured = robot_graph(model, pull), absolute_angles(model)
    graph = robot_graph(model, pull, measured)
    rng = np.random.default_rng(0)
    n, d = len(model.dofs), np.array(measured.rows, dtype=float)
    theta = rng.uniform(0.5, 2, len(model.parameters))
    for _ in range(5):
        y, rates, u = (rng.uniform(-1, 1, n) for _ in range(3))
        q, v = d @ y, d @ rates
        wanted = evaluate(own, "acceleration", q, v, u, theta)
        found = evaluate(graph, "acceleration", y, rates, u, theta)
        np.testing.assert_allclose(d @ found, wanted, rtol=1e-9, atol=1e-9)
        mass = evaluate(own, "mass_matrix", q, theta)
        np.testing.assert_allclose(
            evaluate(graph, "mass_matrix", y, theta), d.T @ mass @ d, rtol=1e-9, atol=1e-9
        )
        for name in ("effectors", "body_points"):
            np.testing.assert_allclose(
                evaluate(graph, name, y, theta), evaluate(own, name, q, theta), atol=1e-12
            )


@pytest.mark.parametrize("model", [rod_chain(4), tree(), spatial()], ids=["chain", "tree", "space"])
def test_solving_for_y_is_exact(model: RobotModel) -> None:
    measured = absolute_angles(model)
    q = [Fraction(i + 1, 7) for i in range(len(model.dofs))]
    y = measured.solved_for(q)
    again = [sum(w * x for w, x in zip(row, y, strict=True)) for row in measured.rows]
    assert again == q


def test_own_coordinates_are_the_identity() -> None:
    assert own_coordinates(rod_chain(2)).rows == ((1, 0), (0, 1))
