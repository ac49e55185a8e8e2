"""Drives in the equations of motion, in normal forms, in the bounds of inputs."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

import casadi as ca
import numpy as np
import pytest

from compiler.discretisation.numeric_robot import NumericRobot
from compiler.dynamics.equations_of_motion import RobotGraph, robot_graph
from compiler.dynamics.kinematics import absolute_angles
from compiler.mass_matrix.mass_matrix_check import mass_matrix_check
from compiler.robots.normal_form import normalise
from compiler.robots.robot import WORLD, RobotModel
from compiler.robots.robot_key import provably_different, robot_key
from compiler.robots.state_and_input import input_bounds, unbounded_kinds
from grammar_lang import ir
from tests.oracles.formulas import program
from tests.oracles.robots import Builder, constants_of, rod_chain

ROTORS = [Fraction(1, 3), None, Fraction(7, 5)]


def number(value: Fraction | int | None) -> ir.Expr | None:
    return None if value is None else ir.Num(Fraction(value))


def driven(model: RobotModel, rotors: Sequence[Fraction | None]) -> RobotModel:
    dofs = [replace(d, inertia=number(rotor)) for d, rotor in zip(model.dofs, rotors, strict=True)]
    return replace(model, dofs=tuple(dofs))


def mass(graph: RobotGraph, q: np.ndarray, theta: np.ndarray) -> np.ndarray:
    return np.asarray(graph.mass_matrix(q, theta, constants_of(graph)).full())


def spatial() -> RobotModel:
    builder, frame = Builder(3), WORLD
    for axis, kind in (("z", "revolute"), ("y", "prismatic"), ("y", "revolute")):
        frame = builder.joint(frame, axis, kind)  # type: ignore[arg-type]
        frame = builder.link(frame, builder.parameter())
        builder.solid(frame, 2, (0, Fraction(1, 2), 1), (1, 2, 2, Fraction(1, 5), 0, 0))
    builder.effector(frame)
    return builder.build()


@pytest.mark.parametrize("model", [rod_chain(3), spatial()], ids=["plane", "space"])
def test_rotors_stand_on_the_diagonal(model: RobotModel) -> None:
    rng = np.random.default_rng(1)
    q, theta = rng.uniform(-2, 2, 3), rng.uniform(0.5, 2, len(model.parameters))
    bare, rotors = robot_graph(model), robot_graph(driven(model, ROTORS))
    added = mass(rotors, q, theta) - mass(bare, q, theta)
    assert np.allclose(added, np.diag([1 / 3, 0, 7 / 5]), atol=1e-12)


def test_rotors_in_absolute_angles() -> None:
    """q = D y: the rotor of the second joint feels the difference of two absolute angles."""
    model = driven(rod_chain(3), ROTORS)
    angles = absolute_angles(model)
    rng = np.random.default_rng(2)
    y, theta = rng.uniform(-2, 2, 3), rng.uniform(0.5, 2, 3)
    rows = np.array(angles.rows, dtype=float)
    own = mass(robot_graph(model), rows @ y, theta)
    seen = mass(robot_graph(model, coordinates=angles), y, theta)
    assert np.allclose(seen, rows.T @ own @ rows, atol=1e-12)


@pytest.mark.parametrize("model", [rod_chain(3), spatial()], ids=["plane", "space"])
def test_efforts_by_recursion_feel_the_rotors(model: RobotModel) -> None:
    """The search solves M a = u - c by another recursion than the graph's M."""
    model, rng = driven(model, ROTORS), np.random.default_rng(3)
    numeric, graph = NumericRobot(robot_graph(model)), robot_graph(model)
    x, u = rng.uniform(-1, 1, (1, 6)), rng.uniform(-1, 1, (1, 3))
    theta = rng.uniform(0.5, 2, numeric.p)
    rates, _ = numeric.acceleration(x, u, theta)
    k = constants_of(graph)
    bias = np.asarray(graph.bias(x[0, :3], x[0, 3:], theta, k).full()).ravel()
    found = mass(graph, x[0, :3], theta) @ rates[0, :3] + bias
    assert np.allclose(found, u[0], atol=1e-9)


def test_uncertain_masses_leave_rotors_alone() -> None:
    """All bodies twice as heavy: M is twice as large but for the rotors."""
    model, rng = driven(rod_chain(3), ROTORS), np.random.default_rng(4)
    graph = robot_graph(model)
    weighed = graph.weighed([(0, 1, 2)])
    q, theta = rng.uniform(-2, 2, 3), rng.uniform(0.5, 2, 3)
    w, u, k = np.zeros(4), np.zeros(3), constants_of(graph)
    heavy = np.concatenate([w[:3], [2.0]])
    balance = np.asarray(weighed.balance(q, heavy, u, theta, k).full()).ravel()[:9]
    rotors = np.diag([1 / 3, 0, 7 / 5])
    expected = 2 * (mass(graph, q, theta) - rotors) + rotors
    assert np.allclose(balance.reshape(3, 3), expected, atol=1e-12)
    efforts = graph.efforts_of([(0, 1, 2)])
    a = rng.uniform(-1, 1, 3)
    asked = np.asarray(efforts(q, w[:3], a, u, theta, k).full()).ravel()
    assert np.allclose(asked, (mass(graph, q, theta) - rotors) @ a, atol=1e-12)


def test_driven_joints_are_not_merged_and_keys_tell_them_apart() -> None:
    builder = Builder()
    frame = builder.joint(builder.joint(WORLD))
    builder.effector(builder.link(frame, builder.parameter()))
    model = builder.build()
    assert len(normalise(model).dofs) == 1
    changes = ({"inertia": number(1)}, {"effort": number(1)}, {"effort": number(2)})
    others = [
        normalise(replace(model, dofs=(model.dofs[0], replace(model.dofs[1], **change))))
        for change in changes
    ]
    assert [len(other.dofs) for other in others] == [2, 2, 2]
    geared = replace(model.dofs[1], gear=number(100))
    assert len(normalise(replace(model, dofs=(model.dofs[0], geared))).dofs) == 2
    assert len({robot_key(other) for other in (normalise(model), *others)}) == 4
    assert provably_different(others[1], others[2])


def test_a_rotor_makes_up_for_a_link_without_inertia() -> None:
    """A rod that turns about its axis has none; with a rotor M is positive definite."""
    builder = Builder(3)
    first = builder.joint(WORLD, "y")
    second = builder.joint(first, "x")
    builder.rod(second, "x", builder.number(1))
    builder.effector(builder.move(second, "y", builder.number(1)))
    model = builder.build()
    assert mass_matrix_check(model).status == "fails"
    assert mass_matrix_check(driven(model, [None, Fraction(1, 100)])).status == "proved"
    assert mass_matrix_check(driven(model, [None, Fraction(0)])).status == "fails"


SPEC = """
module B { role base; } module E { role effector; }
module J { role joint; dof q: revolute z EFFORT; } module K { role joint; dof q: revolute z; }
module L { role link; const length = 1 m; }
grammar G { start N; all: N -> B J L K L E; }
semantics G { all { this.a = rot(z, J.q); this.b = this.a * move(x, 1 m) * rot(z, K.q);
  rod(frame: this.a, axis: x, length: L1.length, density: 1);
  rod(frame: this.b, axis: x, length: L2.length, density: 1);
  effector(frame: this.b * move(x, 1 m)); } }
workspace W { plane xy; bounds box [-9, 9] x [-9, 9] m;
  region S box [1, 2] x [0, 1] m; target T box [-2, -1] x [0, 1] m; }
task T { robot G; workspace W; start in S; reach T; TASK horizon 5 steps of 0.1 s; }
"""


@pytest.mark.parametrize(
    ("own", "task", "bounds"),
    [
        ("", "effort <= 7 N*m;", [((0, 1), 7, "effort", False)]),
        ("effort <= 3 N*m", "effort <= 7 N*m;",
         [((1,), 7, "effort", False), ((0,), 3, "effort of joint 1", False)]),
        ("effort <= 9 N*m", "effort <= 7 N*m;",
         [((1,), 7, "effort", False), ((0,), 7, "effort of joint 1", False)]),
        ("effort <= 3 N*m", "effort <= 7 N*m norm 2;",
         [((0, 1), 7, "effort", True), ((0,), 3, "effort of joint 1", False)]),
    ],
)  # fmt: skip
def test_the_smaller_bound_counts(
    own: str, task: str, bounds: list[tuple[tuple[int, ...], int, str, bool]]
) -> None:
    spec = program(SPEC.replace("EFFORT", own).replace("TASK", task))
    model = rod_chain(2)
    effort = spec.modules["J"].dofs[0].effort
    model = replace(model, dofs=(replace(model.dofs[0], effort=effort), model.dofs[1]))
    found = input_bounds(model, spec.tasks["T"])
    assert [(each.inputs, each.upper, each.name, each.norm2) for each in found] == bounds
    assert all(each.effort and each.lower == -each.upper for each in found)
    assert not unbounded_kinds(model, spec.tasks["T"])


def test_a_task_needs_no_effort_where_all_joints_have_one() -> None:
    text = SPEC.replace(
        "module K { role joint; dof q: revolute z;",
        "module K { role joint; dof q: revolute z effort <= 2 N*m;",
    )
    spec = program(text.replace("EFFORT", "effort <= 3 N*m").replace("TASK", ""))
    assert spec.tasks["T"].effort == ()


def test_rotors_are_closed_expressions_of_any_kind() -> None:
    """Also irrational ones: a spindle has pi in its gear."""
    gear = ir.Binary("/", ir.Binary("*", ir.Num(Fraction(2)), ir.Pi()), ir.Num(Fraction(1, 200)))
    inertia = ir.Binary("*", ir.Binary("*", gear, gear), ir.Num(Fraction(1, 100_000)))
    model = rod_chain(1)
    model = replace(model, dofs=(replace(model.dofs[0], inertia=inertia),))
    graph = robot_graph(model)
    found = mass(graph, np.zeros(1), np.ones(1))
    assert found[0, 0] == pytest.approx(1 / 3 + (2 * np.pi * 200) ** 2 / 1e5, rel=1e-12)
    assert isinstance(graph.mass_matrix, ca.Function)
