from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction

import pytest

from grammar_lang import ir
from grammar_lang.load import load_text

Check = Callable[[str], list[tuple[str, str]]]


def module(body: str) -> ir.Module:
    program = load_text(f"module M {{ role joint; {body} }}", "t").program
    assert program is not None
    return program.modules["M"]


def num(value: str) -> ir.Num:
    return ir.Num(Fraction(value))


def test_parameters() -> None:
    found = module(
        "param a in [50, 500] cm; param b in {1, 2.5} kg; param c in [0, 90] deg;"
        "param d in [0.5 m, 2]; param e in [0, 1]; param f in [2*0.5, 3] N*m;"
    ).parameters
    half_pi = ir.Binary("*", num("1/2"), ir.Pi())
    assert found == (
        ir.Parameter("a", ir.Interval(num("1/2"), num("5")), "m"),
        ir.Parameter("b", ir.Choices((num("1"), num("5/2"))), "kg"),
        ir.Parameter("c", ir.Interval(num("0"), half_pi), "rad"),
        ir.Parameter("d", ir.Interval(num("1/2"), num("2")), "m"),
        ir.Parameter("e", ir.Interval(num("0"), num("1")), "1"),
        ir.Parameter("f", ir.Interval(num("1"), num("3")), "N*m"),
    )


def test_degrees_of_freedom() -> None:
    found = module(
        "dof q: revolute -y in [-180, 180] deg rate in [-1, 1] rad/s;"
        "dof d: prismatic x in [0, 20] cm; dof f: revolute z; dof g: revolute z in [-pi, pi];"
    ).dofs
    turn = ir.Interval(ir.Binary("*", num("-1"), ir.Pi()), ir.Pi())
    assert found == (
        ir.Dof("q", "revolute", "-y", turn, ir.Interval(num("-1"), num("1"))),
        ir.Dof("d", "prismatic", "x", ir.Interval(num("0"), num("1/5")), None),
        ir.Dof("f", "revolute", "z", None, None),
        ir.Dof("g", "revolute", "z", turn, None),
    )


@pytest.mark.parametrize(
    ("body", "found"),
    [
        ("role join;", [("UNKNOWN_NAME", "join")]),
        ("", [("MISSING_CLAUSE", "M")]),
        ("role base; role link;", [("REPEATED_CLAUSE", "role link;")]),
        ("role base; param a in [5, 0.5] m;", [("EMPTY_INTERVAL", "[5, 0.5] m")]),
        ("role base; param a in [1, 2] kg; const a = 1;", [("DUPLICATE_NAME", "a")]),
        ("role base; param a in [1 m, 2 kg];", [("UNIT_MISMATCH", "2 kg")]),
        ("role base; param a in {1, 2, 1} m;", [("BAD_VALUE", "1")]),
        ("role base; param a in [b, 2]; const b = 1;", [("NOT_CONSTANT", "b")]),
        ("role base; param a in [1, 2]; param b in [a, 3];", [("NOT_CONSTANT", "a")]),
        ("role base; const a = c;", [("UNKNOWN_NAME", "c")]),
        ("role base; const a = world;", [("SORT_MISMATCH", "world")]),
        ("role base; const a = A.b;", [("NOT_CONSTANT", "A.b")]),
        ("role base; dof q: revolute z in [0, 1] m;", [("UNIT_MISMATCH", "m")]),
        ("role base; dof q: prismatic z in [0, 1] deg;", [("UNIT_MISMATCH", "deg")]),
        ("role base; dof q: revolute z rate in [0, 1] m/s;", [("UNIT_MISMATCH", "m/s")]),
        ("role base; dof q: revolute z in [0, 90];", [("ANGLE_ABOVE_TURN", "90")]),
        ("role base; dof q: revolute z in [0, 2*pi];", []),
        ("role base; param a in [u, 2];", [("UNKNOWN_NAME", "u")]),
        ("role base; dof q: revolute z in [0, s]; state s; der(s) = 1;", [("NOT_CONSTANT", "s")]),
    ],
)
def test_findings(body: str, found: list[tuple[str, str]], check: Check) -> None:
    assert check(f"module M {{ {body} }}") == found


def test_one_name_space(check: Check) -> None:
    assert check("module A { role base; } edge A;") == [("DUPLICATE_NAME", "A")]
    assert check("edge a, b, a;") == [("DUPLICATE_NAME", "a")]
    assert check("edge eps, 'eps';") == [("DUPLICATE_NAME", "'eps'")]
