"""Instruction lists: no inexact constant, and the same function in every arithmetic."""

from __future__ import annotations

from fractions import Fraction

import casadi as ca
import mpmath as mp
import numpy as np
import pytest

from compiler.dynamics.equations_of_motion import RobotGraph, robot_graph
from compiler.expressions.evaluators.balls import (
    BallEvaluator,
    ball,
    constant_ball,
    working_precision,
)
from compiler.expressions.tape import tape
from compiler.robots.robot import WORLD, RobotModel
from tests.oracles.driven_robots import driven
from tests.oracles.exact_chain import DIGITS, Multiprecision, contains, exact
from tests.oracles.planar_chain import chain_dynamics
from tests.oracles.robots import Builder, constants_of, rod_chain

NAMES = ("mass_matrix", "bias", "acceleration", "balance", "variation", "effectors", "body_points")


def as_function(expression: ca.SX, *symbols: ca.SX) -> ca.Function:
    return ca.Function("f", list(symbols), [expression])


@pytest.mark.parametrize("value", [0.1, 0.1 + 0.2, 1 / 3, float("inf"), float("nan"), 2.0**53])
def test_a_constant_that_may_be_inexact_is_refused(value: float) -> None:
    x = ca.SX.sym("x")
    with pytest.raises(ValueError, match="constant"):
        tape(as_function(x * value, x))


def test_an_operation_without_exact_reading_is_refused() -> None:
    x = ca.SX.sym("x")
    with pytest.raises(ValueError, match="operation"):
        tape(as_function(ca.fmax(x, 2 * x + 1), x))


def test_inputs_are_numbered_through_all_columns() -> None:
    x, y = ca.SX.sym("x", 2), ca.SX.sym("y", 3)
    program = tape(as_function(ca.vertcat(x[1] - y[2], x[0] / y[0], -7 * y[1]), x, y))
    values = [Fraction(i + 2, 3) for i in range(5)]
    found = program.evaluate([ball(v) for v in values], BallEvaluator())
    expected = [values[1] - values[4], values[0] / values[2], -7 * values[3]]
    with mp.workdps(DIGITS):
        numbers = [mp.mpf(e.numerator) / e.denominator for e in expected]
        assert all(contains(f, e) for f, e in zip(found, numbers, strict=True))


def test_every_operation_has_its_meaning_in_balls() -> None:
    x, y = ca.SX.sym("x"), ca.SX.sym("y")
    expression = ca.vertcat(
        x + y, x - y, x * y, x / y, -x, x**2, ca.sqrt(x), ca.sin(x), ca.cos(x), ca.tan(x),
        ca.fabs(-x), 1 / x, 2 * x,
    )  # fmt: skip
    program = tape(as_function(expression, x, y))
    names = {name for name, _ in program.nodes}
    assert {"sq", "sqrt", "sin", "cos", "tan", "fabs", "inv", "twice", "neg", "div"} <= names
    with mp.workdps(DIGITS):
        a, b = mp.mpf(7) / 5, mp.mpf(3) / 11
        expected = [
            a + b, a - b, a * b, a / b, -a, a**2, mp.sqrt(a), mp.sin(a), mp.cos(a), mp.tan(a),
            a, 1 / a, 2 * a,
        ]  # fmt: skip
        found = program.evaluate([ball(Fraction(7, 5)), ball(Fraction(3, 11))], BallEvaluator())
        assert all(contains(f, e) for f, e in zip(found, expected, strict=True))


def awkward() -> RobotModel:
    """Densities 0.1 + 0.2, angles of 30 degrees, sqrt(2), integer angles, masses and lengths."""
    builder = Builder()
    table = builder.table
    thirty = table.binary(
        "*", builder.number(30), table.binary("/", table.pi(), builder.number(180))
    )
    frame = builder.joint(builder.turn(WORLD, "z", thirty))
    frame = builder.link(frame, builder.parameter(), density=Fraction("0.1") + Fraction("0.2"))
    builder.point(frame, builder.number(3))
    frame = builder.turn(frame, "z", builder.number(1))
    frame = builder.joint(frame, "x", "prismatic")
    builder.point(frame, builder.number(2))
    root = table.unary("sqrt", builder.number(2))
    frame = builder.link(builder.joint(frame), table.binary("/", root, builder.number(7)))
    frame = builder.turn(frame, "z", table.unary("tan", builder.number(5)))
    frame = builder.link(frame, table.binary("/", builder.parameter(), builder.number(3)))
    builder.effector(frame)
    return builder.build()


def slides() -> RobotModel:
    """Constant integer mass matrices, whose factors are not integers."""
    builder, frame = Builder(), WORLD
    for mass in (5, 3, 7):
        frame = builder.joint(frame, "x", "prismatic")
        builder.point(frame, builder.number(mass))
    builder.effector(builder.link(builder.joint(frame), builder.number(3)))
    return builder.build()


def space() -> RobotModel:
    """Integer and rational tensors in space."""
    builder = Builder(dimension=3)
    waist = builder.joint(WORLD, "z")
    builder.solid(waist, 3, (1, 0, 2), (4, 5, 6, 1, 0, Fraction(1, 3)))
    arm = builder.joint(builder.move(waist, "z", builder.number(1)), "-y")
    arm = builder.turn(arm, "y", builder.number(2))
    builder.effector(builder.link(arm, builder.number(3), density=11))
    return builder.build()


ROBOTS = {
    "awkward": awkward, "slides": slides, "space": space, "rods": lambda: rod_chain(3),
    "driven": lambda: driven(rod_chain(2)), "driven in space": lambda: driven(space()),
}  # fmt: skip


def point(graph: RobotGraph, name: str, seed: int) -> list[Fraction]:
    """A rational point of a function's inputs, without the constants."""
    rng = np.random.default_rng(seed)
    sizes = [getattr(graph, name).size1_in(i) for i in range(getattr(graph, name).n_in() - 1)]
    return [Fraction(int(rng.integers(30, 150)), 97) for _ in range(sum(sizes))]


@pytest.mark.parametrize("name", NAMES)
@pytest.mark.parametrize("robot", sorted(ROBOTS))
def test_graphs_hold_no_inexact_constant_and_balls_enclose_the_exact_value(
    robot: str, name: str
) -> None:
    graph = robot_graph(ROBOTS[robot](), (Fraction(0), Fraction("-9.81")))
    program, values = tape(getattr(graph, name)), point(graph, name, 1)
    with working_precision(53):
        balls = [*map(ball, values), *map(constant_ball, graph.constants)]
        found = program.evaluate(balls, BallEvaluator())
    function = getattr(graph, name)
    floats, start = [], 0
    for i in range(function.n_in() - 1):
        size = function.size1_in(i)
        floats.append(np.array([float(v) for v in values[start : start + size]]))
        start += size
    doubles = np.asarray(function(*floats, constants_of(graph)).full()).ravel(order="F")
    with mp.workdps(DIGITS):
        numbers = [mp.mpf(v.numerator) / v.denominator for v in values]
        numbers += [exact(constant) for constant in graph.constants]
        expected = program.evaluate(numbers, Multiprecision())
        assert all(contains(f, e) for f, e in zip(found, expected, strict=True))
    np.testing.assert_allclose(doubles, [float(e) for e in expected], rtol=1e-9, atol=1e-9)


def test_the_ball_reading_encloses_the_independent_formula() -> None:
    """M of the rod chain by hand at 60 digits, with a density that no double holds."""
    density, lengths, angles = Fraction("0.1") + Fraction("0.2"), ("1.1", "0.7"), ("0.3", "0.4")
    graph = robot_graph(rod_chain(2, [density, density]))
    values = [*map(Fraction, angles), *map(Fraction, lengths)]
    with working_precision(100):
        balls = [*map(ball, values), *map(constant_ball, graph.constants)]
        found = tape(graph.mass_matrix).evaluate(balls, BallEvaluator())
    with mp.workdps(DIGITS):
        r, (l1, l2), q2 = mp.mpf(3) / 10, map(mp.mpf, lengths), mp.mpf(angles[1])
        d12 = r * (l2**3 / 3 + l1 * l2**2 / 2 * mp.cos(q2))
        d11 = r * (l1**3 / 3 + l1**2 * l2 + l2**3 / 3 + l1 * l2**2 * mp.cos(q2))
        expected = [d11, d12, d12, r * l2**3 / 3]
        assert all(contains(f, e) for f, e in zip(found, expected, strict=True))
        assert all(f.rad() < 1e-25 for f in found)


def test_a_folded_double_would_have_been_noticed() -> None:
    """The enclosures are tight enough to exclude the robot of density 0.1 + 0.2 in doubles."""
    graph = robot_graph(rod_chain(1, [Fraction(3, 10)]))
    with working_precision(100):
        balls = [ball(0), ball(1), *map(constant_ball, graph.constants)]
        (found,) = tape(graph.mass_matrix).evaluate(balls, BallEvaluator())
        assert found.contains(ball(Fraction(1, 10)))
        assert not found.contains(ball(Fraction(0.1 + 0.2) / 3))


def test_floats_agree_with_the_formula_at_the_same_point() -> None:
    mass, _, _ = chain_dynamics(
        np.array([1.1, 0.7]), np.array([0.3, 0.3]), np.array([0.3, 0.4]), np.zeros(2), (0, 0)
    )
    graph = robot_graph(rod_chain(2, [Fraction(3, 10)] * 2))
    found = graph.mass_matrix(np.array([0.3, 0.4]), np.array([1.1, 0.7]), constants_of(graph))
    np.testing.assert_allclose(np.asarray(found.full()), mass, rtol=1e-12)
