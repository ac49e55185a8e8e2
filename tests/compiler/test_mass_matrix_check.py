"""Positive definiteness of M over whole boxes: robots by hand, and brute force."""

from __future__ import annotations

import random
from dataclasses import replace
from fractions import Fraction
from itertools import product

import casadi as ca
import mpmath as mp
import numpy as np
import pytest
from flint import arb

from compiler.dynamics.equations_of_motion import robot_graph
from compiler.expressions.evaluators.exact import PiLinear
from compiler.expressions.evaluators.intervals import Ends
from compiler.expressions.tape import tape
from compiler.mass_matrix.bodies_at_rest import BodyMotions, RestTest
from compiler.mass_matrix.boxes import Box, Side, domains, hull, robot_box
from compiler.mass_matrix.mass_matrix_check import Definiteness, mass_matrix_check
from compiler.robots.robot import WORLD, Joint, RobotModel
from grammar_lang import ir
from tests.oracles import robots
from tests.oracles.exact_chain import DIGITS, Multiprecision, exact
from tests.oracles.robots import Builder, interval, point_chain, rod_chain

HALF = Fraction(1, 2)


def number(value: PiLinear) -> mp.mpf:
    pis = mp.mpf(value.pis.numerator) / value.pis.denominator
    return mp.mpf(value.rational.numerator) / value.rational.denominator + pis * mp.pi


def fraction(value: Fraction) -> mp.mpf:
    return mp.mpf(value.numerator) / value.denominator


def choices(*values: Fraction | int) -> ir.Choices:
    return ir.Choices(tuple(ir.Num(Fraction(value)) for value in values))


# --- enclosures ---------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("low", "high", "regular"), [(-3, 1, False), (-5, 1, False), (-3, -1, True)]
)
def test_a_kink_has_both_slopes(low: int, high: int, regular: bool) -> None:
    """1 - (|z| + z) is 1 left of zero and falls to -1 at z = 1; at the middle all slopes are 0."""
    z = ca.SX.sym("z")
    motions = BodyMotions(rod_chain(1), z, ca.SX(0, 1), (), (), ())
    test = RestTest(motions, 1 - (ca.fabs(z) + z), ca.SX(0, 1), ((),), 0)
    box = ((Ends(arb(low), arb(high)),),)
    assert test.holds(box, np.eye(1)) is regular


# --- robots ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("links", range(1, 7))
def test_chains_of_rods_are_proved_joint_by_joint(links: int) -> None:
    found = mass_matrix_check(rod_chain(links))
    assert (found.status, found.boxes, found.groups) == ("proved", links, links)


@pytest.mark.parametrize("links", range(1, 6))
def test_chains_of_points_are_proved(links: int) -> None:
    assert mass_matrix_check(point_chain(links)).status == "proved"


def contains(domain: ir.Interval | ir.Choices | None, value: mp.mpf) -> bool:
    """By 60 digits; an unlimited range contains everything."""
    slack = mp.mpf(10) ** (15 - DIGITS)
    if domain is None:
        return True
    if isinstance(domain, ir.Choices):
        return any(abs(closed(choice) - value) < slack for choice in domain.values)
    return bool(closed(domain.lower) - slack <= value <= closed(domain.upper) + slack)


def closed(expression: ir.Expr) -> mp.mpf:
    assert isinstance(expression, ir.Num)
    return fraction(expression.value)


def confirmed(model: RobotModel, found: Definiteness) -> None:
    """The witness holds at 60 digits and its point is in every range."""
    witness = found.witness
    assert witness is not None
    assert any(witness.vector)
    graph, n = robot_graph(model), len(model.dofs)
    with mp.workdps(DIGITS):
        for (domain, _), value in zip(domains(model), witness.point, strict=False):
            assert contains(domain, number(value))
        if not witness.identically:
            inputs = [*map(number, witness.point), *map(exact, graph.constants)]
            entries = tape(graph.mass_matrix).evaluate(inputs, Multiprecision())
            vector = [fraction(item) for item in witness.vector]
            pairs = product(range(n), repeat=2)
            form = sum(vector[i] * vector[j] * entries[j * n + i] for i, j in pairs)
            assert form <= mp.mpf(10) ** (15 - DIGITS)
    if witness.identically:
        rng, floats = random.Random(1), np.array([float(item) for item in witness.vector])
        for _ in range(20):
            point = np.array([sample(side, rng) for side in robot_box(model)])
            matrix = robots.evaluate(graph, "mass_matrix", point[:n], point[n:])
            assert floats @ matrix @ floats <= 1e-9 * float(np.abs(matrix).sum())


def wrist(
    low: Fraction | int, high: Fraction | int, length: ir.Interval | None = None
) -> RobotModel:
    """Axes z, y, z through one point, the first two links without mass."""
    builder = Builder(3)
    frame = builder.joint(WORLD, "z")
    frame = builder.joint(frame, "y", range_=interval(low, high))
    frame = builder.joint(frame, "z", range_=interval(-2, 2))
    frame = builder.move(frame, "z", builder.parameter(HALF, 2))
    builder.solid(frame, 1, (0, 0, 0), (1, 2, 3, 0, 0, 0))
    return builder.build()


@pytest.mark.parametrize(
    ("low", "high", "pose"), [(-1, 1, 0), (0, 1, 0), (-3, 4, 0), (HALF, Fraction(7, 2), 1)]
)
def test_a_wrist_fails_in_its_singular_pose(low: Fraction, high: Fraction, pose: int) -> None:
    model = wrist(low, high)
    found = mass_matrix_check(model)
    assert found.status == "fails"
    confirmed(model, found)
    assert found.witness is not None
    # Outer axes parallel: the middle angle is a multiple of pi, which is found exactly.
    assert found.witness.point[1] == PiLinear(Fraction(0), Fraction(pose))


def test_a_wrist_without_its_singular_pose_is_proved() -> None:
    assert mass_matrix_check(wrist(Fraction(1, 5), 3)).status == "proved"


def test_a_singular_pose_that_is_not_met_exactly_is_never_proved() -> None:
    # The point is on the first axis where cos q2 + 2 sin q2 = 0: no number a + b pi.
    builder = Builder(3)
    frame = builder.joint(WORLD, "z")
    frame = builder.joint(frame, "y", range_=interval(2, 3))
    frame = builder.move(frame, "x", builder.number(1))
    frame = builder.move(frame, "z", builder.number(2))
    builder.point(frame, builder.number(1))
    found = mass_matrix_check(builder.build())
    assert found.status == "undecided"
    (part,) = found.left[1]
    assert float(part.low) <= np.pi - np.arctan(1 / 2) <= float(part.high)
    assert float(part.high - part.low) < 1e-3
    assert "undecided" in found.text
    assert "q2 in [2.67" in found.text
    assert found.boxes < 500


def l_shaped(links: int) -> RobotModel:
    builder, frame = Builder(3), WORLD
    for axis in ("z", "y", "-z", "x")[:links]:
        frame = builder.joint(frame, axis)  # type: ignore[arg-type]
        frame = builder.link(frame, builder.parameter(), "x")
        frame = builder.link(frame, builder.parameter(), "y")
        frame = builder.turn(frame, "x", builder.parameter(0, 1, "angle"))
    return builder.build()


@pytest.mark.parametrize("links", [1, 2, 3, 4])
def test_l_shaped_links_in_space_are_proved(links: int) -> None:
    assert mass_matrix_check(l_shaped(links)).status == "proved"


def sliding(middle: bool) -> RobotModel:
    builder = Builder()
    frame = builder.joint(WORLD)
    frame = builder.joint(frame, "x", "prismatic")
    if middle:
        frame = builder.link(frame, builder.parameter())
    else:
        builder.point(frame, builder.number(2))
    frame = builder.joint(frame)
    builder.link(frame, builder.parameter())
    return builder.build()


def test_an_unlimited_prismatic_joint_is_handled() -> None:
    # The rod keeps its inertia however far it slides; a point has none on the axis.
    assert mass_matrix_check(sliding(middle=True)).status == "proved"
    model = sliding(middle=False)
    found = mass_matrix_check(model)
    assert found.status == "fails"
    confirmed(model, found)
    limited = replace(
        model, dofs=(model.dofs[0], replace(model.dofs[1], range=interval(HALF, 2)), model.dofs[2])
    )
    assert mass_matrix_check(limited).status == "proved"


def test_a_length_that_may_be_zero_is_found() -> None:
    for domain in (interval(0, 2), choices(1, 0, 2)):
        model = rod_chain(2)
        first = replace(model.parameters[0], domain=domain)
        model = replace(model, parameters=(first, model.parameters[1]))
        found = mass_matrix_check(model)
        assert found.status == "fails"
        confirmed(model, found)
        assert found.witness is not None
        assert found.witness.point[2] == PiLinear(Fraction(0))


def jointed_without_mass(domain: ir.Interval | ir.Choices) -> RobotModel:
    """Two joints a parameter apart, and a rod on the second: singular only where it is zero."""
    builder = Builder()
    frame = builder.move(builder.joint(WORLD), "x", builder.parameter())
    builder.link(builder.joint(frame), builder.parameter())
    model = builder.build()
    first = replace(model.parameters[0], domain=domain)
    return replace(model, parameters=(first, model.parameters[1]))


def test_finite_sets_are_enumerated() -> None:
    apart = mass_matrix_check(jointed_without_mass(choices(-1, 1)))
    assert apart.status == "proved"
    # As a range the same values contain zero.
    assert mass_matrix_check(jointed_without_mass(interval(-1, 1))).status == "fails"


def with_inertia(value: Fraction | int) -> RobotModel:
    """A point with an inertia of its own at one metre, then a rod."""
    builder = Builder()
    frame = builder.move(builder.joint(WORLD), "x", builder.parameter(1, Fraction(3, 2)))
    builder.solid(frame, 1, (0, 0, 0), (value,))
    builder.link(builder.joint(frame), builder.parameter(1, Fraction(3, 2)))
    return builder.build()


def test_solids_with_a_negative_inertia() -> None:
    """Bodies at rest no longer follow from v'Mv = 0: never proved, though M is definite at -1/8."""
    assert mass_matrix_check(with_inertia(Fraction(-1, 8))).status == "undecided"
    for value in (-4, -1000):
        model = with_inertia(value)
        found = mass_matrix_check(model)
        assert found.status == "fails", value
        confirmed(model, found)


def spinning(*tensor: int) -> RobotModel:
    """A ball joint of three axes that is never singular, with a solid."""
    builder = Builder(3)
    frame = builder.joint(WORLD, "z")
    frame = builder.joint(frame, "y", range_=interval(1, 2))
    frame = builder.joint(frame, "z")
    builder.solid(frame, 1, (0, 0, 0), tensor)
    return builder.build()


@pytest.mark.parametrize(
    ("tensor", "status"),
    [
        ((2, 3, 4, 0, 0, 0), "proved"),
        ((2, 3, 4, 1, 1, 1), "proved"),
        ((2, 3, 4, 3, 0, 0), "fails"),
        ((2, 3, -1, 0, 0, 0), "fails"),
        ((0, 3, 4, 0, 0, 0), "fails"),
    ],
)
def test_inertia_tensors(tensor: tuple[int, ...], status: str) -> None:
    model = spinning(*tensor)
    found = mass_matrix_check(model)
    assert found.status == status
    if status == "fails":
        confirmed(model, found)


def test_a_joint_that_moves_only_an_effector_fails_throughout() -> None:
    builder = Builder()
    frame = builder.link(builder.joint(WORLD), builder.parameter())
    builder.effector(builder.joint(frame))
    found = mass_matrix_check(builder.build())
    assert found.status == "fails"
    assert found.witness is not None
    assert found.witness.identically
    assert found.witness.vector == (0, 1)


def test_branches_are_proved() -> None:
    builder = Builder()
    trunk = builder.joint(WORLD)
    for sign in ("y", "-y"):
        frame = builder.move(trunk, sign, builder.parameter())
        for _ in range(2):
            frame = builder.link(builder.joint(frame), builder.parameter())
    found = mass_matrix_check(builder.build())
    assert found.status == "proved"


def test_a_robot_without_joints_is_proved() -> None:
    builder = Builder()
    builder.link(WORLD, builder.parameter())
    assert mass_matrix_check(builder.build()).status == "proved"


# --- singular everywhere, or at one point ---------------------------------------------------------


def degrees(builder: Builder, count: int) -> int:
    return builder.table.binary("*", builder.table.pi(), builder.number(Fraction(count, 180)))


def test_two_joints_on_one_axis_fail_everywhere() -> None:
    """M11 = M12 = M22 = 0.09 by hand: only q1 + q2 moves the point."""
    builder = Builder()
    frame = builder.turn(WORLD, "z", degrees(builder, 30))
    frame = builder.turn(builder.joint(frame), "z", degrees(builder, 30))
    frame = builder.move(builder.joint(frame), "x", builder.number(Fraction(3, 10)))
    builder.point(frame, builder.number(1))
    model = builder.build()
    found = mass_matrix_check(model)
    confirmed(model, found)
    assert found.witness is not None
    expected = "not positive definite anywhere: v'Mv = 0 for v = (1, -1) at every point of the box"
    assert found.text.startswith(expected)


def test_joints_on_one_axis_in_the_middle_of_a_chain_fail_everywhere() -> None:
    """Axes 2 and 3 coincide, the lengths are parameters: v = (0, 1, -1) by hand."""
    builder = Builder()
    frame = builder.link(builder.joint(WORLD), builder.parameter())
    frame = builder.turn(builder.joint(frame), "z", degrees(builder, 45))
    builder.link(builder.joint(frame), builder.parameter())
    model = builder.build()
    found = mass_matrix_check(model)
    confirmed(model, found)
    assert found.witness is not None
    assert found.witness.identically
    assert found.witness.vector == tuple(map(Fraction, (0, 1, -1)))


def test_a_coordinate_that_cancels_fails_everywhere() -> None:
    """Out by d, half a turn, back by d: the point stays at the origin."""
    builder = Builder()
    frame = builder.joint(WORLD, "x", "prismatic", interval(-1, 1))
    frame = builder.turn(frame, "z", degrees(builder, 180))
    frame = builder._step(frame, Joint(0, 0, 1))
    builder.point(frame, builder.number(1))
    model = builder.build()
    found = mass_matrix_check(model)
    assert found.status == "fails"
    assert "anywhere: v'Mv = 0 for v = (1) at every point" in found.text


@pytest.mark.parametrize("low", [-1, Fraction(-1, 3), Fraction(-2, 7)])
@pytest.mark.parametrize(("length", "status"), [(1, "fails"), (Fraction(3, 4), "proved")])
def test_a_singular_natural_point_is_found(low: Fraction, length: Fraction, status: str) -> None:
    """A point at R(q) (2, 0) + R(2q) (-l, 0): M11 = 4 + 4 l^2 - 8 l cos q, zero at l = 1, q = 0."""
    builder = Builder()
    frame = builder.joint(WORLD, "z", range_=interval(low, 1))
    frame = builder._step(builder.move(frame, "x", builder.number(2)), Joint(0, 2, 1))
    frame = builder.turn(frame, "z", degrees(builder, 180))
    builder.point(builder.move(frame, "x", builder.number(length)), builder.number(1))
    model = builder.build()
    found = mass_matrix_check(model)
    assert found.status == status
    if status == "fails":
        confirmed(model, found)
        assert found.witness is not None
        assert found.witness.point == (PiLinear(Fraction(0)),)
        assert not found.witness.identically
        assert "anywhere" not in found.text


# --- brute force ----------------------------------------------------------------------------------


def random_robot(rng: random.Random) -> RobotModel:
    """Joints of both kinds, some of which carry nothing; some lengths of either sign."""
    dimension = rng.choice([2, 3])
    builder, frame = Builder(dimension), WORLD
    axes = ["x", "y", "z"] if dimension == 3 else ["z"]
    for _ in range(rng.randint(1, 3)):
        kind = rng.choice(["revolute", "revolute", "prismatic"])
        axis = rng.choice(axes if kind == "revolute" else ["x", "y"])
        low = Fraction(rng.randint(-6, 4), 4)
        frame = builder.joint(
            frame,
            axis,  # type: ignore[arg-type]
            kind,  # type: ignore[arg-type]
            interval(low, low + Fraction(rng.randint(1, 4), 4)),
        )
        low = Fraction(rng.choice([-1, 1, 1, 2]), 2)
        length = builder.parameter(low, low + Fraction(rng.randint(0, 3), 4))
        body = rng.choice(["rod", "point", "solid", "none"])
        if body == "rod":
            builder.rod(frame, rng.choice(["x", "y"]), length)
        frame = builder.move(frame, rng.choice(["x", "y"]), length)
        if body == "point":
            builder.point(frame, builder.number(2))
        if body == "solid":
            tensor = (1,) if dimension == 2 else (1, 2, 2, 0, Fraction(1, 2), 0)
            builder.solid(frame, 1, (Fraction(1, 4), 0, 0), tensor)
    return builder.build()


def sample(side: Side, rng: random.Random) -> float:
    ends = hull(side)
    return rng.uniform(max(float(ends.low), -3.0), min(float(ends.high), 3.0))


def least_eigenvalue(model: RobotModel, box: Box, rng: random.Random) -> float:
    """Of M scaled to a unit diagonal, at random points and corners."""
    graph, n, least = robot_graph(model), len(model.dofs), np.inf
    for _ in range(60):
        point = np.array([sample(side, rng) for side in box])
        matrix = robots.evaluate(graph, "mass_matrix", point[:n], point[n:])
        diagonal = np.diag(matrix)
        if not np.all(diagonal > 0):
            return float(diagonal.min())
        scale = 1 / np.sqrt(diagonal)
        least = min(least, float(np.linalg.eigvalsh(matrix * np.outer(scale, scale))[0]))
    return least


def test_random_robots_agree_with_eigenvalues() -> None:
    rng = random.Random(7)
    count = {"proved": 0, "fails": 0, "undecided": 0}
    for _ in range(60):
        model = random_robot(rng)
        found = mass_matrix_check(model, budget=150)
        count[found.status] += 1
        least = least_eigenvalue(model, robot_box(model), rng)
        if found.status == "proved":
            assert least > 0, model
        if least < -1e-9:
            assert found.status != "proved", model
        if found.status == "fails":
            confirmed(model, found)
    assert min(count["proved"], count["fails"]) >= 10, count
