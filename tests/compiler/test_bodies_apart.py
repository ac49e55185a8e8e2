"""Which pairs of bodies must not touch, and how far they are apart."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.dynamics.kinematics import absolute_angles
from compiler.robots.bodies_apart import bodies_apart
from compiler.robots.normal_form import normalise
from compiler.robots.robot import WORLD, BodyOwner, RobotModel
from compiler.robots.robot_key import robot_key
from grammar_lang import ir
from tests.oracles.robots import Builder, rod_chain

ALL = ir.AvoidSelf(Fraction(0))


def test_links_of_one_joint_may_touch() -> None:
    assert bodies_apart(rod_chain(2), ALL) == ()
    assert bodies_apart(rod_chain(4), ALL) == ((0, 2), (0, 3), (1, 3))


def test_links_without_bodies_are_skipped() -> None:
    """A rod, a wrist of three axes, a rod, an elbow, a rod."""
    builder = Builder(3)
    frame = builder.link(builder.joint(WORLD, "z"), builder.number(2))
    for axis in "xyx":
        frame = builder.joint(frame, axis)
    frame = builder.link(frame, builder.number(1))
    frame = builder.link(builder.joint(frame, "y"), builder.number(1))
    builder.effector(frame)
    assert bodies_apart(builder.build(), ALL) == ((0, 2),)


def test_a_joint_that_moves_no_mass_parts_links() -> None:
    """The second joint turns a rod about itself, and is none of the normal form."""
    builder = Builder(3)
    frame = builder.link(builder.joint(WORLD, "z"), builder.number(2))
    middle = builder.link(builder.joint(frame, "z"), builder.number(1))
    builder.effector(builder.link(builder.joint(middle, "x"), builder.number(1)))
    model = builder.build()
    assert len(normalise(model).dofs) == len(model.dofs) - 1
    assert bodies_apart(model, ALL) == ((0, 2),)


def branching(*mounts: int) -> RobotModel:
    """A rod in the world, and two arms of two rods whose first joints are along it."""
    builder = Builder()
    builder.rod(WORLD, "x", builder.number(5))
    for mount in mounts:
        frame = builder.move(WORLD, "x", builder.number(mount))
        for _ in range(2):
            frame = builder.link(builder.joint(frame), builder.number(1))
        builder.effector(frame)
    return builder.build()


def test_two_arms() -> None:
    second = {(0, 2), (0, 4)}
    across = {(1, 3), (1, 4), (2, 3), (2, 4)}
    assert set(bodies_apart(branching(1, 3), ALL)) == second | across
    assert set(bodies_apart(branching(2, 2), ALL)) == second | across - {(1, 3)}


def test_an_empty_world_parts_two_arms() -> None:
    model = branching(1, 3)
    alone = replace(model, bodies=model.bodies[1:])
    assert set(bodies_apart(alone, ALL)) == {(0, 2), (0, 3), (1, 2), (1, 3)}
    alone = replace(branching(2, 2), bodies=model.bodies[1:])
    assert set(bodies_apart(alone, ALL)) == {(0, 3), (1, 2), (1, 3)}


def test_centres_of_mass_count_where_a_link_has_no_rod() -> None:
    builder = Builder(3)
    frame = WORLD
    for number in range(4):
        frame = builder.joint(frame, "yzxy"[number])
        builder.solid(frame, 1, (Fraction(1, 2), 0, 0), (1, 1, 1, 0, 0, 0))
        frame = builder.move(frame, "x", builder.number(1))
    builder.rod(3, "x", builder.number(1))
    builder.effector(frame)
    # Frame 3 is behind the second joint: its rod, body 4, stands for body 1.
    assert bodies_apart(builder.build(), ALL) == ((0, 2), (0, 3), (3, 4))


def test_excepted_modules() -> None:
    model = rod_chain(4)
    owners = tuple(BodyOwner(i, name) for i, name in enumerate("ABCB"))
    model = replace(model, owners=owners)
    some = ir.AvoidSelf(Fraction(0), frozenset({("A", "B"), ("B", "B")}))
    assert bodies_apart(model, some) == ((0, 2),)
    unknown = replace(model, owners=(None, *owners[1:]))
    assert bodies_apart(unknown, some) == ((0, 2), (0, 3))


def test_pairs_are_part_of_the_key() -> None:
    model = normalise(rod_chain(3))
    assert robot_key(model) != robot_key(replace(model, apart=((0, 2),)))


def spatial() -> RobotModel:
    """Two arms on one foot, with a slide, oblique turns and solids beside rods."""
    builder = Builder(3)
    foot = builder.joint(WORLD, "z")
    builder.rod(foot, "z", builder.parameter())
    for axes in ("yx", "xz"):
        frame = builder.move(foot, "z", builder.parameter())
        frame = builder.turn(frame, "x", builder.number(Fraction(1, 3)))
        for axis in axes:
            frame = builder.joint(frame, axis)
            frame = builder.link(frame, builder.parameter())
        frame = builder.joint(frame, "y", "prismatic")
        builder.solid(frame, 1, (Fraction(1, 5), 0, 1), (1, 1, 1, 0, 0, 0))
        builder.effector(frame)
    return builder.build()


@pytest.mark.parametrize(
    ("model", "absolute"),
    [(rod_chain(4), False), (rod_chain(4), True), (branching(1, 3), True), (spatial(), False)],
)
def test_differences_are_as_long_as_in_the_world(model: RobotModel, absolute: bool) -> None:
    """Lengths of differences do not depend on where they are seen from."""
    pairs = bodies_apart(model, ALL)
    model = replace(model, apart=pairs)
    measured = absolute_angles(model) if absolute else None
    numeric = NumericRobot(robot_graph(model, coordinates=measured))
    rng = np.random.default_rng(1)
    q = rng.uniform(-3, 3, size=(20, numeric.n))
    theta = rng.uniform(0.5, 2, size=numeric.p)
    points = numeric.points(q, theta)
    first = len(model.effectors)
    assert np.array_equal(points.value, numeric.positions(q, theta))
    for (one, two), gap in zip(pairs, numeric.spanning.gaps, strict=True):
        a, b = (
            points.value[:, [first + i for i in numeric.spanning.hulls[body]]]
            for body in (one, two)
        )
        lengths = np.linalg.norm(a[:, :, None] - b[:, None], axis=3).reshape(len(q), -1)
        found = points.value[:, [first + i for i in gap]]
        assert np.allclose(np.linalg.norm(found, axis=2), lengths, rtol=1e-12, atol=1e-12)
    # A joint that both bodies are behind moves no difference, but for axes of the world.
    if model.dimension == 3:
        assert not np.any(points.by_q[:, first + numeric.spanning.gaps[0][0] :, :, 0])


def test_effectors_alone() -> None:
    numeric = NumericRobot(robot_graph(replace(spatial(), apart=((1, 4),))))
    rng = np.random.default_rng(2)
    q, theta = rng.uniform(-3, 3, size=(5, numeric.n)), rng.uniform(0.5, 2, size=numeric.p)
    every, alone = numeric.points(q, theta), numeric.effectors(q, theta)
    for found, expected in ((alone.value, every.value), (alone.by_q, every.by_q)):
        assert np.allclose(found, expected[:, :2], rtol=1e-13, atol=1e-13)
    assert alone.by_theta.shape == (5, 2, 3, numeric.p)
