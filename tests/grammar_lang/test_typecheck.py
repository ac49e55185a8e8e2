from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import pytest

from grammar_lang import ir
from grammar_lang.load import load_text

Check = Callable[[str], list[tuple[str, str]]]


@pytest.fixture(scope="session")
def in_move(build: Callable[..., str]) -> Callable[[str, str], str]:
    """A specification with constants in L and an expression where a length is expected."""

    def make(expression: str, constants: str = "") -> str:
        modules = f"""
module B {{ role base; }}
module JO {{ role joint; dof q: revolute z; }}
module L {{ role link; param length in [0.5, 5] m; {constants} }}
module EN {{ role effector; }}
edge eps;
"""
        semantics = f"""
semantics G {{
  base {{ this.frame = world; }}
  joint {{ this.frame = N.frame * rot(z, JO.q); }}
  link {{ this.frame = N.frame * move(x, {expression}); }}
  tool {{ this.frame = N.frame; effector(frame: N.frame); }}
}}
"""
        return build(modules=modules, semantics=semantics)

    return make


def distance(text: str) -> ir.Expr:
    program = load_text(text, "t").program
    assert program is not None
    semantics = program.grammars["G"].semantics
    assert semantics is not None
    value = semantics["link"].rules[0].value
    assert isinstance(value, ir.Compose)
    assert isinstance(value.right, ir.Move)
    return value.right.distance


LENGTH = ir.ParameterOf(2, "length")


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("50 cm", ir.Num(Fraction(1, 2))),
        ("0.1 + 0.2", ir.Num(Fraction(3, 10))),
        ("(1 + 2) cm", ir.Num(Fraction(3, 100))),
        ("2 * 3 m", ir.Num(Fraction(6))),
        ("6 m^2 / 2 m", ir.Num(Fraction(3))),
        ("sqrt(4 m^2)", ir.Num(Fraction(2))),
        ("abs(-3 mm)", ir.Num(Fraction(3, 1000))),
        ("1 m * sin(30 deg)", ir.Num(Fraction(1, 2))),
        ("2^-1", ir.Num(Fraction(1, 2))),
        ("1 m/s * 2 s", ir.Num(Fraction(2))),
        ("L.length", LENGTH),
        ("L.length + 0.1", ir.Binary("+", LENGTH, ir.Num(Fraction(1, 10)))),
        ("-L.length", ir.Unary("neg", LENGTH)),
        (
            "L.length^2 / 1 m",
            ir.Binary("/", ir.Binary("^", LENGTH, ir.Num(Fraction(2))), ir.Num(Fraction(1))),
        ),
        ("pi * L.length", ir.Binary("*", ir.Pi(), LENGTH)),
        ("sin(1) * 1 m", ir.Binary("*", ir.Unary("sin", ir.Num(Fraction(1))), ir.Num(Fraction(1)))),
    ],
)
def test_values(expression: str, expected: ir.Expr, in_move: Callable[[str, str], str]) -> None:
    assert distance(in_move(expression, "")) == expected


def test_constants_are_inlined_with_their_occurrence(in_move: Callable[[str, str], str]) -> None:
    text = in_move("L.half", "const two = 2; const half = length / two;")
    assert distance(text) == ir.Binary("/", LENGTH, ir.Num(Fraction(2)))


@pytest.mark.parametrize(
    ("expression", "found"),
    [
        ("3 kg", ("UNIT_MISMATCH", "3 kg")),
        ("30 deg", ("UNIT_MISMATCH", "30 deg")),
        ("L.length + 3 kg", ("UNIT_MISMATCH", "3 kg")),
        ("L.length * L.length", ("UNIT_MISMATCH", "L.length * L.length")),
        ("sqrt(2 m)", ("UNIT_MISMATCH", "2 m")),
        ("sin(2 m)", ("UNIT_MISMATCH", "2 m")),
        ("(1 m) m", ("UNIT_MISMATCH", "m")),
        ("world", ("SORT_MISMATCH", "world")),
        ("(1, 2, 3)", ("SORT_MISMATCH", "(1, 2, 3)")),
        ("x", ("SORT_MISMATCH", "x")),
        ("N.frame", ("SORT_MISMATCH", "N.frame")),
        ("2 * world", ("SORT_MISMATCH", "2")),
        ("1 / 0", ("BAD_NUMBER", "0")),
        ("1 / (2 - 2)", ("BAD_NUMBER", "2 - 2")),
        ("sqrt(-1)", ("BAD_NUMBER", "sqrt(-1)")),
        ("10^100000000", ("BAD_NUMBER", "10^100000000")),
        ("1e999999999", ("BAD_NUMBER", "1e999999999")),
        ("2^0.5", ("NOT_CONSTANT", "0.5")),
        ("2^L.length", ("UNIT_MISMATCH", "L.length")),
        ("length", ("UNKNOWN_NAME", "length")),
        ("sine(1)", ("UNKNOWN_NAME", "sine")),
        ("L.lenght", ("UNKNOWN_NAME", "lenght")),
        ("M.length", ("UNKNOWN_NAME", "M")),
        ("eps.length", ("WRONG_KIND", "eps.length")),
        ("1 m^13", ("UNKNOWN_UNIT", "m^13")),
    ],
)
def test_errors(
    expression: str,
    found: tuple[str, str],
    check: Check,
    in_move: Callable[[str, str], str],
) -> None:
    codes = check(in_move(expression, ""))
    assert codes[0] == found
    if not expression.startswith("2^L"):
        assert len(codes) == 1


def test_a_wrong_parameter_is_reported_once(
    check: Check, in_move: Callable[[str, str], str]
) -> None:
    text = in_move("L.mass", "param mass in [1, 2] kg;")
    text = text.replace("N.frame * move", "N.frame * move(y, L.mass) * move")
    assert check(text) == [("UNIT_MISMATCH", "L.mass")]


def test_a_constant_without_unit_is_dimensionless(
    check_fragment: Check, in_move: Callable[[str, str], str]
) -> None:
    assert check_fragment(in_move("L.c", "const c = 2;")) == [("UNIT_MISMATCH", "L.c")]
    assert check_fragment(in_move("L.c * 1 m", "const c = 2;")) == []


def test_growing_constants_stop(check: Check, in_move: Callable[[str, str], str]) -> None:
    chain = "const c0 = length; " + " ".join(f"const c{n + 1} = c{n} + c{n};" for n in range(60))
    assert "TOO_DEEP" in [code for code, _ in check(in_move("L.c60", chain))]
    squares = "const c0 = 7; " + " ".join(f"const c{n + 1} = c{n} * c{n};" for n in range(60))
    assert "BAD_NUMBER" in [code for code, _ in check(in_move("1 m", squares))]
