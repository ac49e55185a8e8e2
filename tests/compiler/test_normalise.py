"""Normal forms: what is merged, what is removed, and that nothing moves differently."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from compiler.arrays import Array
from compiler.dynamics.equations_of_motion import robot_graph
from compiler.expressions.evaluators.balls import closed_ball
from compiler.robots.normal_form import normalise
from compiler.robots.robot import WORLD, FrameNode, Joint, RobotModel
from compiler.robots.robot_key import robot_key
from grammar_lang import ir
from tests.oracles.robots import Builder, evaluate, interval
from tests.oracles.some_cases import examples


def bounds(limits: ir.Interval | None) -> tuple[float, float] | None:
    if limits is None:
        return None
    low, high = closed_ball(limits.lower), closed_ball(limits.upper)
    return float(low.mid()), float(high.mid())


def coaxial(second_axis: ir.Axis = "z") -> RobotModel:
    builder = Builder()
    first = builder.joint(WORLD, "z", range_=interval(-1, 2), rate=interval(-5, 5))
    second = builder.joint(first, second_axis, range_=interval(-3, 4), rate=interval(-1, 7))
    builder.effector(builder.link(second, builder.parameter()))
    return builder.build()


def test_coaxial_joints_merge_and_their_ranges_add() -> None:
    robot = normalise(coaxial())
    (dof,) = robot.dofs
    assert dof.symbols == (0, 1)
    assert bounds(dof.range) == (-4.0, 6.0)
    assert bounds(dof.rate) == (-6.0, 12.0)
    assert robot.removed == ()


def test_an_opposite_axis_is_subtracted() -> None:
    (dof,) = normalise(coaxial("-z")).dofs
    assert bounds(dof.range) == (-5.0, 5.0)
    assert bounds(dof.rate) == (-12.0, 6.0)


def test_an_unlimited_joint_makes_the_merged_one_unlimited() -> None:
    builder = Builder()
    second = builder.joint(builder.joint(WORLD, range_=interval(0, 1)))
    builder.effector(builder.link(second, builder.parameter()))
    (dof,) = normalise(builder.build()).dofs
    assert dof.range is None


def test_three_coaxial_joints_and_the_order_of_coordinates() -> None:
    builder = Builder()
    frame = builder.link(builder.joint(WORLD, range_=interval(0, 7)), builder.parameter())
    for low, high in ((-1, 1), (-2, 3), (-4, 5)):
        frame = builder.joint(frame, range_=interval(low, high))
    frame = builder.link(frame, builder.parameter())
    builder.effector(builder.link(builder.joint(frame, range_=interval(0, 9)), builder.parameter()))
    robot = normalise(builder.build())
    assert [dof.symbols for dof in robot.dofs] == [(0,), (2, 3, 4), (6,)]
    assert [bounds(dof.range) for dof in robot.dofs] == [(0.0, 7.0), (-7.0, 9.0), (0.0, 9.0)]


@pytest.mark.parametrize(
    ("between", "merges"),
    [
        ([("turn", "z", "1/2")], True),
        ([("move", "z", "1/3")], True),
        ([("move", "x", "1/5"), ("move", "x", "-1/5")], True),
        ([("turn", "x", "1/5"), ("turn", "x", "-1/5"), ("turn", "z", "1")], True),
        ([("move", "x", "1/5")], False),
        ([("turn", "x", "1/5")], False),
        ([("move", "x", "1/5"), ("turn", "z", "1"), ("move", "x", "-1/5")], False),
    ],
)
def test_rigid_steps_that_commute_with_a_joint_are_nothing_between(
    between: list[tuple[str, str, str]], merges: bool
) -> None:
    builder = Builder(dimension=3)
    frame = builder.joint(WORLD, range_=interval(-1, 1))
    for kind, axis, value in between:
        step = builder.turn if kind == "turn" else builder.move
        frame = step(frame, axis, builder.number(Fraction(value)))
    frame = builder.joint(frame, range_=interval(-1, 1))
    frame = builder.turn(frame, "y", builder.number(Fraction(1, 2)))
    builder.effector(builder.link(frame, builder.number(1)))
    plain = builder.build()
    normal = normalise(plain)
    assert len(normal.dofs) == (1 if merges else 2)
    q = np.array([0.3, -0.8])
    own = np.array([q.sum()]) if merges else q
    np.testing.assert_allclose(
        evaluate(robot_graph(normal), "effectors", own, np.zeros(0)),
        evaluate(robot_graph(plain), "effectors", q, np.zeros(0)),
        atol=1e-12,
    )


def test_joints_with_something_between_or_beside_them_stay() -> None:
    point = Builder()
    first = point.joint(WORLD)
    point.point(first, point.number(1))
    point.effector(point.link(point.joint(first), point.parameter()))
    assert len(normalise(point.build()).dofs) == 2  # a mass between, even though on the axis
    fork = Builder()
    trunk = fork.joint(WORLD)
    for _ in range(2):
        fork.effector(fork.link(fork.joint(trunk), fork.parameter()))
    assert len(normalise(fork.build()).dofs) == 3
    kinds = Builder(dimension=3)
    last = kinds.joint(kinds.joint(WORLD, "z"), "z", "prismatic")
    kinds.effector(kinds.link(last, kinds.parameter()))
    assert len(normalise(kinds.build()).dofs) == 2


def test_prismatic_joints_merge_too() -> None:
    builder = Builder()
    first = builder.joint(WORLD, "x", "prismatic", interval(0, 1))
    second = builder.joint(first, "-x", "prismatic", interval(-2, 5))
    builder.effector(builder.link(second, builder.parameter()))
    (dof,) = normalise(builder.build()).dofs
    assert dof.kind == "prismatic"
    assert bounds(dof.range) == (-5.0, 3.0)


def test_a_joint_behind_everything_is_removed_and_reported() -> None:
    builder = Builder()
    tip = builder.link(builder.joint(WORLD), builder.parameter())
    builder.effector(tip)
    builder.joint(tip)
    robot = normalise(builder.build())
    assert [dof.symbols for dof in robot.dofs] == [(0,)]
    assert robot.removed == (2,)


def test_a_joint_with_the_effector_on_its_axis_is_removed() -> None:
    builder = Builder()
    wrist = builder.joint(builder.link(builder.joint(WORLD), builder.parameter()))
    builder.effector(wrist)
    robot = normalise(builder.build())
    assert len(robot.dofs) == 1
    assert robot.removed == (2,)


def test_in_space_a_shift_along_the_axis_moves_nothing() -> None:
    builder = Builder(dimension=3)
    arm = builder.link(builder.joint(WORLD, "y"), builder.parameter())
    roll = builder.joint(arm, "x", range_=interval(1, 2))
    builder.effector(builder.link(builder.turn(roll, "x", builder.number(1)), builder.parameter()))
    robot = normalise(builder.build())
    assert len(robot.dofs) == 1
    assert robot.removed == (2,)


def test_in_space_a_shift_across_the_axis_or_a_later_joint_moves_something() -> None:
    across = Builder(dimension=3)
    roll = across.joint(across.link(across.joint(WORLD, "y"), across.parameter()), "x")
    across.effector(across.move(roll, "z", across.number(1)))
    assert len(normalise(across.build()).dofs) == 2
    turned = Builder(dimension=3)
    roll = turned.joint(turned.link(turned.joint(WORLD, "y"), turned.parameter()), "x")
    turned.effector(turned.link(turned.joint(roll, "z"), turned.parameter()))
    assert len(normalise(turned.build()).dofs) == 3
    # A roll whose link is turned off the axis by a rigid angle.
    rigid = Builder(dimension=3)
    roll = rigid.turn(rigid.joint(WORLD, "x"), "y", rigid.number(1))
    rigid.effector(rigid.link(roll, rigid.parameter()))
    assert len(normalise(rigid.build()).dofs) == 1


def test_a_solid_or_a_thick_thing_off_the_axis_is_moved() -> None:
    builder = Builder()
    wrist = builder.joint(builder.link(builder.joint(WORLD), builder.parameter()))
    builder.effector(wrist)
    builder.solid(wrist, 1, (0, 0, 0), [1])
    assert len(normalise(builder.build()).dofs) == 2


def arm(
    *pieces: str, range_: tuple[int, int] = (-3, 3), box: tuple[int, int] = (1, 5)
) -> RobotModel:
    """B and then pieces JO, L, EN of the running example."""
    builder, frame = Builder(), WORLD
    builder.symbol()
    for piece in pieces:
        builder.symbol()  # the edge
        if piece == "JO":
            frame = builder.joint(frame, range_=interval(*range_))
        elif piece == "L":
            frame = builder.link(frame, builder.parameter(*box))
        else:
            builder.symbol()
            builder.effector(frame)
    return builder.build()


def key(model: RobotModel) -> str:
    return robot_key(normalise(model))


def test_keys_of_equal_robots_are_equal() -> None:
    assert key(arm("JO", "L", "JO", "EN")) == key(arm("JO", "L", "EN"))
    assert key(arm("JO", "L", "EN")) == key(arm("JO", "L", "EN", "JO"))
    assert key(arm("JO", "EN", "L")) != key(arm("JO", "L", "EN"))


def test_keys_of_different_robots_differ() -> None:
    reference = arm("JO", "L", "JO", "L", "EN")
    others = [
        arm("JO", "L", "L", "EN"),
        arm("JO", "L", "EN"),
        arm("JO", "L", "JO", "L", "EN", range_=(-3, 2)),
        arm("JO", "L", "JO", "L", "EN", box=(1, 4)),
        arm("JO", "JO", "L", "JO", "L", "EN"),
        arm("JO", "L", "JO", "EN", "L"),
        arm("JO", "L", "JO", "L", "EN", "EN"),
        replace(reference, dimension=3),
    ]
    keys = [key(model) for model in (reference, *others)]
    assert len(set(keys)) == len(keys)


def test_the_key_tells_densities_and_axes_apart() -> None:
    def variant(density: int, axis: ir.Axis, side: str) -> str:
        builder = Builder()
        frame = builder.link(builder.joint(WORLD, axis), builder.parameter(), side, density)
        builder.effector(frame)
        return key(builder.build())

    keys = {variant(*v) for v in ((1, "z", "x"), (2, "z", "x"), (1, "-z", "x"), (1, "z", "y"))}
    assert len(keys) == 4


def test_rigid_steps_merge() -> None:
    builder = Builder()
    frame = builder.move(builder.joint(WORLD), "x", builder.number(1))
    frame = builder.move(builder.move(frame, "y", builder.number(2)), "x", builder.number(3))
    frame = builder.turn(builder.turn(frame, "z", builder.number(1)), "-z", builder.number(3))
    builder.effector(frame)
    other = Builder()
    frame = other.move(other.joint(WORLD), "y", other.number(2))
    frame = other.turn(other.move(frame, "x", other.number(4)), "z", other.number(-2))
    other.effector(frame)
    assert key(builder.build()) == key(other.build())


def test_a_coordinate_that_occurs_twice_is_not_merged_away() -> None:
    """One joint drives two arms; behind one of its copies another joint follows directly."""
    builder = Builder()
    first = builder.joint(WORLD)
    builder.effector(builder.link(builder.joint(first), builder.number(1)))
    base = builder.move(WORLD, "y", builder.number(2))
    builder.frames.append(FrameNode(base, builder.frames[first].step))
    builder.effector(builder.link(len(builder.frames) - 1, builder.number(3)))
    model = builder.build()
    assert len(normalise(model).dofs) == 2
    doubled = Builder()
    first = doubled.joint(WORLD)
    doubled.frames.append(FrameNode(first, doubled.frames[first].step))
    doubled.effector(doubled.link(len(doubled.frames) - 1, doubled.number(1)))
    robot = normalise(doubled.build())
    found = evaluate(robot_graph(robot), "effectors", np.array([0.3]), np.zeros(0))
    np.testing.assert_allclose(found, [np.cos(0.6), np.sin(0.6)])


# --- random robots -------------------------------------------------------------------------------


AXES = {2: ["z", "-z"], 3: ["x", "-y", "z", "-z"]}
SIDES = {2: ["x", "-y"], 3: ["x", "y", "z"]}


@st.composite
def robots(draw: st.DrawFn) -> RobotModel:
    """Trees of joints, links, rigid turns, masses and effectors, with much that is idle."""
    dimension = draw(st.sampled_from([2, 3]))
    builder = Builder(dimension)
    frames = [WORLD]
    for _ in range(draw(st.integers(2, 10))):
        parent = frames[-1] if draw(st.integers(0, 3)) else draw(st.sampled_from(frames))
        side = draw(st.sampled_from(SIDES[dimension]))
        match draw(st.sampled_from(["joint", "joint", "joint", "slide", "link", "turn", "item"])):
            case "joint":
                axis = draw(st.sampled_from(AXES[dimension]))
                frames.append(builder.joint(parent, axis, range_=interval(-1, 2)))
            case "slide":
                frames.append(builder.joint(parent, side, "prismatic", interval(0, 1)))
            case "link":
                frames.append(builder.link(parent, builder.parameter(), side))
            case "turn":
                axis = draw(st.sampled_from(AXES[dimension]))
                frames.append(builder.turn(parent, axis, builder.number(draw(st.integers(-2, 2)))))
            case _:
                if draw(st.booleans()):
                    builder.effector(parent)
                else:
                    builder.point(parent, builder.number(2))
    builder.effector(frames[-1])
    return builder.build()


def coordinate_map(model: RobotModel, normal: RobotModel) -> Array:
    """The matrix that maps the coordinates of a model to those of its normal form."""
    signs = {node.step.dof: node.step.sign for node in model.frames if isinstance(node.step, Joint)}
    kept = {n.step.dof: n.step.sign for n in normal.frames if isinstance(n.step, Joint)}
    matrix = np.zeros((len(normal.dofs), len(model.dofs)))
    places = {dof.symbols[0]: i for i, dof in enumerate(model.dofs)}
    for row, dof in enumerate(normal.dofs):
        for symbol in dof.symbols:
            column = places[symbol]
            matrix[row, column] = signs[column] * kept[row]
    return matrix


@settings(max_examples=examples(15, 30), deadline=None)
@given(robots(), st.integers(0, 2**32 - 1))
def test_normalisation_changes_neither_points_nor_forces(model: RobotModel, seed: int) -> None:
    """M = P' M_n P, c + g = P' (c_n + g_n) for the linear map q_n = P q, 0 where removed."""
    normal = normalise(model)
    turn, rng = coordinate_map(model, normal), np.random.default_rng(seed)
    n = len(model.dofs)
    q, v, theta = (
        rng.uniform(-2, 2, n),
        rng.uniform(-2, 2, n),
        rng.uniform(1, 2, len(model.parameters)),
    )
    pull = (Fraction(1), Fraction(-10), Fraction(2))[: model.dimension]
    before, after = robot_graph(model, pull), robot_graph(normal, pull)
    for name in ("effectors", "body_points"):
        expected = evaluate(before, name, q, theta)
        np.testing.assert_allclose(evaluate(after, name, turn @ q, theta), expected, atol=1e-9)
    if n == 0:
        return
    if len(normal.dofs):
        mass = evaluate(after, "mass_matrix", turn @ q, theta)
        bias = evaluate(after, "bias", turn @ q, turn @ v, theta)
    else:
        mass, bias = np.zeros((0, 0)), np.zeros(0)
    np.testing.assert_allclose(
        turn.T @ mass @ turn, evaluate(before, "mass_matrix", q, theta), atol=1e-9
    )
    np.testing.assert_allclose(turn.T @ bias, evaluate(before, "bias", q, v, theta), atol=1e-8)


@settings(max_examples=60, deadline=None)
@given(robots())
def test_normalisation_is_idempotent_and_keeps_every_symbol(model: RobotModel) -> None:
    normal = normalise(model)
    assert robot_key(normalise(normal)) == robot_key(normal)
    symbols = sorted([s for dof in normal.dofs for s in dof.symbols] + list(normal.removed))
    assert symbols == [dof.symbols[0] for dof in model.dofs]


def test_accelerations_agree_on_the_running_example() -> None:
    """B JO L JO JO L JO EN: two coaxial joints, one idle joint; the same motion."""
    model = arm("JO", "L", "JO", "JO", "L", "JO", "EN")
    normal = normalise(model)
    assert [dof.symbols for dof in normal.dofs] == [(2,), (6, 8)]
    assert normal.removed == (12,)
    plain = arm("JO", "L", "JO", "L", "EN")
    rng = np.random.default_rng(5)
    q, v, u, theta = rng.uniform(-2, 2, 2), rng.uniform(-2, 2, 2), rng.uniform(-5, 5, 2), [1.0, 0.5]
    found = evaluate(robot_graph(normal), "acceleration", q, v, u, np.array(theta))
    expected = evaluate(robot_graph(plain), "acceleration", q, v, u, np.array(theta))
    np.testing.assert_allclose(found, expected, rtol=1e-12)


@pytest.mark.parametrize("links", [2, 40])
def test_a_chain_in_normal_form_stays_as_it_is(links: int) -> None:
    model = arm(*(["JO", "L"] * links), "EN")
    normal = normalise(model)
    assert normal.dofs == model.dofs
    assert normal.removed == ()


def test_a_chain_of_ten_thousand_modules() -> None:
    """Every second joint is coaxial with the one before; the last one moves nothing."""
    builder, frame = Builder(), WORLD
    length = builder.number(1)
    for _ in range(2000):
        for _ in range(2):
            frame = builder.joint(frame, range_=interval(-1, 1))
        frame = builder.link(frame, length)
        frame = builder.move(builder.move(frame, "x", length), "y", length)
    builder.effector(builder.joint(frame))
    normal = normalise(builder.build())
    assert len(normal.dofs) == 2000
    assert normal.removed == (4000,)
    assert len(normal.frames) == 1 + 2 * 2000
    assert bounds(normal.dofs[-1].range) == (-2.0, 2.0)


def test_ten_thousand_coaxial_joints_are_one() -> None:
    builder, frame = Builder(), WORLD
    for _ in range(10_000):
        frame = builder.joint(frame, range_=interval(-1, Fraction(1, 2)))
    builder.effector(builder.link(frame, builder.number(1)))
    (dof,) = normalise(builder.build()).dofs
    assert bounds(dof.range) == (-10_000.0, 5_000.0)
