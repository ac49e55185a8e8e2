"""The scalar table: exact folding, sharing, and readings in order."""

from __future__ import annotations

from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from compiler.expressions.evaluators.floats import FloatEvaluator
from compiler.expressions.scalars import (
    Apply,
    ScalarTable,
    evaluate_scalars,
)
from tests.oracles.exact_chain import Rationals

rationals = st.fractions(min_value=-9, max_value=9, max_denominator=9)
PARAMETERS = (Fraction(3, 7), Fraction(-5, 2))
OPERATIONS = {
    "+": lambda a, b: a + b,
    "-": lambda a, b: a - b,
    "*": lambda a, b: a * b,
    "/": lambda a, b: a / b,
}


def value_of(table: ScalarTable, scalar: int) -> Fraction:
    """The exact value at PARAMETERS of a scalar without transcendental functions."""

    return evaluate_scalars(table.nodes, Rationals(), PARAMETERS)[scalar]


@st.composite
def programs(draw: st.DrawFn) -> tuple[ScalarTable, int, Fraction]:
    """A table, one of its scalars, and its value computed beside it with Fractions."""
    table = ScalarTable()
    known = [(table.parameter(i), PARAMETERS[i]) for i in range(2)]
    for _ in range(draw(st.integers(1, 12))):
        kind = draw(st.sampled_from(["constant", "unary", "power", "+", "-", "*", "/"]))
        (a, x), (b, y) = draw(st.sampled_from(known)), draw(st.sampled_from(known))
        if kind == "constant":
            value = draw(rationals)
            known.append((table.constant(value), value))
        elif kind == "unary":
            name = draw(st.sampled_from(["neg", "abs"]))
            known.append((table.unary(name, a), -x if name == "neg" else abs(x)))
        elif kind == "power":
            exponent = draw(st.integers(-2 if x else 0, 3))
            if x.numerator.bit_length() < 200:
                known.append((table.power(a, exponent), x**exponent))
        elif kind != "/" or y:
            known.append((table.binary(kind, a, b), OPERATIONS[kind](x, y)))
    return table, *draw(st.sampled_from(known))


@given(programs())
def test_simplification_never_changes_a_value(program: tuple[ScalarTable, int, Fraction]) -> None:
    table, scalar, expected = program
    assert value_of(table, scalar) == expected


@given(programs())
def test_arguments_precede_and_nothing_is_stored_twice(
    program: tuple[ScalarTable, int, Fraction],
) -> None:
    table, _, _ = program
    assert len(set(table.nodes)) == len(table.nodes)
    for index, node in enumerate(table.nodes):
        if isinstance(node, Apply):
            assert max(node.arguments) < index


def test_rationals_fold_exactly() -> None:
    table = ScalarTable()
    total = table.binary("+", table.constant(Fraction("0.1")), table.constant(Fraction("0.2")))
    assert table.rational(total) == Fraction(3, 10)
    assert table.rational(table.power(total, -2)) == Fraction(100, 9)
    assert table.rational(table.unary("cos", table.constant(0))) == 1
    assert table.rational(table.unary("tan", table.constant(0))) == 0


def test_what_is_not_rational_is_kept() -> None:
    table = ScalarTable()
    root = table.unary("sqrt", table.constant(4))
    assert table.nodes[root] == Apply("sqrt", (table.constant(4),))
    assert table.rational(table.unary("sin", table.pi())) is None


@pytest.mark.parametrize("numerator", [0, 3])
def test_a_division_by_zero_is_not_folded(numerator: int) -> None:
    table = ScalarTable()
    zero = table.constant(0)
    assert table.rational(table.binary("/", table.constant(numerator), zero)) is None
    assert table.rational(table.power(zero, -1)) is None


def test_neutral_elements_vanish() -> None:
    table = ScalarTable()
    p, zero, one = table.parameter(0), table.constant(0), table.constant(1)
    for same in (
        table.binary("+", p, zero), table.binary("+", zero, p), table.binary("-", p, zero),
        table.binary("*", p, one), table.binary("*", one, p), table.binary("/", p, one),
        table.power(p, 1),
    ):  # fmt: skip
        assert same == p
    assert table.binary("*", zero, p) == zero == table.binary("*", p, zero)
    assert table.binary("-", zero, p) != p


def test_long_sums_are_read_without_recursion() -> None:
    table = ScalarTable()
    total = table.parameter(0)
    for _ in range(20_000):
        total = table.unary("sin", table.binary("+", total, table.parameter(0)))
    values = evaluate_scalars(table.nodes, FloatEvaluator(), [0.5])
    assert abs(values[total]) <= 1
