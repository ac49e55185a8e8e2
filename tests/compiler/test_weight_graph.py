"""The weight at the joints by the place of an effector, against point masses and by hand."""

from __future__ import annotations

from math import cos, sin

import numpy as np
import pytest
from flint import arb

from compiler.arrays import Array
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.dynamics.weight_graph import weight_graph
from compiler.expressions.evaluators.balls import BallEvaluator, constant_ball
from compiler.robots.robot import RobotModel
from tests.compiler.test_composite_bodies import PULLS, robots
from tests.oracles.driven_chains import robot_of
from tests.oracles.mass_points import energy, mass_points

ARM = """
module B { role base; port out: P; frame out = in; }
module L {
  role link;
  dof q: KIND;
  param length in [0.4, 0.7] m;
  port in: P; port out: P;
  frame joint = in * STEP;
  frame out = joint * move(x, length);
  rod(frame: joint, axis: x, length: length, density: 1.5 kg/m);
}
module H {
  role effector; port in: P;
  frame wrist = in * rot(z, 90 deg);
  frame tip = wrist * move((0.2, 0.1) m);
  point(frame: wrist, mass: 0.3 kg);
  solid(frame: in, mass: 0.4 kg, com: (0.1, 0.05) m, inertia: 0.01 kg*m^2);
  point(frame: wrist * move(x, 0.5 m), mass: 0.2 kg);
  effector(frame: tip);
}
grammar G from ports { start B; with L, H; accept count(L) == 2; }
workspace W { plane xy; bounds box [-2, 2] x [-2, 2] m; target T box [1, 2] x [0, 1] m; }
task P { robot G; workspace W; start at (0, 0); reach T; payload 2 kg; effort <= 5 N*m;
  effort <= 5 N; horizon 1 steps of 1 s; }
"""
TURNING = ARM.replace("KIND", "revolute z in [-150, 150] deg").replace("STEP", "rot(z, q)")
SLIDING = ARM.replace("KIND", "prismatic y in [-1, 1] m").replace("STEP", "move(y, q)")


def pulls(
    model: RobotModel, gravity: tuple[int, ...], effector: int, values: Array, place: Array
) -> Array:
    """The weights (n,) at coordinates and parameters for an effector at a place (d,)."""
    graph = weight_graph(model, gravity, effector)
    constants = [constant_ball(item) for item in graph.constants]
    inputs = [*map(arb, values.tolist()), *constants, *map(arb, place.tolist())]
    return np.array([float(x) for x in graph.pull.evaluate(inputs, BallEvaluator())])


@pytest.mark.parametrize("model", list(robots()), ids=lambda m: f"{m.dimension}D-{len(m.dofs)}")
def test_where_the_effector_is_the_weights_are_those_of_point_masses(model):
    rng, n = np.random.default_rng(len(model.dofs)), len(model.dofs)
    q, theta = rng.uniform(-2, 2, n), rng.uniform(0.5, 1, len(model.parameters))
    graph, pull = robot_graph(model, PULLS[model.dimension]), PULLS[model.dimension]
    constants = [float(constant_ball(item)) for item in graph.constants]
    own = np.linalg.solve(graph.coordinates.rows, q)
    places = np.array(graph.effectors(own, theta, constants)).reshape(-1, model.dimension)
    cloud, still = mass_points(model, theta), np.zeros(n)
    for effector, place in enumerate(places):
        found = pulls(model, pull, effector, np.array([*q, *theta]), place)
        for i, entry in enumerate(found):
            step = 1e-5 * np.eye(n)[i]
            rise = energy(cloud, q + step, still, pull) - energy(cloud, q - step, still, pull)
            assert entry == pytest.approx(rise / 2e-5, abs=1e-4)


def test_the_place_counts_by_what_is_fixed_to_it():
    """Joints at the origin and at the elbow; the tip may be somewhere else than there."""
    model, _, _ = robot_of(TURNING)
    (one, two), lengths, g = (0.4, 0.9), (0.5, 0.6), 9.81
    elbow = lengths[0] * cos(one)
    hand = one + two + np.pi / 2  # the direction of the wrist
    across = 0.2 * cos(hand) - 0.1 * sin(hand)  # from the wrist to the tip, along x
    # The payload at the tip, a mass at the wrist, the solid, a mass before the wrist, the forearm.
    masses = [2.0, 0.3, 0.4, 0.2, 1.5 * lengths[1]]
    ways = [
        0.0,
        -across,
        -across + 0.1 * cos(one + two) - 0.05 * sin(one + two),
        -across + 0.5 * cos(hand),
        -across - lengths[1] / 2 * cos(one + two),
    ]
    for x in (0.3, 1.7):
        forearm = sum(m * (x + way - elbow) for m, way in zip(masses, ways, strict=True))
        upper = 1.5 * lengths[0] * elbow / 2 + sum(masses) * elbow
        values = np.array([one, two, *lengths])
        found = pulls(model, (0, -g), 0, values, np.array([x, 0.7]))
        assert found == pytest.approx([g * (upper + forearm), g * forearm], rel=1e-12)


def test_slides_carry_the_same_weight_wherever_the_effector_is():
    model, _, _ = robot_of(SLIDING)
    values = np.array([0.1, 0.2, 0.5, 0.6])
    for place in ((0.0, 0.0), (3.0, -4.0)):
        found = pulls(model, (0, -10), 0, values, np.array(place))
        last = 10 * (2.9 + 1.5 * 0.6)
        assert found == pytest.approx([last + 10 * 1.5 * 0.5, last], rel=1e-12)
