"""Robots whose first joint has a motor and whose last one has friction (Definition 5)."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

from compiler.robots.robot import OwnDynamics, RobotModel
from grammar_lang import ir
from tests.oracles.robots import interval


def number(value: str) -> ir.Expr:
    return ir.Num(Fraction(value))


def driven(model: RobotModel) -> RobotModel:
    """With u driving the current and the speed of a motor, and friction that grows with the rate.

    Where the robot has a parameter, the motor's constant is that.
    """
    last = len(model.dofs) - 1
    current, rate = ir.StateOf(ir.THIS, "current"), ir.RateOf(ir.THIS, "q")
    constant: ir.Expr = ir.ParameterOf(ir.THIS, "c") if model.parameters else number("4/5")
    resisted = ir.Binary("*", number("3/2"), current)
    induced = ir.Binary("*", constant, rate)
    left = ir.Binary("-", ir.InputOf(ir.THIS, "voltage"), ir.Binary("+", resisted, induced))
    stiff = ir.Unary("sin", ir.DofOf(ir.THIS, "q"))
    motor = OwnDynamics(
        model.dofs[0].symbols[0],
        "M",
        (ir.State("current", "A", None, ir.Binary("/", left, number("3/10"))),),
        (ir.Input("voltage", interval(-24, 24), "V"),),
        (ir.Torque("q", ir.Binary("-", ir.Binary("*", constant, current), stiff)),),
        (("c", 0),) if model.parameters else (),
        (("q", 0),),
    )
    if not last:
        return replace(model, own=(motor,))
    drag = ir.Binary("*", ir.Binary("*", number("1/5"), rate), ir.Unary("abs", rate))
    joint = OwnDynamics(
        model.dofs[last].symbols[0],
        "JO",
        (),
        (),
        (ir.Torque("q", ir.Binary("-", ir.EffortOf(ir.THIS, "q"), drag)),),
        (),
        (("q", last),),
    )
    return replace(model, own=(motor, joint))
