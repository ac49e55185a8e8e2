"""Positive definiteness over boxes: the printed and the corrected D, robots, and brute force."""

from __future__ import annotations

import random
from collections.abc import Sequence
from dataclasses import replace
from fractions import Fraction

import casadi as ca
import mpmath as mp
import numpy as np
import pytest

from compiler.definiteness.boxes import Box, Side, domain_side, range_side
from compiler.definiteness.indefiniteness import indefinite_vector
from compiler.definiteness.mass_matrix_check import mass_matrix_check, robot_box
from compiler.definiteness.positive_definite import Definiteness, positive_definite
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.expressions.evaluators.exact import PiLinear
from compiler.expressions.scalars import Constant, PiConstant
from compiler.expressions.tape import tape
from compiler.robots.robot import WORLD, Joint, RobotModel
from grammar_lang import ir
from tests.oracles import robots
from tests.oracles.exact_chain import DIGITS, Multiprecision, exact
from tests.oracles.robots import Builder, interval, point_chain, rod_chain

HALF, THIRD = Fraction(1, 2), Fraction(1, 3)
TURN = domain_side(None, angle=True)


def number(value: PiLinear) -> mp.mpf:
    pis = mp.mpf(value.pis.numerator) / value.pis.denominator
    return mp.mpf(value.rational.numerator) / value.rational.denominator + pis * mp.pi


def fraction(value: Fraction) -> mp.mpf:
    return mp.mpf(value.numerator) / value.denominator


def choices(*values: Fraction | int) -> ir.Choices:
    return ir.Choices(tuple(ir.Num(Fraction(value)) for value in values))


# --- the paper's D --------------------------------------------------------------------------------


def inertia(first: str) -> ca.Function:
    """The D of the case study; the first length in D12 is l1 as printed, l2 as it should be."""
    z, k = ca.SX.sym("z", 3), ca.SX.sym("k", 2)
    l1, l2, cosine = z[0], z[1], ca.cos(z[2])
    third, half = k[0], k[1]
    one = {"l1": l1, "l2": l2}[first]
    d11 = third * (l1**3 + l2**3 + 3 * l1**2 * l2) + l2**2 * l1 * cosine
    d12 = third * one**3 + half * l2**2 * l1 * cosine
    matrix = ca.vertcat(ca.horzcat(d11, d12), ca.horzcat(d12, third * l2**3))
    return ca.Function("D", [z, k], [matrix])


def inertia_form(first: str, point: Sequence[mp.mpf], vector: Sequence[mp.mpf]) -> mp.mpf:
    """v'Dv in mpmath, written from the paper again."""
    l1, l2, angle = point
    off = {"l1": l1, "l2": l2}[first] ** 3 / 3 + l2**2 * l1 / 2 * mp.cos(angle)
    d11 = (l1**3 + l2**3 + 3 * l1**2 * l2) / 3 + l2**2 * l1 * mp.cos(angle)
    a, b = vector
    return d11 * a * a + 2 * off * a * b + l2**3 / 3 * b * b


def checked(first: str, low: Fraction | int, high: Fraction | int, budget: int) -> Definiteness:
    box = (range_side(low, high), range_side(low, high), TURN)
    constants = (Constant(THIRD), Constant(HALF))
    names = ("l1", "l2", "q2")
    return positive_definite(inertia(first), constants, box, names=names, budget=budget)


def test_the_printed_inertia_fails_on_a_reported_box() -> None:
    found = checked("l1", HALF, 5, 100)
    assert (found.status, found.symmetry) == ("fails", "identity")
    witness = found.witness
    assert witness is not None
    assert found.box is not None
    assert witness.throughout
    rng = random.Random(1)
    with mp.workdps(DIGITS):
        vector = [fraction(item) for item in witness.vector]
        assert inertia_form("l1", [number(v) for v in witness.point], vector) <= 0
        for _ in range(200):
            point = [mp.mpf(rng.uniform(float(s.low or 0), float(s.high or 0))) for s in found.box]
            assert inertia_form("l1", point, vector) <= 0
            # The same vector is no witness against the corrected matrix.
            assert inertia_form("l2", point, vector) > 0
    assert "not positive definite" in found.text
    assert "l1 in [" in found.text


def test_the_printed_inertia_fails_at_given_lengths() -> None:
    box = (range_side(1, 1), range_side(HALF, HALF), TURN)
    found = positive_definite(inertia("l1"), (Constant(THIRD), Constant(HALF)), box)
    assert found.status == "fails"


def test_the_corrected_inertia_is_proved_on_a_small_box() -> None:
    found = checked("l2", 1, 2, 2000)
    assert (found.status, found.symmetry) == ("proved", "identity")


@pytest.mark.slow
def test_the_corrected_inertia_is_proved_on_the_whole_box() -> None:
    assert checked("l2", HALF, 5, 8000).status == "proved"


def test_a_budget_that_is_used_up_decides_nothing() -> None:
    found = checked("l2", HALF, 5, 20)
    assert (found.status, found.boxes) == ("undecided", 20)
    assert found.witness is None
    assert found.box is not None
    assert "20 boxes" in found.reason


def test_a_matrix_that_is_not_symmetric_is_judged_by_its_symmetric_part() -> None:
    z, k = ca.SX.sym("z", 1), ca.SX.sym("k", 0)
    skew = ca.vertcat(ca.horzcat(1, 2 + z), ca.horzcat(-2, 1))
    function = ca.Function("f", [z, k], [skew])
    found = positive_definite(function, (), (range_side(-1, 1),))
    assert (found.status, found.symmetry) == ("proved", "not shown")
    assert positive_definite(function, (), (range_side(-1, 3),)).status == "fails"


# --- robots ---------------------------------------------------------------------------------------


@pytest.mark.parametrize("links", range(1, 7))
def test_chains_of_rods_are_proved_joint_by_joint(links: int) -> None:
    found = mass_matrix_check(rod_chain(links))
    assert (found.status, found.boxes, found.symmetry) == ("proved", links, "construction")


@pytest.mark.parametrize("links", range(1, 6))
def test_chains_of_points_are_proved(links: int) -> None:
    assert mass_matrix_check(point_chain(links)).status == "proved"


def confirmed(model: RobotModel, found: Definiteness) -> None:
    """The witness holds at 60 digits and its point is in every range."""
    witness = found.witness
    assert witness is not None
    assert any(witness.vector)
    graph, n = robot_graph(model), len(model.dofs)
    assert all(
        side.contains(value) for side, value in zip(robot_box(model), witness.point, strict=True)
    )
    with mp.workdps(DIGITS):
        inputs = [*map(number, witness.point), *map(exact, graph.constants)]
        entries = tape(graph.mass_matrix).evaluate(inputs, Multiprecision())
        vector = [fraction(item) for item in witness.vector]
        form = sum(vector[i] * vector[j] * entries[j * n + i] for i in range(n) for j in range(n))
        assert form <= mp.mpf(10) ** (15 - DIGITS)
    if witness.throughout:
        rng, floats = random.Random(1), np.array([float(item) for item in witness.vector])
        for _ in range(20):
            point = np.array([sample(side, rng) for side in witness.box])
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
    assert found.box is not None
    low, high = found.box[1].low, found.box[1].high
    assert low is not None
    assert high is not None
    assert float(low) <= np.pi - np.arctan(1 / 2) <= float(high)
    assert high - low < Fraction(1, 1000)
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
    """Two bodies at rest no longer follow from v'Mv = 0, but M may be definite all the same."""
    found = mass_matrix_check(with_inertia(Fraction(-1, 8)))
    assert found.status == "proved"
    assert "dominant" in found.argument
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
    assert found.witness.throughout
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
    assert found.witness.box == robot_box(model)
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


def test_a_singular_corner_is_found() -> None:
    """M = (a - 1/3)^2 + (b - 1/7)^2 for a >= 1/3 and b <= 1/7: zero in one corner only."""
    z, k = ca.SX.sym("z", 2), ca.SX.sym("k", 2)
    function = ca.Function("f", [z, k], [(z[0] - k[0]) ** 2 + (z[1] - k[1]) ** 2])
    constants = (Constant(THIRD), Constant(Fraction(1, 7)))
    box = (range_side(THIRD, 1), range_side(-1, Fraction(1, 7)))
    found = positive_definite(function, constants, box)
    assert found.status == "fails"
    assert found.witness is not None
    assert found.witness.point == (PiLinear(THIRD), PiLinear(Fraction(1, 7)))


def test_a_singular_pose_with_roots_is_decided_by_algebra() -> None:
    """M = 2 (q c)^2 - 2 q c^2 + (q - 1)^2 with c = cos 45 deg: q^2 - q + (q - 1)^2, zero at 1."""
    z, k = ca.SX.sym("z", 1), ca.SX.sym("k", 1)
    root = ca.cos(k[0] / 4)
    matrix = 2 * (z * root) ** 2 - 2 * z * root * root + (z - 1) ** 2
    function = ca.Function("f", [z, k], [matrix])
    found = positive_definite(function, (PiConstant(),), (range_side(1, 2),))
    assert found.status == "fails"
    assert found.witness is not None
    assert found.witness.point == (PiLinear(Fraction(1)),)


def test_what_is_left_is_said() -> None:
    """A square that vanishes at an irrational point, and nowhere near another part of the box."""
    z, k = ca.SX.sym("z", 1), ca.SX.sym("k", 0)
    function = ca.Function("f", [z, k], [(z * z - 2) ** 2])
    found = positive_definite(function, (), (range_side(0, 4),), budget=40)
    assert found.status == "undecided"
    assert found.decided > 0
    assert found.left > 0
    assert "nothing was decided" not in found.text
    # No part of it is proved where it is zero on a line through all parts.
    z = ca.SX.sym("z", 2)
    function = ca.Function("f", [z, k], [(z[0] * z[0] - 2) ** 2])
    found = positive_definite(function, (), (range_side(1, 2), range_side(0, 4)), budget=1)
    assert (found.status, found.decided, found.left) == ("undecided", 0, 2)
    assert "nothing was decided on any part of the box" in found.text
    assert "left:" not in found.text


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
    low = -3.0 if side.low is None else float(side.low)
    return rng.uniform(low, 3.0 if side.high is None else float(side.high))


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


def test_the_matrix_itself_and_the_bodies_agree() -> None:
    """The general test on the graph's M of what the front proves by bodies."""
    model = rod_chain(2)
    domain = interval(1, Fraction(3, 2))
    model = replace(model, parameters=tuple(replace(p, domain=domain) for p in model.parameters))
    graph = robot_graph(model)
    z, k = ca.SX.sym("z", 4), ca.SX.sym("k", len(graph.constants))
    # M does not change with q1, which the graph does not show.
    q = ca.vertcat(0, z[1])
    function = ca.Function("M", [z, k], [graph.mass_matrix(q, z[2:], k)])
    constants: tuple[Constant | PiConstant, ...] = graph.constants
    found = positive_definite(function, constants, robot_box(model))
    assert (found.status, found.symmetry) == ("proved", "identity")
    assert mass_matrix_check(model).status == "proved"


def test_the_exact_factorisation_agrees_with_eigenvalues() -> None:
    rng = random.Random(5)
    seen = {True: 0, False: 0}
    for _ in range(200):
        n = rng.randint(1, 4)
        rows = [[Fraction(rng.randint(-3, 3)) for _ in range(n)] for _ in range(n)]
        matrix = [
            [rows[i][j] + rows[j][i] + (5 if i == j else 0) for j in range(n)] for i in range(n)
        ]
        vector = indefinite_vector(matrix)
        least = np.linalg.eigvalsh(np.array(matrix, dtype=float))[0]
        seen[vector is None] += 1
        if vector is None:
            assert least > 0
            continue
        form = sum(vector[i] * vector[j] * matrix[i][j] for i in range(n) for j in range(n))
        assert form <= 0
        assert any(vector)
        assert least <= 1e-9
    assert min(seen.values()) > 20
