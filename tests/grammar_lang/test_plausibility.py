"""Values out of all proportion get one warning; values without any get one error."""

from __future__ import annotations

import math
from collections.abc import Callable
from fractions import Fraction

import pytest
from hypothesis import given
from hypothesis import strategies as st

from grammar_lang import ir
from grammar_lang.diagnostics.diagnostic import Diagnostic
from grammar_lang.load import load_text

Check = Callable[[str], list[tuple[str, str]]]
Build = Callable[..., str]


def module(body: str) -> str:
    return f"module M {{ role joint; {body} }}"


def warnings(body: str) -> list[Diagnostic]:
    found = load_text(module(body), "t").diagnostics
    assert {d.code.name for d in found} <= {"IMPLAUSIBLE_VALUE"}
    return list(found)


LIMITS = [
    ("m", "1e-6", "1e4"),
    ("kg", "1e-9", "1e6"),
    ("s", "1e-6", "1e6"),
    ("N", None, "1e9"),
    ("N*m", None, "1e9"),
    ("rad/s", None, "1e5"),
    ("m/s", None, "1e5"),
    ("kg/m", None, "1e6"),
]


@pytest.mark.parametrize("sign", ["", "-"])
@pytest.mark.parametrize(("unit", "least", "most"), LIMITS)
def test_the_limits_are_plausible_themselves(
    unit: str, least: str | None, most: str, sign: str
) -> None:
    assert not warnings(f"const a = {sign}{most} {unit};")
    assert len(warnings(f"const a = {sign}{most}1 {unit};")) == 1
    assert len(warnings(f"const a = {sign}1.001 * {most} {unit};")) == 1
    assert not warnings(f"const a = {sign}0 {unit};")
    assert len(warnings(f"const a = {sign}0.999 * {least} {unit};")) == 1 if least else True
    assert not warnings(f"const a = {sign}{least or '1e-100'} {unit};")


def test_what_has_no_limits() -> None:
    assert not warnings(
        "const a = 1e300; const b = 1e-300 m^2; const c = 1e200 V; const d = 7 rad;"
    )


@pytest.mark.parametrize(
    ("value", "message", "hint"),
    [
        ("25000 m", "implausible length: 25000 m", "did you mean `mm`?"),
        ("1500000 cm", "implausible length: 15000 m", "did you mean `mm`?"),
        ("0.0002 mm", "implausible length: 2e-07 m", "did you mean `m`?"),
        ("5e6 kg", "implausible mass: 5e+06 kg", "did you mean `g`?"),
        ("2e7 s", "implausible time: 2e+07 s", "did you mean `ms`?"),
        ("3e10 N*m", "implausible torque: 3e+10 N*m", "did you mean `N*mm`?"),
        ("2e5 rad/s", "implausible angular rate: 200000 rad/s", "did you mean `deg/s`?"),
        ("7.8e6 kg/m", "implausible mass per length: 7.8e+06 kg/m", "did you mean `g/m`?"),
        ("-25000 m", "implausible length: 25000 m", "did you mean `mm`?"),
        (
            "1e-30 m",
            "implausible length: 1e-30 m",
            "check the digits and the unit; usual is 1e-06 to 10000 m",
        ),
        (
            "1e12 N",
            "implausible force: 1e+12 N",
            "check the digits and the unit; usual is at most 1e+09 N",
        ),
        (
            "100 * 200 m",
            "implausible length: 20000 m",
            "check the digits and the unit; usual is 1e-06 to 10000 m",
        ),
    ],
)
def test_what_the_warning_says(value: str, message: str, hint: str) -> None:
    [found] = warnings(f"const a = {value};")
    assert (found.message, found.hint) == (message, hint)


def test_a_number_without_a_unit_is_told_so() -> None:
    [found] = warnings("dof d: prismatic x in [0, 25000];")
    assert found.hint == "did you mean `mm`? a number without a unit is in `m`"


@pytest.mark.parametrize(
    ("body", "marked"),
    [
        ("param a in [0, 25000] m;", "25000"),
        ("param a in [-25000, 25000] m;", "-25000"),
        ("param a in [0, 25000 m];", "25000 m"),
        ("param a in {1, 25000} m;", "25000"),
        ("param a in [1, 25000] mm;", None),
        ("param a in [1, 25000];", None),
        ("param a in [0, 1] m;", None),
        ("dof d: prismatic x in [0, 25000];", "25000"),
        ("dof d: prismatic x rate in [-3e5, 3e5];", "-3e5"),
        ("dof q: revolute z rate in [0, 1e6] deg/s;", None),
        ("dof q: revolute z rate in [0, 1e7] deg/s;", "1e7"),
        ("const v = (1, 25000) m;", "25000"),
        ("const v = (1, 25000 m);", "25000 m"),
        ("const a = 25000 m; const b = a; const c = -a;", "25000 m"),
        ("state s m = 25000; der(s) = 0;", "25000"),
        ("input f in [0, 1e10] N; dof d: prismatic x; torque(d) = f;", "1e10"),
    ],
)
def test_modules(body: str, marked: str | None, check: Check) -> None:
    found = [] if marked is None else [("IMPLAUSIBLE_VALUE", marked)]
    if "c = -a" in body:
        found.append(("IMPLAUSIBLE_VALUE", "-a"))
    assert check(module(body)) == found


@pytest.mark.parametrize(
    ("shape", "marked"),
    [
        ("box [0, 1] x [0, 25000]", "25000"),
        ("box [0, 1] x [0, 25000] mm", None),
        ("box [0, 0] x [0, 0.1] mm", None),
        ("polytope { x >= 0; y >= 0; x + y <= 25000 }", "25000"),
        ("polytope { x >= 0; y >= 0; 25000 >= x + y }", "25000"),
        ("polytope { x >= 0; y >= 0; x + y <= 25000 } m", "25000"),
        ("polytope { x >= 0; y >= 0; x + y <= 25000 m } mm", "25000 m"),
        ("polytope { x >= 0; y >= 0; x + y <= 25000 } mm", None),
        ("polytope { x >= 0; y >= 0; 25000*x + y <= 1 }", None),
        ("hull (0, 0), (1, 0), (1, 25000)", "25000"),
    ],
)
def test_workspaces(shape: str, marked: str | None, check: Check) -> None:
    text = f"workspace W {{ plane xy; bounds box [0, 5] x [0, 5] m; region R {shape}; }}"
    assert check(text) == ([] if marked is None else [("IMPLAUSIBLE_VALUE", marked)])


@pytest.mark.parametrize(
    ("statement", "marked"),
    [
        ("rod(frame: world, axis: x, length: 25000, density: 1);", "25000"),
        ("rod(frame: world, axis: x, length: 1, density: 7.8e6);", "7.8e6"),
        ("rod(frame: world, axis: x, length: 1, density: 1, radius: 1e-9 m);", "1e-9 m"),
        ("point(frame: world, mass: 1e7);", "1e7"),
        ("point(frame: move(x, 25000), mass: 1);", "25000"),
        ("point(frame: move((1, 25000) m), mass: 1);", "25000"),
        ("solid(frame: world, mass: 1, com: (25000, 0), inertia: 1e30);", "25000"),
        ("point(frame: rot(z, 3), mass: L.mass);", None),
    ],
)
def test_semantics(statement: str, marked: str | None, check_fragment: Check) -> None:
    text = f"""module L {{ role link; param mass in [1, 2] kg; }}
grammar G {{ start S; a: S -> L; }} semantics G {{ a {{ {statement} }} }}"""
    assert check_fragment(text) == ([] if marked is None else [("IMPLAUSIBLE_VALUE", marked)])


@pytest.mark.parametrize(
    ("old", "new", "marked"),
    [
        ("10 N*m", "1e10 N*m", "1e10 N*m"),
        ("10 N*m", "1e10", "1e10"),
        ("0.125 s", "125000000 ms", None),
        ("0.125 s", "125000000", "125000000"),
        ("0.125 s", "0.000000125", "0.000000125"),
        ("start in S", "start in S rates <= 1e6 rad/s", "1e6 rad/s"),
        ("effort", "avoid S with body margin 25 m; effort", None),
        ("effort", "avoid S with body margin 25000; effort", "25000"),
    ],
)
def test_tasks(old: str, new: str, marked: str | None, check_fragment: Check, build: Build) -> None:
    found = [f for f in check_fragment(build().replace(old, new)) if "OBSTACLE" not in f[0]]
    assert found == ([] if marked is None else [("IMPLAUSIBLE_VALUE", marked)])


def test_a_wrong_unit_is_not_called_implausible_too(check: Check) -> None:
    assert check(module("dof d: prismatic x in [0, 1e9 kg];")) == [("UNIT_MISMATCH", "1e9 kg")]


@given(st.fractions(min_value=0, max_value=10**9), st.sampled_from(["m", "cm", "mm"]))
def test_lengths_by_exact_arithmetic(value: Fraction, unit: str) -> None:
    metres = value * {"m": 1, "cm": Fraction(1, 100), "mm": Fraction(1, 1000)}[unit]
    due = bool(metres) and not Fraction(1, 10**6) <= metres <= 10**4
    text = f"({value.numerator} / {value.denominator}) {unit}"
    assert len(warnings(f"const a = {text};")) == due


# --- no finite value ------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("value", "marked"),
    [
        ("1 / 0", "0"),
        ("1 / (1 - 1)", "1 - 1"),
        ("1 / sin(pi)", "sin(pi)"),
        ("1 / (sqrt(2) - sqrt(2))", None),
        ("0^-2", "-2"),
        ("2 + sqrt(-4)", "sqrt(-4)"),
        ("sqrt(-4 m^2) / 1 m", "sqrt(-4 m^2)"),
        ("2 * sqrt(1 - sqrt(2))", "sqrt(1 - sqrt(2))"),
        ("2 * tan(pi/2)", "tan(pi/2)"),
        ("tan(90 deg)", None),
        ("tan(-3*pi/2)", None),
        ("1 - tan(1e6 * 90 deg + 90 deg)", "tan(1e6 * 90 deg + 90 deg)"),
        ("1e400", None),
        ("-1e400", "1e400"),
        ("1 + 1e300 min^12", "1e300 min^12"),
        ("1 + 1e300 * 1e300", "1e300 * 1e300"),
        ("1 / 1e-300^2", "1 / 1e-300^2"),
        ("10^400 / 10^99", "10^400"),
        ("sqrt(2)^4000", None),
        ("2^1e9", None),
    ],
)
@pytest.mark.parametrize("place", ["const a = 1; const b = {};", "param a in [0, {}];"])
def test_numbers_without_a_value(value: str, marked: str | None, place: str, check: Check) -> None:
    """The innermost part that has none is marked, and nothing else is said."""
    assert check(module(place.format(value))) == [("BAD_NUMBER", marked or value)]


@pytest.mark.parametrize(
    "value", ["tan(pi)", "tan(pi/4)", "tan(1.5)", "sqrt(0)", "0^0", "1e300", "1e-300", "2^-3"]
)
def test_numbers_with_a_value(value: str, check: Check) -> None:
    assert check(module(f"const a = {value};")) == []


def test_an_inequality_that_overflows(check: Check) -> None:
    text = "workspace W {{ plane xy; bounds box [0, 5] x [0, 5] m; region R polytope {{ {} }}; }}"
    row = "1e200 * (1e200 * x) <= 1"
    assert check(text.format(f"{row}; x >= 0; y >= 0; y <= 1")) == [("BAD_NUMBER", row)]


@pytest.mark.parametrize("text", ["tan(pi/2) * L.length", "1e400 * L.length", "L.length / sin(pi)"])
def test_in_the_semantics_too(text: str, check: Check) -> None:
    found = check(f"""module L {{ role link; param length in [1, 2] m; }}
grammar G {{ start S; a: S -> L; }} semantics G {{ a {{ effector(frame: move(x, {text})); }} }}""")
    assert [code for code, _ in found] == ["BAD_NUMBER"]


@given(
    st.recursive(
        st.sampled_from(["0", "1", "2", "0.5", "pi", "1e200", "90 deg", "45 deg"]),
        lambda part: st.one_of(
            st.builds("({} {} {})".format, part, st.sampled_from("+-*/"), part),
            st.builds("{}({})".format, st.sampled_from(["sqrt", "tan", "sin", "abs"]), part),
        ),
        max_leaves=6,
    )
)
def test_whatever_passes_is_finite(text: str) -> None:
    loaded = load_text(module(f"param a in {{{text}}};"), "t")
    if loaded.program is None:
        assert {d.code.name for d in loaded.diagnostics} == {"BAD_NUMBER"}
        return
    [parameter] = loaded.program.modules["M"].parameters
    assert isinstance(parameter.domain, ir.Choices)
    assert math.isfinite(value(parameter.domain.values[0]))


def value(expr: ir.Expr) -> float:
    """The value in the library's floating point."""
    match expr:
        case ir.Num(value=number):
            return float(number)
        case ir.Pi():
            return math.pi
        case ir.Unary(function="neg", operand=operand):
            return -value(operand)
        case ir.Unary(function="abs", operand=operand):
            return abs(value(operand))
        case ir.Unary(function=function, operand=operand):
            return float(getattr(math, function)(value(operand)))
        case ir.Binary(operator="^", left=left, right=right):
            return float(value(left) ** value(right))
        case ir.Binary(operator=operator, left=left, right=right):
            a, b = value(left), value(right)
            return {"+": a + b, "-": a - b, "*": a * b, "/": a / b if b else math.nan}[operator]
        case _:
            raise TypeError(expr)
