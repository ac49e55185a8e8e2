"""The mass matrix in absolute angles: the same as in the joints' own, and narrow over boxes."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest
from flint import arb

from compiler.dynamics.equations_of_motion import robot_graph
from compiler.dynamics.kinematics import absolute_angles, own_coordinates
from compiler.dynamics.rigid_bodies import coordinates_for_intervals, has_turned_columns
from compiler.expressions.evaluators.balls import (
    BallEvaluator,
    ball,
    constant_ball,
    working_precision,
)
from compiler.expressions.tape import tape
from compiler.robots.robot import WORLD
from tests.oracles.mixed_robots import mixed_robot
from tests.oracles.robots import Builder, evaluate, rod_chain


@pytest.mark.parametrize("seed", range(25))
def test_it_is_the_same_matrix(seed: int) -> None:
    """M_y = D' M_q D, with slides, rigid turns, reversed joints and branches."""
    model = mixed_robot(seed, 2, 1 + seed % 5, tree=bool(seed % 2))
    measured = absolute_angles(model)
    own, graph = robot_graph(model), robot_graph(model, (), measured)
    rows = np.array(measured.rows, dtype=float).reshape(len(model.dofs), -1)
    rng = np.random.default_rng(seed)
    theta = rng.uniform(0.3, 1.5, len(model.parameters))
    for _ in range(3):
        y = rng.uniform(-3, 3, len(model.dofs))
        expected = rows.T @ evaluate(own, "mass_matrix", rows @ y, theta) @ rows
        assert evaluate(graph, "mass_matrix", y, theta) == pytest.approx(expected, abs=1e-10)


def test_over_a_box_only_cosines_of_differences_are_wide() -> None:
    """C_ij cos(y_i - y_j): the diagonal is as it is, whatever the angles."""
    model = rod_chain(3)
    graph = robot_graph(model, (), absolute_angles(model))
    with working_precision(80):
        lengths = [ball(Fraction(13, 10)), ball(1), ball(Fraction(7, 10))]
        tail = [*lengths, *(constant_ball(constant) for constant in graph.constants)]
        wide = [arb("0.2", "0.5"), arb("0.4", "0.5"), arb("2", "0.5")]
        flat = tape(graph.mass_matrix).evaluate([*wide, *tail], BallEvaluator())
        apart = [(wide[0] - wide[1]).cos(), (wide[0] - wide[2]).cos(), (wide[1] - wide[2]).cos()]
    for i in range(3):
        assert float(flat[4 * i].rad()) < 1e-15
    for entry, cosine in zip((flat[3], flat[6], flat[7]), apart, strict=True):
        share = float(entry.rad()) / max(abs(float(entry.lower())), abs(float(entry.upper())))
        true = float(cosine.rad()) / max(abs(float(cosine.lower())), abs(float(cosine.upper())))
        assert share == pytest.approx(true, rel=1e-3)


def test_where_columns_are_turned_by_more_than_one_angle() -> None:
    """A coordinate that moves two frames, and one that is flipped, are left to plain products."""
    builder = Builder()
    upper = builder.link(builder.joint(WORLD), builder.number(1))
    flipped = builder.turn(upper, "x", builder.number(Fraction(1)))
    builder.effector(builder.link(builder.joint(flipped), builder.number(1)))
    model = builder.build()
    assert not has_turned_columns(model, absolute_angles(model))
    assert has_turned_columns(rod_chain(2), absolute_angles(rod_chain(2)))
    assert not has_turned_columns(mixed_robot(3, 3, 3), absolute_angles(mixed_robot(3, 3, 3)))


def test_intervals_lose_least_in_absolute_angles_where_columns_are_turned() -> None:
    chain, mixed = rod_chain(2), mixed_robot(3, 3, 3)
    assert coordinates_for_intervals(chain) == absolute_angles(chain)
    assert coordinates_for_intervals(mixed) == own_coordinates(mixed)
