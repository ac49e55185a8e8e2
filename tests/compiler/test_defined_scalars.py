"""Where quotients and roots of parameters have a value."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import pytest

from compiler.expressions.scalars import ScalarTable
from compiler.robots.defined_scalars import scalars_are_defined
from compiler.robots.robot import WORLD
from tests.oracles.robots import Builder

Expression = Callable[[ScalarTable, int], int]


@pytest.mark.parametrize(
    ("low", "high", "expression", "expected"),
    [
        ("-1/2", "1", lambda t, p: t.unary("sqrt", p), False),
        ("0", "1", lambda t, p: t.unary("sqrt", p), True),
        ("-1", "1", lambda t, p: t.unary("sqrt", t.power(p, 2)), True),
        ("-1", "1", lambda t, p: t.binary("/", t.constant(1), p), False),
        ("1/1000", "1", lambda t, p: t.binary("/", t.constant(1), p), True),
        ("0", "1", lambda t, p: t.binary("/", p, p), False),
        ("-1", "1", lambda t, p: t.power(p, -2), False),
        ("1", "2", lambda t, p: t.unary("tan", p), False),  # pi / 2 lies between
        ("-1", "1", lambda t, p: t.unary("tan", p), True),
        # 1 / (p^2 - p + 1/3): positive everywhere, which takes more than one box to see
        ("0", "1", lambda t, p: t.binary("/", t.constant(1), quadratic(t, p)), True),
    ],
)
def test_one_expression(low: str, high: str, expression: Expression, *, expected: bool) -> None:
    builder = Builder()
    parameter = builder.parameter(Fraction(low), Fraction(high))
    builder.effector(builder.move(WORLD, "x", expression(builder.table, parameter)))
    assert scalars_are_defined(builder.build()) is expected


def quadratic(table: ScalarTable, p: int) -> int:
    square = table.binary("-", table.power(p, 2), p)
    return table.binary("+", square, table.constant(Fraction(1, 3)))
