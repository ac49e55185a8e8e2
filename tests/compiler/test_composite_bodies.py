"""The mass matrix from composite bodies against point masses, and its enclosures."""

from __future__ import annotations

from fractions import Fraction

import casadi as ca
import numpy as np
import pytest

from compiler.dynamics.energy_graph import energy_graph
from compiler.dynamics.kinematics import kinematics, own_coordinates
from compiler.dynamics.rigid_bodies import angular_jacobian, inertia_of
from compiler.dynamics.symbolic_evaluator import SymbolicEvaluator
from compiler.expressions.evaluators.balls import BallEvaluator, ball, constant_ball
from compiler.expressions.evaluators.intervals import Ends, IntervalEvaluator, around
from compiler.expressions.tape import tape
from tests.oracles.driven_chains import Segment, problem, robot_of
from tests.oracles.driven_robots import driven
from tests.oracles.mass_points import energy, mass_points
from tests.oracles.mixed_robots import mixed_robot
from tests.oracles.random_robots import random_robot

PULLS = {2: (1, -9), 3: (1, 2, -9)}


def robots():
    for dimension in (2, 3):
        for joints in (1, 2, 3, 4):
            yield random_robot(joints, dimension, joints)
            yield mixed_robot(joints, dimension, joints, tree=True)


@pytest.mark.parametrize("model", list(robots()), ids=lambda m: f"{m.dimension}D-{len(m.dofs)}")
def test_energies_are_those_of_point_masses(model):
    graph = energy_graph(model, PULLS[model.dimension])
    rng = np.random.default_rng(len(model.dofs))
    n = len(model.dofs)
    q, v, theta = rng.uniform(-2, 2, n), rng.uniform(-2, 2, n), rng.uniform(0.5, 1, 30)
    theta = theta[: len(model.parameters)]
    inputs = [ball(Fraction(float(x))) for x in [*q, *theta]]
    inputs += [constant_ball(item) for item in graph.constants]
    mass = np.array([float(x) for x in graph.mass.evaluate(inputs, BallEvaluator())]).reshape(n, n)
    assert np.allclose(mass, mass.T, rtol=0, atol=0)
    height, *slope = (float(x) for x in graph.potential.evaluate(inputs, BallEvaluator()))
    cloud = mass_points(model, theta)
    assert v @ mass @ v / 2 + height == pytest.approx(
        energy(cloud, q, v, PULLS[model.dimension]), rel=1e-9, abs=1e-9
    )
    for i, entry in enumerate(slope):
        ahead, behind = q.copy(), q.copy()
        ahead[i] += 1e-5
        behind[i] -= 1e-5
        still = np.zeros(n)
        pull = PULLS[model.dimension]
        rise = energy(cloud, ahead, still, pull) - energy(cloud, behind, still, pull)
        assert entry == pytest.approx(rise / 2e-5, abs=1e-4)


ARM = problem(
    [Segment(1), Segment("[0.5, 0.7]"), Segment(0.4)], "[0, 1] x [0, 1]",
    "start at (0, 0, 0); reach T; effort <= 1 N*m; horizon 4 steps of 0.1 s;",
)  # fmt: skip


def test_enclosures_hold_all_values_and_are_the_narrower_ones():
    model, _, _ = robot_of(ARM)
    graph, (other, constants) = energy_graph(model, ()), _products_of_jacobians(model)
    assert graph.shape == (1, 2)
    box = [Ends(ball(Fraction(i, 8)), ball(Fraction(i + 1, 8))) for i in (1, 4, -3)]
    box.append(Ends(ball(Fraction(1, 2)), ball(Fraction(7, 10))))
    run = IntervalEvaluator()
    found = graph.mass.evaluate([*box, *map(_around, graph.constants)], run)
    natural = other.evaluate([*box, *map(_around, constants)], run)
    widths = [sum(float(x.high - x.low) for x in entries) for entries in (found, natural)]
    assert widths[0] < 0.7 * widths[1]
    rng = np.random.default_rng(1)
    for _ in range(50):
        values = [float(s.low) + rng.random() * float(s.high - s.low) for s in box]
        inputs = [ball(Fraction(x)) for x in values] + [constant_ball(c) for c in constants]
        for side, entry in zip(found, other.evaluate(inputs, BallEvaluator()), strict=True):
            assert side.ball().overlaps(entry)


def _products_of_jacobians(model):
    """M as the sum of J^T J by bodies, and its constants."""
    n, constants = len(model.dofs), SymbolicEvaluator()
    q, theta = ca.SX.sym("q", n), ca.SX.sym("theta", len(model.parameters))
    own = own_coordinates(model)
    at, total = kinematics(model, q, theta, constants, own), ca.SX.zeros(n, n)
    for body in model.bodies:
        mass, com, inertia = inertia_of(body, at, constants)
        linear = ca.jacobian(com, q)
        angular = angular_jacobian(model, at, body.frame, own)
        total += mass * linear.T @ linear + angular.T @ inertia @ angular
    function = ca.Function("products", [q, theta, constants.vector()], [ca.vec(total)])
    return tape(function), constants.symbols


def _around(constant):
    return around(constant_ball(constant))


FRICTIONS = [
    ("torque(q) = u - 0.3 N*m*s/rad * rate(q);", "3/10"),
    ("const b = 0.2 N*m*s/rad; torque(q) = -rate(q) * b + u;", "1/5"),
    ("torque(q) = u;", "0"),
    ("torque(q) = 2 * u;", None),
    ("torque(q) = u - 0.3 N*m * sin(q);", None),
    ("torque(q) = u - 0.3 N*m*s^2 * rate(q) * abs(rate(q));", None),
    ("torque(q) = u + 0.1 N*m;", None),
    ("input w in [-1, 1] N*m; torque(q) = w;", None),
]


@pytest.mark.parametrize(("own", "damping"), FRICTIONS)
def test_what_is_viscous_friction(own, damping):
    text = problem(
        [Segment(1, own=own), Segment(0.7)], "[0, 1] x [0, 1]",
        "start at (0, 0); reach T; effort <= 1 N*m; horizon 4 steps of 0.1 s;",
    )  # fmt: skip
    graph = energy_graph(robot_of(text)[0], ())
    if damping is None:
        assert graph.damping is None
        return
    inputs = [ball(0), ball(0), *map(constant_ball, graph.constants)]
    found = graph.damping.evaluate(inputs, BallEvaluator())
    assert found[0].overlaps(ball(Fraction(damping)))
    assert found[0].rad() < 1e-9
    assert found[1].is_zero()


def test_a_motor_and_friction_that_is_not_linear_are_not_viscous():
    assert energy_graph(driven(random_robot(2, 2, 2)), ()).damping is None
