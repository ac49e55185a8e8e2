"""Distances between the bodies of random robots, against a closed form and against Coal.

Coal is an independent library for collisions (the successor of FCL).  Places of bodies come from
the robot's kinematics, which is tested elsewhere.
"""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from compiler.arrays import Array
from compiler.discretisation.hull_distance import nearest_to_zero
from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.expressions.evaluators.floats import scalar_floats
from compiler.robots.bodies_apart import bodies_apart
from compiler.robots.robot import WORLD, RobotModel
from grammar_lang import ir
from tests.oracles.robots import Builder


def random_arm(seed: int) -> RobotModel:
    """Three to six joints in the plane or in space; every other one branches at its second link."""
    rng = np.random.default_rng(seed)
    builder = Builder(2 + seed % 2)
    axes = "z" if builder.dimension == 2 else "xyz"
    joints, frames, frame = int(rng.integers(3, 7)), [WORLD], WORLD
    for number in range(joints):
        if seed % 4 > 1 and number == joints // 2:
            frame = frames[len(frames) // 2]
        frame = builder.joint(frame, str(rng.choice(list(axes))))
        if builder.dimension == 3 and rng.random() < 0.5:
            frame = builder.turn(frame, "x", builder.number(Fraction(int(rng.integers(-3, 4)), 2)))
        length = Fraction(int(rng.integers(2, 12)), 10)
        frame = builder.link(frame, builder.number(length), str(rng.choice(["x", "y"])))
        frames.append(frame)
    builder.effector(frame)
    return builder.build()


def segments_distance(one: Array, two: Array) -> Array:
    """The distances (k,) of segments (k, 2, d): inside both, or from an end of either.

    The least of the distances of the four ends from the other segment and, where both feet of the
    common perpendicular lie inside, of the lines.
    """

    def from_end(point: Array, segment: Array) -> Array:
        along = segment[:, 1] - segment[:, 0]
        share = np.sum((point - segment[:, 0]) * along, axis=1) / np.sum(along**2, axis=1)
        foot = segment[:, 0] + np.clip(share, 0, 1)[:, None] * along
        return np.linalg.norm(point - foot, axis=1)

    found = np.min(
        [from_end(one[:, i], two) for i in range(2)] + [from_end(two[:, i], one) for i in range(2)],
        axis=0,
    )
    u, v, w = one[:, 1] - one[:, 0], two[:, 1] - two[:, 0], two[:, 0] - one[:, 0]
    a, b, c = (np.sum(x * y, axis=1) for x, y in ((u, u), (u, v), (v, v)))
    d, e = np.sum(u * w, axis=1), np.sum(v * w, axis=1)
    volume = a * c - b * b
    crossing = volume > 1e-9 * a * c
    safe = np.where(crossing, volume, 1.0)
    s, t = (c * d - b * e) / safe, (b * d - a * e) / safe
    inside = crossing & (s >= 0) & (s <= 1) & (t >= 0) & (t <= 1)
    between = w + t[:, None] * v - s[:, None] * u
    return np.where(inside, np.linalg.norm(between, axis=1), found)


def pairs_in_poses(seed: int, count: int) -> tuple[Array, Array, Array]:
    """Both segments (k, 2, d) of each pair in each of so many poses, and what we say, (k,)."""
    model = random_arm(seed)
    model = replace(model, apart=bodies_apart(model, ir.AvoidSelf(Fraction(0))))
    numeric = NumericRobot(robot_graph(model))
    q = np.random.default_rng(100 + seed).uniform(-np.pi, np.pi, size=(count, numeric.n))
    points, first = numeric.positions(q, np.zeros(0)), len(model.effectors)
    one, two, ours = list[Array](), list[Array](), list[Array]()
    for (a, b), gap in zip(model.apart, numeric.spanning.gaps, strict=True):
        for body, found in ((a, one), (b, two)):
            found.append(points[:, [first + i for i in numeric.spanning.hulls[body]]])
        differences = points[:, [first + i for i in gap]]
        ours.append(np.linalg.norm(nearest_to_zero(differences), axis=1))
    return np.concatenate(one), np.concatenate(two), np.concatenate(ours)


@pytest.mark.parametrize("seed", range(8))
def test_closed_form(seed: int) -> None:
    one, two, ours = pairs_in_poses(seed, 1250)
    assert np.allclose(ours, segments_distance(one, two), rtol=0, atol=1e-9)
    assert np.count_nonzero(ours > 0) > 1000


def upright(segment: Array) -> tuple[Array, Array]:
    """The rotation that turns z along a segment, and its middle."""
    axis = (segment[1] - segment[0]) / np.linalg.norm(segment[1] - segment[0])
    other = np.cross(axis, np.eye(3)[np.argmin(np.abs(axis))])
    other /= np.linalg.norm(other)
    return np.stack([other, np.cross(axis, other), axis], axis=1), segment.mean(axis=0)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(8))
def test_capsules_of_coal(seed: int) -> None:
    coal = pytest.importorskip("coal")
    one, two, ours = pairs_in_poses(seed, 1250)
    if one.shape[2] == 2:
        one, two = (np.concatenate([x, np.zeros((*x.shape[:2], 1))], axis=2) for x in (one, two))
    thick, thin = 0.05, 0.02
    request, apart = coal.DistanceRequest(), 0
    for a, b, distance in zip(one, two, ours - thick - thin, strict=True):
        if distance <= 0:
            continue
        apart += 1
        shapes = (
            coal.Capsule(radius, float(np.linalg.norm(ends[1] - ends[0])))
            for radius, ends in ((thick, a), (thin, b))
        )
        places = [coal.Transform3s(*upright(ends)) for ends in (a, b)]
        result = coal.DistanceResult()
        left, right = shapes
        coal.distance(left, places[0], right, places[1], request, result)
        assert abs(result.min_distance - distance) <= 1e-6
    assert apart > 1000


def shaped_arm(seed: int) -> RobotModel:
    """Three or four joints in space; each link has a box, a sphere, a capsule or a hull."""
    rng = np.random.default_rng(1000 + seed)
    builder = Builder(3)
    frame = WORLD
    for number in range(3 + seed % 2):
        frame = builder.joint(frame, str(rng.choice(list("xyz"))))
        frame = builder.turn(frame, "y", builder.number(Fraction(int(rng.integers(-9, 10)), 10)))
        sizes = [builder.number(Fraction(int(x), 50)) for x in rng.integers(2, 12, 3)]
        builder.shape(frame, "box", sizes)
        frame = builder.link(frame, builder.number(Fraction(int(rng.integers(2, 10)), 10)))
        match (number + seed) % 3:
            case 0:
                builder.shape(frame, "sphere", sizes[:1])
            case 1:
                builder.shape(frame, "capsule", sizes[:2], "y")
            case _:
                corners = rng.integers(-9, 10, (7, 3)).tolist()
                builder.hull(frame, [(Fraction(x, 40), Fraction(y, 40), Fraction(z, 40))
                                     for x, y, z in corners])  # fmt: skip
    builder.effector(frame)
    return builder.build()


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(5))
def test_shapes_of_coal(seed: int) -> None:
    """10,000 poses: boxes and hulls by their corners, spheres and capsules by their cores."""
    coal = pytest.importorskip("coal")
    model = shaped_arm(seed)
    model = replace(model, owners=(None,) * len(model.bodies))
    model = replace(model, apart=bodies_apart(model, ir.AvoidSelf(Fraction(0))))
    numeric = NumericRobot(robot_graph(model))
    q = np.random.default_rng(seed).uniform(-np.pi, np.pi, size=(2000, numeric.n))
    points, first = numeric.positions(q, np.zeros(0)), len(model.effectors)
    scalars = scalar_floats(model.scalars, np.zeros(0))
    request, apart = coal.DistanceRequest(), 0
    request.gjk_tolerance, request.gjk_max_iterations = 1e-9, 1000
    here = coal.Transform3s(np.eye(3), np.zeros(3))

    def solid(body: int, corners: Array) -> object:
        """In the world, grown by its radius."""
        places = coal.StdVec_Vec3s()
        places.extend(corners)
        if len(corners) > 2:
            return coal.Convex.convexHull(places, False, ""), here
        radius = getattr(model.colliders[body], "radius", None)
        thick = 1e-9 if radius is None else float(scalars[radius])
        if len(corners) == 1:
            return coal.Sphere(thick), coal.Transform3s(np.eye(3), corners[0])
        length = float(np.linalg.norm(corners[1] - corners[0]))
        return coal.Capsule(thick, length), coal.Transform3s(*upright(corners))

    for (a, b), gap in zip(model.apart, numeric.spanning.gaps, strict=True):
        differences = points[:, [first + i for i in gap]]
        ours = np.linalg.norm(nearest_to_zero(differences), axis=1)
        for body in (a, b):
            radius = getattr(model.colliders[body], "radius", None)
            ours = ours - (0.0 if radius is None else float(scalars[radius]))
        for number in np.flatnonzero(ours > 1e-6):
            apart += 1
            (one, there), (two, beyond) = (
                solid(body, points[number, [first + i for i in numeric.spanning.hulls[body]]])
                for body in (a, b)
            )
            result = coal.DistanceResult()
            coal.distance(one, there, two, beyond, request, result)
            assert abs(result.min_distance - ours[number]) <= 1e-6
    assert apart > 2000
