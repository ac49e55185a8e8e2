from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from compiler.dynamics.equations_of_motion import robot_graph
from compiler.expressions.evaluators.balls import working_precision
from compiler.unreachability.box_tree import Part, coordinate_sides, enclosures, parameter_sides
from compiler.unreachability.enclosed_points import PointTapes, ball_row
from compiler.unreachability.motion_conditions import body_points
from tests.oracles import random_robots
from tests.oracles.arms import ArmBuilder, frames_of, scalar_values
from tests.oracles.planes import row
from tests.oracles.questions import random_robot
from tests.oracles.robots import constants_of
from tests.oracles.some_cases import some


def random_part(rng, side, most):
    part = Part()
    for _ in range(int(rng.integers(0, most + 1))):
        if hasattr(side, "chosen"):
            first, last = side.chosen(part)
            if last - first < 2:
                break
        part = part.halves()[int(rng.integers(2))]
    return part


def sample(rng, side, part):
    """A value of a part, as a float within it."""
    if hasattr(side, "chosen"):
        values = side.values[slice(*side.chosen(part))]
        return float(values[int(rng.integers(len(values)))].mid())
    ends = side.enclosure(part)
    corner = rng.random()
    share = 0.0 if corner < 0.1 else 1.0 if corner > 0.9 else rng.random()
    return (1 - share) * float(ends.low) + share * float(ends.high)


def points_of(model, q, theta):
    """Effectors, then the points that span the bodies, by products of frames."""
    values, frames, d = scalar_values(model, theta), frames_of(model, q, theta), model.dimension
    found = [frames[frame][1] for frame in model.effectors]
    for body in model.bodies:
        turn, origin = frames[body.frame]
        if hasattr(body, "length"):
            found += [origin, origin + turn[:, body.axis] * body.sign * values[body.length]]
        elif hasattr(body, "com"):
            found.append(origin + turn @ np.array([values[i] for i in body.com]))
        else:
            found.append(origin)
    return np.array(found)[:, :d]


def robots(seed):
    """A robot whose sliders have ranges."""
    rng = np.random.default_rng(seed)
    while True:
        dimension, joints = int(rng.choice([2, 3])), int(rng.integers(1, 4))
        if seed % 2:
            model = random_robot(rng, dimension)
        else:
            model = random_robots.random_robot(int(rng.integers(1000)), dimension, joints)
        if coordinate_sides(model) is not None:
            return rng, model


@pytest.mark.parametrize("seed", some(range(24), 8))
def test_heights_over_a_box_hold_those_of_all_its_poses(seed):
    rng, model = robots(seed)
    with working_precision(64):
        sides = [*coordinate_sides(model), *parameter_sides(model)]
        tapes = PointTapes(model)
        n = len(model.dofs)
        for _ in range(6):
            parts = [random_part(rng, side, 6) for side in sides]
            points = tapes.over(enclosures(sides, parts))
            normal = [Fraction(int(k), 7) for k in rng.integers(-9, 10, model.dimension)]
            exact = np.array([float(entry) for entry in normal])
            count = tapes.values.outputs // model.dimension
            bounds = [
                float(points.highest(p, ball_row(row(*normal, 0))).upper()) for p in range(count)
            ]
            for _ in range(30):
                x = np.array([sample(rng, s, p) for s, p in zip(sides, parts, strict=True)])
                heights = points_of(model, x[:n], x[n:]) @ exact
                for point, (height, bound) in enumerate(zip(heights, bounds, strict=True)):
                    assert np.isnan(bound) or height <= bound + 1e-12
                    # strictly beyond a level just above a height that is attained: never
                    level = Fraction(float(height)) + Fraction(1, 10**9)
                    assert not points.beyond(point, ball_row(row(*normal, level)))


@pytest.mark.parametrize("seed", [1, 2, 5, 8])
def test_points_are_those_of_the_graph(seed):
    rng, model = robots(seed)
    n, p = len(model.dofs), len(model.parameters)
    q, theta = rng.uniform(-1, 1, (3, n)), rng.uniform(0.5, 1, p)
    near = PointTapes(model).near(q, theta)
    graph = robot_graph(model)
    for pose, found in zip(q, near, strict=True):
        expected = np.asarray(graph.points(pose, theta, constants_of(graph)).full()).ravel()
        assert np.allclose(found.ravel(), expected, atol=1e-12)
        assert np.allclose(found, points_of(model, pose, theta), atol=1e-12)
    count = max((hull[-1] for hull in body_points(model)), default=len(model.effectors) - 1)
    assert count + 1 == near.shape[1]


def test_small_boxes_are_enclosed_to_the_second_order():
    arm = ArmBuilder().revolute().link(1).revolute().link("7/10").effector()
    model = arm.model()
    with working_precision(64):
        sides, tapes = coordinate_sides(model), PointTapes(model)
        excess = []
        for halvings in (5, 6, 7):
            box = enclosures(sides, [Part(0, halvings), Part(1, halvings)])
            bound = float(tapes.over(box).highest(0, ball_row(row(1, 2, 0))))
            ends = [np.linspace(float(side.low), float(side.high), 41) for side in box]
            a, b = np.meshgrid(*ends)
            x, y = np.cos(a) + 0.7 * np.cos(a + b), np.sin(a) + 0.7 * np.sin(a + b)
            excess.append(bound - float(np.max(x + 2 * y)))
    assert all(item > 0 for item in excess)
    assert excess[0] / excess[1] == pytest.approx(4, rel=0.3)
    assert excess[1] / excess[2] == pytest.approx(4, rel=0.3)


def test_a_kink_has_both_slopes():
    arm = ArmBuilder()
    t = arm.parameter(-1, 1)
    model = arm.revolute(limits=(0, 0)).link(arm.apply("abs", t)).effector().model()
    with working_precision(64):
        sides = [*coordinate_sides(model), *parameter_sides(model)]
        box = enclosures(sides, [Part(), Part()])
        points = PointTapes(model).over(box)
        assert float(points.highest(0, ball_row(row(1, 0, 0)))) == 1
        assert not points.beyond(0, ball_row(row(-1, 0, 0)))


def test_what_is_not_defined_all_over_a_box_is_not_bounded_there():
    arm = ArmBuilder()
    t = arm.parameter(-1, 1)
    model = arm.revolute().link(arm.apply("sqrt", t)).effector().model()
    with working_precision(64):
        sides = [*coordinate_sides(model), *parameter_sides(model)]
        points = PointTapes(model).over(enclosures(sides, [Part(), Part()]))
        assert points.highest(0, ball_row(row(1, 0, 0))).is_nan()
        assert not points.beyond(0, ball_row(row(1, 0, -100)))
        half = PointTapes(model).over(enclosures(sides, [Part(), Part(1, 1)]))
        assert half.highest(0, ball_row(row(1, 0, 0))) <= 1
