from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest

from compiler.expressions.scalars import ScalarTable
from compiler.robots.robot import (
    FrameNode,
    Joint,
    Offset,
    PointBody,
    RobotDof,
    RobotModel,
    RobotParameter,
)
from compiler.robots.robot_key import provably_different
from grammar_lang import ir


def interval(lower: int | str, upper: int | str) -> ir.Interval:
    return ir.Interval(ir.Num(Fraction(lower)), ir.Num(Fraction(upper)))


LENGTHS = tuple(
    RobotParameter(i, "L", "length", domain, "m")
    for i, domain in enumerate([interval(1, 2), interval(1, 2), interval(1, 3)])
)


def arm(expression: str, limit: ir.Interval | None = None) -> RobotModel:
    """A joint, then an offset along x by an expression in the lengths p, q and r, and a point."""
    table = ScalarTable()
    p, q, r = (table.parameter(i) for i in range(3))
    binary, unary, number = table.binary, table.unary, table.constant
    x = {
        "p + (q + r)": lambda: binary("+", p, binary("+", q, r)),
        "(p + q) + r": lambda: binary("+", binary("+", p, q), r),
        "r + (q + p)": lambda: binary("+", r, binary("+", q, p)),
        "p + q": lambda: binary("+", p, q),
        "p * q": lambda: binary("*", p, q),
        "p": lambda: p,
        "q": lambda: q,
        "r": lambda: r,
        "p - q": lambda: binary("-", p, q),
        "q - p": lambda: binary("-", q, p),
        "sin^2 + cos^2": lambda: binary(
            "+", table.power(unary("sin", p), 2), table.power(unary("cos", p), 2)
        ),
        "1": lambda: number(1),
        "1 / (p - p)": lambda: binary("/", number(1), binary("-", p, p)),
    }[expression]()
    zero, body = number(0), PointBody(2, number(1))
    dof = RobotDof((1,), "revolute", "z", limit or interval(-1, 1), None)
    frames = (
        FrameNode(0, None),
        FrameNode(0, Joint(0, 2, 1)),
        FrameNode(1, Offset((x, zero, zero))),
    )
    return RobotModel(
        2, tuple(table.nodes), frames, (dof,), LENGTHS, (body,), (2,)
    )  # fmt: skip


def of_mass(mass: int) -> RobotModel:
    model = arm("p")
    table = ScalarTable()
    for node in model.scalars:
        table.add(node)
    body = PointBody(2, table.constant(mass))
    return replace(model, scalars=tuple(table.nodes), bodies=(body,))


@pytest.mark.parametrize(
    ("one", "other", "different"),
    [
        ("p", "p", False),
        ("p + (q + r)", "(p + q) + r", False),
        ("p + (q + r)", "r + (q + p)", False),
        ("sin^2 + cos^2", "1", False),
        # up to renaming of parameters with equal ranges
        ("p", "q", False),
        ("p - q", "q - p", False),
        ("p", "r", True),
        ("p + q", "p * q", True),
        ("p", "1", True),
        ("p + q", "p + (q + r)", True),
        # no value at all shows nothing
        ("1 / (p - p)", "1 / (p - p)", False),
    ],
)
def test_expressions_by_their_values(one: str, other: str, *, different: bool) -> None:
    assert provably_different(arm(one), arm(other)) is different
    assert provably_different(arm(other), arm(one)) is different


def test_limits_masses_and_shapes() -> None:
    thirds = ir.Interval(
        ir.Unary("neg", ir.Num(Fraction(1))),
        ir.Binary("*", ir.Num(Fraction(3)), ir.Num(Fraction(1, 3))),
    )
    assert not provably_different(arm("p"), arm("p", thirds))
    assert provably_different(arm("p"), arm("p", interval(-1, "1.0001")))
    assert not provably_different(of_mass(1), of_mass(1))
    assert provably_different(of_mass(1), of_mass(2))
    model = arm("p")
    unlimited = replace(model, dofs=(replace(model.dofs[0], range=None),))
    assert provably_different(model, unlimited)
    assert provably_different(model, replace(model, effectors=()))
    assert provably_different(model, replace(model, dimension=3))
    turned = replace(
        model, frames=(model.frames[0], FrameNode(0, Joint(0, 2, -1)), model.frames[2])
    )
    assert provably_different(model, turned)
