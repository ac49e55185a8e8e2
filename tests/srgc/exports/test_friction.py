"""Viscous friction is told from all other dynamics of modules, with exact numbers."""

from __future__ import annotations

from fractions import Fraction

import pytest

from compiler.robots.robot import OwnDynamics
from grammar_lang import ir
from srgc.exports.joint_drives import viscous_friction

U, RATE = ir.EffortOf(ir.THIS, "q"), ir.RateOf(ir.THIS, "q")
TENTH = ir.Num(Fraction(1, 10))
DRAG = ir.Binary("*", TENTH, RATE)


def module(*torques: tuple[str, ir.Expr]) -> OwnDynamics:
    """With degrees of freedom p, q, r, of which the robot has lost p, and a parameter b."""
    found = tuple(ir.Torque(dof, value) for dof, value in torques)
    dofs = (("p", None), ("q", 3), ("r", 1))
    return OwnDynamics(2, "M", (), (), found, (("b", 1),), dofs)


def test_each_degree_of_freedom_has_its_own() -> None:
    free = ir.EffortOf(ir.THIS, "r")
    b = ir.ParameterOf(ir.THIS, "b")
    more = ir.Binary("-", free, ir.Binary("/", ir.RateOf(ir.THIS, "r"), b))
    own = module(("q", ir.Binary("-", U, DRAG)), ("r", more))
    theta = (Fraction(5), Fraction(7, 3))
    assert viscous_friction(own, theta) == {3: Fraction(1, 10), 1: Fraction(3, 7)}
    assert viscous_friction(own, (Fraction(5), Fraction(0))) is None
    assert viscous_friction(module(), theta) == {}
    assert viscous_friction(module(("q", U)), theta) == {3: 0}


@pytest.mark.parametrize(
    "value",
    [
        ir.Binary("-", ir.EffortOf(ir.THIS, "r"), DRAG),
        ir.Binary("-", U, ir.Binary("*", TENTH, ir.RateOf(ir.THIS, "p"))),
        ir.Binary("-", U, ir.Binary("*", ir.DofOf(ir.THIS, "q"), RATE)),
        ir.Binary("-", U, ir.Binary("*", ir.Pi(), RATE)),
        ir.Binary("-", U, ir.Binary("^", RATE, ir.Num(Fraction(2)))),
        ir.Binary("-", U, ir.Binary("/", TENTH, RATE)),
        ir.Binary("-", U, ir.Unary("abs", RATE)),
        ir.Binary("-", ir.InputOf(ir.THIS, "v"), DRAG),
        ir.Binary("-", ir.StateOf(ir.THIS, "s"), DRAG),
        ir.Binary("+", U, DRAG),
        ir.Num(Fraction(0)),
    ],
)
def test_anything_else_is_not(value: ir.Expr) -> None:
    assert viscous_friction(module(("q", value)), (Fraction(0), Fraction(1))) is None
    both = module(("r", ir.EffortOf(ir.THIS, "r")), ("q", value))
    assert viscous_friction(both, (Fraction(0), Fraction(1))) is None
