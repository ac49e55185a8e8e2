"""Shapes of robots: what collides, what is covered, what a normal form and its key keep of them."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.bodies_apart import bodies_apart
from compiler.robots.normal_form import family_of, normalise
from compiler.robots.robot import WORLD, PointBody, RobotModel, RodBody, Shape, SolidBody
from compiler.robots.robot_key import provably_different, robot_key
from compiler.words.structures import structures_of
from grammar_lang import ir
from tests.oracles.formulas import program
from tests.oracles.robots import Builder

ALL = ir.AvoidSelf(Fraction(0))
SPEC = """
module Base { role base; } module Turn { role joint; dof q: revolute y in [-90, 90] deg; }
module Tube { role link; param length in [1, 2] m; } module Hand { role effector; }
grammar G { start N; base: N -> Base; turn: N -> N Turn; tube: N -> N Tube; hand: N -> N Hand;
  accept matches Base Turn Tube Turn Tube Hand; }
semantics G {
  base { this.frame = world; box(frame: world, size: (1, 2, 0.5) m); point(frame: world, mass: 1); }
  turn { this.frame = N.frame * rot(y, Turn.q); point(frame: N.frame, mass: 2); }
  tube { this.frame = N.frame * move(x, Tube.length);
    rod(frame: N.frame, axis: x, length: Tube.length, density: 1);
    solid(frame: N.frame, mass: 1, com: (0.1, 0, 0), inertia: (1, 1, 1, 0, 0, 0)); TUBE }
  hand { this.frame = N.frame; effector(frame: N.frame);
    solid(frame: N.frame, mass: 1, com: (0.1, 0, 0), inertia: (1, 1, 1, 0, 0, 0)); }
}
workspace W { space xyz; bounds box [-9, 9] x [-9, 9] x [-9, 9] m;
  region S box [1, 2] x [0, 1] x [0, 1] m; target T box [-2, -1] x [0, 1] x [0, 1] m; }
task T { robot G; workspace W; start in S; reach T; effort <= 10 N*m; horizon 5 steps of 0.1 s;
  avoid self with body; }
"""


def built(tube: str) -> RobotModel:
    spec = program(SPEC.replace("TUBE", tube))
    family = family_of(spec, spec.tasks["T"])
    (derivation,) = structures_of(family.language, family.language.words())
    return family.built(derivation)


CYLINDER = "cylinder(frame: N.frame, axis: -x, length: Tube.length, radius: 10 cm);"


def test_a_link_with_shapes_collides_as_these_and_its_rods() -> None:
    """The points of the base and of the shoulder, and all solids, are covered."""
    model = built(CYLINDER)
    kinds = [type(each) for each in model.colliders]
    assert kinds == [RodBody, RodBody, Shape, Shape, Shape]
    assert [each.kind for each in model.shapes] == ["box", "cylinder", "cylinder"]
    assert [model.shapes[1].axis, model.shapes[1].sign] == [0, -1]
    assert len(model.bodies) == 8
    assert model.collider_names == ("body 3", "body 6", "shape 1", "shape 2", "shape 3")
    owners = [owner and owner.module for owner in model.collider_owners]
    assert owners == ["Tube", "Tube", "Base", "Tube", "Tube"]
    # Base and first tube, and both tubes, are connected by one joint.
    pairs = {
        (model.collider_names[i], model.collider_names[j]) for i, j in bodies_apart(model, ALL)
    }
    assert pairs == {("body 6", "shape 1"), ("shape 1", "shape 3")}


def test_a_link_without_shapes_collides_as_its_bodies() -> None:
    model = built("")
    kinds = [type(each) for each in model.colliders]
    # Of the base and, as it is fixed there, of the shoulder, the point is covered.
    assert kinds == [RodBody, SolidBody, PointBody, RodBody, SolidBody, SolidBody, Shape]


def test_what_a_shape_moves_with_stays_in_the_normal_form() -> None:
    """A joint about the axis of a cylinder does not move it, and moves a box."""
    for kind, kept in (("cylinder", 1), ("capsule", 1), ("sphere", 1), ("box", 2)):
        builder = Builder(3)
        first = builder.joint(WORLD, "y")
        second = builder.joint(first, "x")
        count = {"box": 3, "sphere": 1}.get(kind, 2)
        builder.shape(second, kind, [builder.number(1)] * count)  # type: ignore[arg-type]
        builder.rod(second, "x", builder.number(1))
        assert len(normalise(builder.build()).dofs) == kept


def arm(radius: Fraction, kind: ir.ShapeKind = "capsule", axis: str = "x") -> RobotModel:
    builder = Builder(3)
    joint = builder.joint(WORLD, "y")
    builder.shape(joint, kind, [builder.parameter(), builder.number(radius)], axis)
    builder.link(joint, builder.number(1))
    return normalise(builder.build())


def test_keys_tell_shapes_apart() -> None:
    models = [
        arm(Fraction(1, 10)), arm(Fraction(1, 9)), arm(Fraction(1, 10), "cylinder"),
        arm(Fraction(1, 10), axis="-x"), replace(arm(Fraction(1, 10)), covered=(0,)),
        replace(arm(Fraction(1, 10)), shapes=()),
    ]  # fmt: skip
    assert len({robot_key(model) for model in models}) == len(models)
    assert robot_key(arm(Fraction(1, 10))) == robot_key(models[0])
    for other in models[1:]:
        assert provably_different(models[0], other)


@pytest.mark.parametrize("dimension", [2, 3])
def test_derivatives_of_corners(dimension: int) -> None:
    """By central differences, in coordinates and in parameters that are sizes."""
    builder = Builder(dimension)
    frame = WORLD
    for axis in ("z", "z" if dimension == 2 else "y", "z"):
        frame = builder.joint(frame, axis)  # type: ignore[arg-type]
        size = builder.parameter(name=f"p{len(builder.parameters)}")
        place = builder.move(frame, "y", builder.number(Fraction(1, 3)))
        builder.shape(place, "box", [size, builder.number(1), builder.number(2)][:dimension])
        builder.shape(place, "cylinder", [builder.number(1), size])
        frame = builder.move(frame, "x", builder.parameter(name=f"l{len(builder.parameters)}"))
    builder.effector(frame)
    model = builder.build()
    numeric = NumericRobot(robot_graph(replace(model, apart=bodies_apart(model, ALL))))
    rng = np.random.default_rng(dimension)
    q, theta = rng.uniform(-2, 2, (3, numeric.n)), rng.uniform(0.5, 2, numeric.p)
    points, h = numeric.points(q, theta), 1e-6
    assert np.allclose(points.value, numeric.positions(q, theta), atol=1e-14)
    for i, step in enumerate(h * np.eye(numeric.n)):
        slope = (numeric.positions(q + step, theta) - numeric.positions(q - step, theta)) / (2 * h)
        assert np.allclose(points.by_q[..., i], slope, atol=1e-7)
    for i, step in enumerate(h * np.eye(numeric.p)):
        slope = (numeric.positions(q, theta + step) - numeric.positions(q, theta - step)) / (2 * h)
        assert np.allclose(points.by_theta[..., i], slope, atol=1e-7)
    designs = numeric.points(q, np.tile(theta, (3, 1)))
    assert np.allclose(designs.value, points.value, atol=1e-14)
    assert np.allclose(designs.by_theta, points.by_theta, atol=1e-14)
