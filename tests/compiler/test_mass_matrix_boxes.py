"""Boxes of coordinates and parameters: their sides, halves and natural values."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import pytest
from flint import arb

from compiler.expressions.evaluators.exact import PiLinear
from compiler.expressions.evaluators.intervals import INFINITY, Ends
from compiler.mass_matrix.boxes import Side, halves, hull, middle, natural_values, robot_box
from grammar_lang import ir
from tests.oracles.robots import rod_chain

PI = PiLinear(Fraction(0), Fraction(1))


def number(value: Fraction | int) -> ir.Num:
    return ir.Num(Fraction(value))


def side_of(domain: ir.Interval | ir.Choices) -> Side:
    model = rod_chain(1)
    parameter = replace(model.parameters[0], domain=domain)
    return robot_box(replace(model, parameters=(parameter,)))[1]


def part(low: float, high: float) -> Side:
    return (Ends(arb(low), arb(high)),)


def test_natural_values_are_in_their_domain() -> None:
    turn = natural_values(None, angle=True)
    assert {PiLinear(Fraction(0)), PI, PiLinear(Fraction(0), Fraction(-1, 2))} <= set(turn)
    assert PiLinear(Fraction(0), Fraction(3, 2)) not in turn
    root = ir.Unary("sqrt", number(2))
    values = natural_values(ir.Interval(root, number(2)), angle=False)
    assert PiLinear(Fraction(2)) in values
    assert all(value.rational**2 > 2 for value in values)
    assert natural_values(ir.Interval(number(1), number(2)), angle=True)[0] == PiLinear(
        Fraction(0), Fraction(1, 2)
    )
    assert natural_values(ir.Choices((root, number(0))), angle=False) == (PiLinear(Fraction(0)),)
    assert natural_values(None, angle=False) == (PiLinear(Fraction(0)),)


def test_sides_enclose_their_domains() -> None:
    chosen = side_of(ir.Choices((number(4), number(1), number(9))))
    assert (hull(chosen).low, hull(chosen).high) == (1, 9)
    third = hull(side_of(ir.Interval(number(Fraction(1, 3)), ir.Pi())))
    assert third.low < arb(1) / 3 + arb("1e-15")
    assert not third.low > arb(1) / 3
    assert not third.high < arb.pi()


def test_halves_cover_a_side() -> None:
    (first,), others = halves(side_of(ir.Choices((number(1), number(4), number(9))))) or ((), ())
    assert first.low == 1
    assert len(others) == 2
    assert halves((first,)) is None
    assert halves(part(2, 2 + 1e-7)) is None
    low, high = halves(part(-1, 5)) or ((), ())
    assert (low[0].low, low[0].high, high[0].low, high[0].high) == (-1, 2, 2, 5)


@pytest.mark.parametrize("sign", [-1, 1])
def test_an_unlimited_side_is_cut_farther_and_farther_out(sign: int) -> None:
    side, cuts = (Ends(-INFINITY, INFINITY),), list[float]()
    while (pair := halves(side)) is not None:
        cuts.append(middle(side))
        side = pair[0 if sign < 0 else 1]
    assert cuts[:4] == [0, sign, 2 * sign, 4 * sign]
    assert 20 < len(cuts) < 30
