"""Attribute evaluation on derivations made by hand."""

from __future__ import annotations

from collections.abc import Mapping
from fractions import Fraction

import numpy as np
import pytest

from compiler.dynamics.equations_of_motion import robot_graph
from compiler.robots.attributes import SemanticsError, evaluate
from compiler.robots.robot import RobotModel
from compiler.words.derivation import Derivation, DerivationNode
from grammar_lang import ir
from tests.oracles.robots import evaluate as reading
from tests.oracles.robots import interval, rod_chain
from tests.oracles.some_cases import some

MODULES = {
    "B": ir.Module("B", "base", (), ()),
    "JO": ir.Module("JO", "joint", (), (ir.Dof("q", "revolute", "z", interval(-3, 3), None),)),
    "L": ir.Module("L", "link", (ir.Parameter("length", interval(1, 5), "m"),), ()),
    "EN": ir.Module("EN", "effector", (), ()),
}
ONE = ir.Num(Fraction(1))
TWO_LINKS = ("B", "eps", "JO", "eps", "L", "eps", "JO", "eps", "L", "eps", "EN")
FRAME = ir.AttributeOf(ir.THIS, "frame")


def symbol(name: str) -> ir.Symbol:
    if name in MODULES:
        return ir.Symbol(name, "module")
    return ir.Symbol(name, "edge" if name == "eps" else "nonterminal")


def production(label: str, left: str, right: str) -> ir.Production:
    return ir.Production(label, left, tuple(map(symbol, right.split())))


def inherited(occurrence: int, name: str = "frame") -> ir.AttributeOf:
    return ir.AttributeOf(occurrence, name)


def length(occurrence: int) -> ir.ParameterOf:
    return ir.ParameterOf(occurrence, "length")


def block(
    *rules: tuple[ir.AttributeOf, ir.Expr], emit: tuple[ir.Emission, ...] = ()
) -> ir.SemanticBlock:
    return ir.SemanticBlock(tuple(ir.AttributeRule(t, v) for t, v in rules), emit)


# The running example: left-recursive, synthesized frames.
N_FRAME = inherited(0)
PLANAR = {
    "base": production("base", "N", "B"),
    "joint": production("joint", "N", "N eps JO"),
    "link": production("link", "N", "N eps L"),
    "tool": production("tool", "N", "N eps EN"),
}
PLANAR_RULES: Mapping[str, ir.SemanticBlock] = {
    "base": block((FRAME, ir.World())),
    "joint": block((FRAME, ir.Compose(N_FRAME, ir.Rot("z", ir.DofOf(2, "q"))))),
    "link": block(
        (FRAME, ir.Compose(N_FRAME, ir.Move("x", length(2)))),
        emit=(ir.Rod(N_FRAME, "x", length(2), ONE, None),),
    ),
    "tool": block((FRAME, N_FRAME), emit=(ir.Effector(N_FRAME),)),
}


def left_recursive(labels: list[str]) -> Derivation:
    """labels[0] is the outermost production; the last is ``base``."""
    word = [name for label in reversed(labels) for name in ("eps", PLANAR[label].right[-1].name)][
        1:
    ]
    nodes = []
    for depth, label in enumerate(labels):
        end = 2 * (len(labels) - 1 - depth)
        children = (end,) if label == "base" else (depth + 1, end - 1, end)
        nodes.append(DerivationNode(PLANAR[label], children))
    return Derivation(tuple(word), tuple(nodes))


def planar(labels: str) -> RobotModel:
    return evaluate(left_recursive(labels.split()), MODULES, PLANAR_RULES, 2)


def test_the_running_example() -> None:
    derivation = left_recursive(["tool", "link", "joint", "link", "joint", "base"])
    assert derivation.word == ("B", "eps", "JO", "eps", "L", "eps", "JO", "eps", "L", "eps", "EN")
    robot = evaluate(derivation, MODULES, PLANAR_RULES, 2)
    assert robot.dimension == 2
    assert [dof.symbols for dof in robot.dofs] == [(2,), (6,)]
    assert [dof.range for dof in robot.dofs] == [interval(-3, 3)] * 2
    assert [(p.symbol, p.module, p.name, p.unit) for p in robot.parameters] == [
        (4, "L", "length", "m"),
        (8, "L", "length", "m"),
    ]
    assert len(robot.bodies) == 2
    assert len(robot.effectors) == 1
    q, v, u, theta = (np.array(a) for a in ([0.3, 0.4], [1.0, -2.0], [3.0, 4.0], [1.0, 0.5]))
    found, wanted = robot_graph(robot), robot_graph(rod_chain(2))
    for name in ("effectors", "body_points", "mass_matrix"):
        np.testing.assert_allclose(reading(found, name, q, theta), reading(wanted, name, q, theta))
    np.testing.assert_allclose(
        reading(found, "acceleration", q, v, u, theta),
        reading(wanted, "acceleration", q, v, u, theta),
    )


def test_links_before_the_first_joint_and_after_the_effector() -> None:
    robot = planar("link tool joint link base")
    tip = reading(robot_graph(robot), "effectors", np.array([0.7]), np.array([2.0, 3.0]))
    np.testing.assert_allclose(tip, [2.0, 0.0])
    bodies = reading(robot_graph(robot), "body_points", np.array([0.7]), np.array([2.0, 3.0]))
    end = [2 + 3 * np.cos(0.7), 3 * np.sin(0.7)]
    np.testing.assert_allclose(bodies, [0, 0, 2, 0, 2, 0, *end])


def test_effectors_are_numbered_in_word_order() -> None:
    robot = planar("tool link tool joint base")
    tips = reading(robot_graph(robot), "effectors", np.array([0.0]), np.array([2.0]))
    np.testing.assert_allclose(tips, [0, 0, 2, 0])


# Right recursion with inherited frames, starting from a start symbol that inherits the world.
CHAIN = {
    "start": production("start", "S", "B eps R"),
    "joint": production("joint", "R", "JO eps R"),
    "link": production("link", "R", "L eps R"),
    "tool": production("tool", "R", "EN"),
}
CHAIN_RULES = {
    "start": block((inherited(2), FRAME)),
    "joint": block((inherited(2), ir.Compose(FRAME, ir.Rot("z", ir.DofOf(0, "q"))))),
    "link": block(
        (inherited(2), ir.Compose(FRAME, ir.Move("x", length(0)))),
        emit=(ir.Rod(FRAME, "x", length(0), ONE, None),),
    ),
    "tool": block(emit=(ir.Effector(FRAME),)),
}


def right_recursive(labels: list[str]) -> Derivation:
    word: list[str] = []
    nodes = []
    for number, label in enumerate(labels):
        rule, at = CHAIN[label], len(word)
        children = [
            at + i if s.kind != "nonterminal" else number + 1 for i, s in enumerate(rule.right)
        ]
        nodes.append(DerivationNode(rule, tuple(children)))
        word += [s.name for s in rule.right if s.kind != "nonterminal"]
    return Derivation(tuple(word), tuple(nodes))


def test_inherited_frames_give_the_same_robot() -> None:
    derivation = right_recursive(["start", "joint", "link", "joint", "link", "tool"])
    assert derivation.word == ("B", "eps", "JO", "eps", "L", "eps", "JO", "eps", "L", "eps", "EN")
    found = robot_graph(evaluate(derivation, MODULES, CHAIN_RULES, 2))
    wanted = robot_graph(rod_chain(2))
    q, theta = np.array([0.3, 0.4]), np.array([1.0, 0.5])
    for name in ("effectors", "body_points", "mass_matrix"):
        np.testing.assert_allclose(reading(found, name, q, theta), reading(wanted, name, q, theta))


@pytest.mark.parametrize("direction", some(["left", "right"], 1))
def test_a_derivation_of_ten_thousand_links(direction: str) -> None:
    count = 10_000
    if direction == "left":
        derivation = left_recursive(["tool", *["link"] * count, "joint", "base"])
        robot = evaluate(derivation, MODULES, PLANAR_RULES, 2)
    else:
        derivation = right_recursive(["start", "joint", *["link"] * count, "tool"])
        robot = evaluate(derivation, MODULES, CHAIN_RULES, 2)
    assert len(robot.bodies) == len(robot.parameters) == count
    assert [parameter.symbol for parameter in robot.parameters] == list(range(4, 2 * count + 4, 2))
    assert len(robot.chain(robot.effectors[0])) == count + 1


# Attributes of every sort, and expressions over them.
MIXED = {
    "top": production("top", "S", "B eps A eps A"),
    "part": production("part", "A", "L"),
}


def mixed(top: ir.SemanticBlock, part: ir.SemanticBlock) -> RobotModel:
    nodes = (
        DerivationNode(MIXED["top"], (0, 1, 1, 3, 2)),
        DerivationNode(MIXED["part"], (2,)),
        DerivationNode(MIXED["part"], (4,)),
    )
    derivation = Derivation(("B", "eps", "L", "eps", "L"), nodes)
    return evaluate(derivation, MODULES, {"top": top, "part": part}, 2)


def test_an_l_shaped_link_and_inherited_scalars() -> None:
    """Each part is an L: along x by its length, then along y by an inherited share of it."""
    share, side = inherited(ir.THIS, "share"), ir.AttributeOf(ir.THIS, "side")
    corner = ir.Compose(FRAME, ir.Move("x", length(0)))
    part = block(
        (side, ir.Binary("*", share, length(0))),
        (ir.AttributeOf(ir.THIS, "end"), ir.Compose(corner, ir.Move("-y", ir.Unary("neg", side)))),
        emit=(
            ir.Rod(FRAME, "x", length(0), ONE, None),
            ir.Rod(corner, "y", side, ir.Num(Fraction(2)), None),
            ir.Effector(ir.AttributeOf(ir.THIS, "end")),
        ),
    )
    top = block(
        (inherited(2), ir.Rot("z", ir.Binary("/", ir.Pi(), ir.Num(Fraction(2))))),
        (inherited(4), ir.AttributeOf(2, "end")),
        (inherited(2, "share"), ir.Num(Fraction(1, 2))),
        (inherited(4, "share"), ir.Binary("+", inherited(2, "share"), ONE)),
    )
    robot = mixed(top, part)
    tips = reading(robot_graph(robot), "effectors", np.zeros(0), np.array([2.0, 3.0]))
    # Turned by a right angle: x becomes y, y becomes -x.
    first = np.array([-1.0, 2.0])
    second = first + np.array([-4.5, 3.0])
    np.testing.assert_allclose(tips, [*first, *second], atol=1e-12)
    points = reading(robot_graph(robot), "body_points", np.zeros(0), np.array([2.0, 3.0]))
    expected = [0, 0, 0, 2, 0, 2, *first, *first, -1, 5, -1, 5, *second]
    np.testing.assert_allclose(points, expected, atol=1e-12)


def test_vectors_powers_and_functions() -> None:
    vector = ir.AttributeOf(ir.THIS, "arm")
    part = block(
        (
            vector,
            ir.Vector(
                ir.Binary("^", length(0), ir.Num(Fraction(2))),
                ir.Unary("sqrt", length(0)),
                ir.Num(Fraction(0)),
            ),
        ),
        emit=(ir.Effector(ir.Compose(ir.Shift(vector), ir.Shift(inherited(ir.THIS, "more")))),),
    )
    top = block(
        (
            inherited(2, "more"),
            ir.Vector(ir.Unary("cos", ONE), ir.Num(Fraction(0)), ir.Num(Fraction(0))),
        ),
        (inherited(4, "more"), ir.AttributeOf(2, "arm")),
    )
    tips = reading(robot_graph(mixed(top, part)), "effectors", np.zeros(0), np.array([2.0, 3.0]))
    np.testing.assert_allclose(
        tips, [4 + np.cos(1), np.sqrt(2), 9 + 4, np.sqrt(3) + np.sqrt(2)], rtol=1e-15
    )


def test_a_frame_applied_twice_turns_twice() -> None:
    part = block(
        (FRAME, ir.Compose(ir.Rot("z", ONE), ir.Move("x", length(0)))),
        emit=(ir.Effector(ir.Compose(FRAME, FRAME)),),
    )
    tips = reading(
        robot_graph(mixed(block(), part)), "effectors", np.zeros(0), np.array([2.0, 3.0])
    )
    once = np.exp(1j)
    expected = [2 * (once + once**2), 3 * (once + once**2)]
    np.testing.assert_allclose(tips[0::2] + 1j * tips[1::2], expected)


def test_points_and_solids_are_emitted() -> None:
    zero = ir.Num(Fraction(0))
    part = block(
        emit=(
            ir.PointMass(ir.World(), length(0)),
            ir.Solid(ir.Move("x", ONE), ONE, ir.Vector(ONE, length(0), zero), (ONE,)),
        )
    )
    robot = mixed(block(), part)
    points = reading(robot_graph(robot), "body_points", np.zeros(0), np.array([2.0, 3.0]))
    np.testing.assert_allclose(points, [0, 0, 2, 2, 0, 0, 2, 3])


@pytest.mark.parametrize(
    "rules",
    [
        [(inherited(2), inherited(2)), (inherited(4), ir.World())],
        [(inherited(2), inherited(4)), (inherited(4), inherited(2))],
        [(inherited(2), ir.AttributeOf(4, "out")), (inherited(4), inherited(2))],
    ],
)
def test_circular_attributes_are_refused(rules: list[tuple[ir.AttributeOf, ir.Expr]]) -> None:
    part = block((ir.AttributeOf(ir.THIS, "out"), FRAME), emit=(ir.Effector(FRAME),))
    with pytest.raises(SemanticsError, match="depends on itself"):
        mixed(block(*rules), part)


def test_a_long_circle_is_found_without_recursion() -> None:
    labels = ["start", *["link"] * 3000, "tool"]
    rules = dict(CHAIN_RULES)
    out = ir.AttributeOf(ir.THIS, "out")
    rules["start"] = block((inherited(2), ir.AttributeOf(2, "out")))
    rules["link"] = block((inherited(2), FRAME), (out, ir.AttributeOf(2, "out")))
    rules["tool"] = block((out, FRAME), emit=(ir.Effector(FRAME),))
    with pytest.raises(SemanticsError, match="depends on itself"):
        evaluate(right_recursive(labels), MODULES, rules, 2)


def test_missing_rules_are_refused() -> None:
    part = block(emit=(ir.Effector(inherited(ir.THIS, "nowhere")),))
    with pytest.raises(SemanticsError, match="no rule"):
        mixed(block(), part)


def test_values_of_the_wrong_sort_are_refused() -> None:
    scalar = block((FRAME, ONE), emit=(ir.Effector(FRAME),))
    with pytest.raises(SemanticsError, match="frame is expected"):
        mixed(block(), scalar)
    frame = block((FRAME, ir.World()), emit=(ir.PointMass(ir.World(), FRAME),))
    with pytest.raises(SemanticsError, match="scalar is expected"):
        mixed(block(), frame)
